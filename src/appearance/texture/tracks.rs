//! Paint over time.

use super::paint::{Channel, ImagePaint, Paint, PatternPaint};
use super::{Filter, Image, Pattern, PlacementTracks, Shared, Space, Wrap};
use crate::base::color::Rgb;
use crate::base::time::Time;
use crate::track::Animated;

/// A paint over time.
#[derive(Clone, Debug, PartialEq)]
pub enum PaintTracks {
    Color(Animated<Rgb>),
    VertexColor,
    Image(Box<ImageTracks>),
    Pattern(Box<PatternTracks>),
}

/// An [`ImagePaint`] over time.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageTracks {
    pub image: Shared<Image>,
    pub wrap: Option<Wrap>,
    pub filter: Filter,
    pub channel: Option<Channel>,
    pub tint: Animated<Rgb>,
    pub alpha: bool,
    pub placement: PlacementTracks,
}

/// A [`PatternPaint`] over time.
#[derive(Clone, Debug, PartialEq)]
pub struct PatternTracks {
    pub pattern: Pattern,
    pub space: Space,
    pub placement: PlacementTracks,
    pub first: PaintTracks,
    pub second: PaintTracks,
}

impl From<Animated<Rgb>> for PaintTracks {
    fn from(color: Animated<Rgb>) -> Self {
        Self::Color(color)
    }
}

impl From<Rgb> for PaintTracks {
    fn from(color: Rgb) -> Self {
        Self::Color(color.into())
    }
}

impl PaintTracks {
    /// The paint at a moment, without what makes no difference: a pattern of two equal paints is that paint, an image of
    /// one colour is that colour.
    pub fn at(&self, time: Time) -> Paint {
        match self {
            // An easing that overshoots must not turn reflectance negative.
            Self::Color(color) => Paint::Color(color.at(time).max(Rgb::ZERO)),
            Self::VertexColor => Paint::VertexColor,
            Self::Image(tracks) => {
                let paint = tracks.at(time);
                paint.constant().map_or_else(|| Paint::Image(paint), Paint::Color)
            }
            Self::Pattern(tracks) => {
                let paint = tracks.at(time);
                if paint.first == paint.second { paint.first } else { Paint::Pattern(Box::new(paint)) }
            }
        }
    }

    /// Whether any of it is, at any time, not or not wholly there.
    pub fn has_alpha(&self) -> bool {
        match self {
            Self::Color(_) | Self::VertexColor => false,
            Self::Image(tracks) => tracks.alpha && tracks.image.has_alpha(),
            Self::Pattern(tracks) => tracks.first.has_alpha() || tracks.second.has_alpha(),
        }
    }
}

impl ImageTracks {
    pub fn at(&self, time: Time) -> ImagePaint {
        let placement = self.placement.at(time);
        // An easing that overshoots must not turn reflectance negative.
        let tint = self.tint.at(time).max(Rgb::ZERO);
        let &Self { wrap, filter, channel, alpha, .. } = self;
        let reach = [0, 1].map(|axis| placement.reach(axis));
        ImagePaint { image: self.image.clone(), wrap, filter, channel, tint, alpha, placement, reach }
    }
}

impl PatternTracks {
    pub fn at(&self, time: Time) -> PatternPaint {
        let placement = self.placement.at(time);
        let (first, second) = (self.first.at(time), self.second.at(time));
        PatternPaint { pattern: self.pattern, space: self.space, placement, first, second }
    }
}
