//! Paint: the colour of a surface from point to point, at one moment.

use super::{Filter, Footprint, Image, Pattern, Placement, Reach, Shared, Space, Texel, Wrap};
use crate::base::color::Rgb;
use crate::base::digest::content;
use crate::base::math::{DVec2, DVec3};

/// What a paint may ask of a point on a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spot {
    /// The surface's own coordinates.
    pub uv: DVec2,
    /// Whether the surface ends where u is 0 and 1, and where v is.
    pub ends: [bool; 2],
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
    /// Beyond the image's edges; if nothing is said, it repeats as far as the surface goes on.
    pub wrap: Option<Wrap>,
    pub filter: Filter,
    /// One channel spread to grey.
    pub channel: Option<Channel>,
    /// Factor of the colours.
    pub tint: Rgb,
    /// Whether its alpha counts.
    pub alpha: bool,
    /// Over u and v.
    pub placement: Placement,
    /// How it goes on along its x and y there.
    pub reach: [Reach; 2],
}

content!(struct ImagePaint { image, wrap, filter, channel, tint, alpha, placement, reach });

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
    /// What it is at a point of the surface: a linear colour without negative parts, and how much of that is there.
    pub fn at(&self, spot: &Spot) -> Texel {
        match self {
            Self::Color(color) => Texel::opaque(*color),
            Self::VertexColor => Texel::opaque(spot.color),
            Self::Image(paint) => paint.at(spot),
            Self::Pattern(paint) => paint.at(spot),
        }
    }

    /// Whether any of it is not, or not wholly, there.
    pub fn has_alpha(&self) -> bool {
        match self {
            Self::Color(_) | Self::VertexColor => false,
            Self::Image(paint) => paint.alpha && paint.image.has_alpha(),
            Self::Pattern(paint) => paint.first.has_alpha() || paint.second.has_alpha(),
        }
    }

    /// The same where all of it is there.
    pub fn opaque(self) -> Self {
        match self {
            Self::Color(_) | Self::VertexColor => self,
            Self::Image(paint) => Self::Image(ImagePaint { alpha: false, ..paint }),
            Self::Pattern(paint) => {
                let PatternPaint { first, second, .. } = *paint;
                let (first, second) = (first.opaque(), second.opaque());
                Self::Pattern(Box::new(PatternPaint { first, second, ..*paint }))
            }
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
    pub fn at(&self, spot: &Spot) -> Texel {
        let (at, _) = self.placement.local(spot.uv.extend(0.0), DVec3::ZERO);
        let axes = match self.wrap {
            Some(wrap) => [wrap.into(); 2],
            None => self.reach.map(|reach| reach.over(spot.ends)),
        };
        let Texel { color, alpha } = match self.alpha {
            true => self.image.sample_alpha(at.truncate(), axes, self.filter),
            false => Texel::opaque(self.image.sample(at.truncate(), axes, self.filter)),
        };
        Texel { color: self.tinted(color), alpha }
    }

    fn tinted(&self, color: Rgb) -> Rgb {
        self.channel.map_or(color, |channel| Rgb::splat(color[channel as usize])) * self.tint
    }

    /// The colour of an image that is the same, and there, everywhere.
    pub fn constant(&self) -> Option<Rgb> {
        let there = !self.alpha || !self.image.has_alpha();
        let black = (there && self.tint == Rgb::ZERO).then_some(Rgb::ZERO);
        self.image.constant().map(|color| self.tinted(color)).or(black)
    }
}

impl PatternPaint {
    pub fn at(&self, spot: &Spot) -> Texel {
        let (point, error, seen) = match self.space {
            Space::Object => (spot.point, spot.error, &spot.seen),
            Space::Uv => (spot.uv.extend(0.0), ((spot.uv.abs() + 1.0) * UV_ERROR).extend(0.0), &spot.seen_uv),
        };
        let (point, error) = self.placement.local(point, error);
        let seen = self.placement.footprint(seen).extent();
        match self.pattern.share(point, error, seen) as f32 {
            0.0 => self.first.at(spot),
            1.0 => self.second.at(spot),
            share => self.first.at(spot).lerp(self.second.at(spot), share),
        }
    }
}
