//! Paint over time.

use super::paint::{Channel, ImagePaint, Paint, PatternPaint};
use super::{Filter, Image, Pattern, PlacementTracks, Shared, Space, Wrap};
use crate::color::Rgb;
use crate::time::Time;
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
    pub wrap: Wrap,
    pub filter: Filter,
    pub channel: Option<Channel>,
    pub tint: Animated<Rgb>,
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
    pub fn at(&self, time: Time) -> Paint {
        match self {
            // An easing that overshoots must not turn reflectance negative.
            Self::Color(color) => Paint::Color(color.at(time).max(Rgb::ZERO)),
            Self::VertexColor => Paint::VertexColor,
            Self::Image(tracks) => Paint::Image(tracks.at(time)),
            Self::Pattern(tracks) => Paint::Pattern(Box::new(tracks.at(time))),
        }
    }
}

impl ImageTracks {
    pub fn at(&self, time: Time) -> ImagePaint {
        let placement = self.placement.at(time);
        // An easing that overshoots must not turn reflectance negative.
        let tint = self.tint.at(time).max(Rgb::ZERO);
        let Self { image, wrap, filter, channel, .. } = self;
        ImagePaint { image: image.clone(), wrap: *wrap, filter: *filter, channel: *channel, tint, placement }
    }
}

impl PatternTracks {
    pub fn at(&self, time: Time) -> PatternPaint {
        let placement = self.placement.at(time);
        let (first, second) = (self.first.at(time), self.second.at(time));
        PatternPaint { pattern: self.pattern, space: self.space, placement, first, second }
    }
}
