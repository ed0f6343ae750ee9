//! Colours, fonts and sizes of annotations.

use crate::base::color::Rgb;
use crate::base::time::Time;
use crate::drawing::{Font, Halo, Ink};
use crate::track::Animated;

/// What annotations look like. Lengths are relative to the height of the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Style {
    pub color: Animated<Rgb>,
    /// The height of letters.
    pub size: f64,
    pub font: Font,
    pub backdrop: Backdrop,
    /// The width of lines.
    pub line_width: f64,
}

/// What makes letters and lines stand out from the picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Backdrop {
    None,
    /// A border around letters and lines. Without a colour, black or white.
    #[default]
    Halo,
    HaloOf(Animated<Rgb>),
    /// A box behind everything, with its opacity. Without a colour, black or white.
    Box(Option<Animated<Rgb>>, f64),
}

impl Default for Style {
    fn default() -> Self {
        Self {
            color: Rgb::ONE.into(),
            size: 0.04,
            font: Font::default(),
            backdrop: Backdrop::default(),
            line_width: 0.004,
        }
    }
}

impl Style {
    /// The usual style of captions: a box behind white letters.
    pub fn of_captions() -> Self {
        Self { backdrop: Backdrop::Box(None, 0.55), ..Self::default() }
    }
}

/// The least height of letters in pixels. Smaller ones cannot be read.
const MIN_LETTERS: f64 = 8.0;
/// The least width of lines in pixels.
const MIN_LINE: f64 = 1.0;
/// The width of halos relative to the height of letters, and to lines.
const HALO_WIDTH: f64 = 0.1;
const HALO_OPACITY: f64 = 0.75;

/// A style at a time, in pixels.
#[derive(Clone, Debug)]
pub struct Pen {
    pub ink: Ink,
    /// The height of letters.
    pub size: f64,
    pub font: Font,
    /// The width of lines.
    pub width: f64,
    /// The colour around letters and lines.
    pub halo: Option<Ink>,
    /// The colour behind them.
    pub panel: Option<Ink>,
}

impl Pen {
    /// The style at a time in pictures of this height.
    pub fn new(style: &Style, time: Time, height: f64) -> Self {
        let ink = Ink::new(style.color.at(time), 1.0);
        let shown = |color: &Animated<Rgb>, opacity| Ink::new(color.at(time), opacity);
        let (halo, panel) = match &style.backdrop {
            Backdrop::None => (None, None),
            Backdrop::Halo => (Some(ink.contrast(HALO_OPACITY)), None),
            Backdrop::HaloOf(color) => (Some(shown(color, HALO_OPACITY)), None),
            Backdrop::Box(color, opacity) => {
                let panel = color.as_ref().map(|color| shown(color, *opacity));
                (None, Some(panel.unwrap_or_else(|| ink.contrast(*opacity))))
            }
        };
        Self {
            ink,
            size: (style.size * height).max(MIN_LETTERS),
            font: style.font.clone(),
            width: (style.line_width * height).max(MIN_LINE),
            halo,
            panel,
        }
    }

    /// The halo of letters.
    pub fn text_halo(&self) -> Option<Halo> {
        self.halo.map(|ink| Halo { ink, width: self.halo_width() })
    }

    /// The width of halos in pixels.
    pub fn halo_width(&self) -> f64 {
        (HALO_WIDTH * self.size).max(1.0)
    }
}
