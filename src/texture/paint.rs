//! Paint: the colour of a surface from point to point, at one moment.

use super::{Filter, Footprint, Image, Pattern, Placement, Shared, Space, Wrap};
use crate::color::Rgb;
use crate::digest::content;
use crate::math::{DVec2, DVec3};

/// What a paint may ask of a point on a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spot {
    /// The surface's own coordinates.
    pub uv: DVec2,
    /// The point in the object's space, before the object is moved.
    pub point: DVec3,
    /// How far off each coordinate of `point` may be.
    pub error: DVec3,
    /// The vertices' colour at the point; white where vertices have none.
    pub color: Rgb,
    /// How much of the object is seen, in its space, and in its coordinates u and v for what is printed on it.
    pub seen: Footprint,
    pub seen_uv: Footprint,
}

/// How far off u and v may be, for every unit of them. They are found by a few operations from a point whose
/// error is far smaller, and nobody sees a millionth of a millionth of a surface.
const UV_ERROR: f64 = 1e-12;

/// The colour of a surface at one moment.
#[derive(Clone, Debug, PartialEq)]
pub enum Paint {
    Color(Rgb),
    VertexColor,
    Image(ImagePaint),
    Pattern(Box<PatternPaint>),
}

content!(
    enum Paint {
        Color(color),
        VertexColor,
        Image(paint),
        Pattern(paint),
    }
);

/// An image on a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct ImagePaint {
    pub image: Shared<Image>,
    pub wrap: Wrap,
    pub filter: Filter,
    /// One channel spread to grey.
    pub channel: Option<Channel>,
    /// Factor of the colours.
    pub tint: Rgb,
    /// Over u and v.
    pub placement: Placement,
}

content!(struct ImagePaint { image, wrap, filter, channel, tint, placement });

/// Two paints in a pattern, which may be patterns themselves.
#[derive(Clone, Debug, PartialEq)]
pub struct PatternPaint {
    pub pattern: Pattern,
    pub space: Space,
    pub placement: Placement,
    pub first: Paint,
    pub second: Paint,
}

content!(struct PatternPaint { pattern, space, placement, first, second });

/// One of a colour's three numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    R,
    G,
    B,
}

content!(
    enum Channel {
        R,
        G,
        B,
    }
);

impl From<Rgb> for Paint {
    fn from(color: Rgb) -> Self {
        Self::Color(color)
    }
}

impl Paint {
    /// The colour at a point of the surface; linear, without negative parts.
    pub fn color(&self, spot: &Spot) -> Rgb {
        match self {
            Self::Color(color) => *color,
            Self::VertexColor => spot.color,
            Self::Image(paint) => paint.color(spot),
            Self::Pattern(paint) => paint.color(spot),
        }
    }

    /// Whether any pattern lies on the surface, by u and v.
    pub fn is_printed(&self) -> bool {
        match self {
            Self::Color(_) | Self::VertexColor | Self::Image(_) => false,
            Self::Pattern(paint) => {
                paint.space == Space::Uv || paint.first.is_printed() || paint.second.is_printed()
            }
        }
    }

    /// The colour of a paint that is the same at every point.
    pub fn constant(&self) -> Option<Rgb> {
        if let Self::Color(color) = self { Some(*color) } else { None }
    }
}

impl ImagePaint {
    pub fn color(&self, spot: &Spot) -> Rgb {
        let (at, _) = self.placement.local(spot.uv.extend(0.0), DVec3::ZERO);
        let color = self.image.sample(at.truncate(), self.wrap, self.filter);
        self.channel.map_or(color, |channel| Rgb::splat(color[channel as usize])) * self.tint
    }
}

impl PatternPaint {
    pub fn color(&self, spot: &Spot) -> Rgb {
        let (point, error, seen) = match self.space {
            Space::Object => (spot.point, spot.error, &spot.seen),
            Space::Uv => (spot.uv.extend(0.0), ((spot.uv.abs() + 1.0) * UV_ERROR).extend(0.0), &spot.seen_uv),
        };
        let (point, error) = self.placement.local(point, error);
        let seen = self.placement.footprint(seen).extent();
        match self.pattern.share(point, error, seen) as f32 {
            0.0 => self.first.color(spot),
            1.0 => self.second.color(spot),
            share => self.first.color(spot).lerp(self.second.color(spot), share),
        }
    }
}
