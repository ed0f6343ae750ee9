//! Textures over time.

use super::evaluate::{ColorChannel, CutoutTexture, ImageTexture, PatternTexture, ProductTexture, Texture};
use super::{
    DataTexture, Image, Pattern, SharedAsset, SurfaceWrap, TextureFilter, TextureMappingTracks, TextureSpace,
    Wrap,
};
use crate::base::color::Rgb;
use crate::base::time::Time;
use crate::track::Animated;

/// A texture over time.
#[derive(Clone, Debug, PartialEq)]
pub enum TextureTracks {
    Color(Animated<Rgb>),
    VertexColor,
    /// Data has no keys.
    Data(Box<DataTexture>),
    Image(Box<ImageTextureTracks>),
    Pattern(Box<PatternTextureTracks>),
    /// A [`ProductTexture`] over time.
    Product(Box<[Self; 2]>),
    /// A [`CutoutTexture`] over time: its texture and its least alpha.
    Cutout(Box<Self>, f32),
}

/// An [`ImageTexture`] over time.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageTextureTracks {
    pub image: SharedAsset<Image>,
    pub wrap: Option<Wrap>,
    /// Instead of `wrap`: the wrap along each axis of the image.
    pub axis_wraps: Option<[Wrap; 2]>,
    pub filter: TextureFilter,
    pub channel: Option<ColorChannel>,
    pub tint: Animated<Rgb>,
    pub alpha: bool,
    pub mapping: TextureMappingTracks,
}

/// A [`PatternTexture`] over time.
#[derive(Clone, Debug, PartialEq)]
pub struct PatternTextureTracks {
    pub pattern: Pattern,
    pub space: TextureSpace,
    pub mapping: TextureMappingTracks,
    pub first: TextureTracks,
    pub second: TextureTracks,
}

impl From<Animated<Rgb>> for TextureTracks {
    fn from(color: Animated<Rgb>) -> Self {
        Self::Color(color)
    }
}

impl From<Rgb> for TextureTracks {
    fn from(color: Rgb) -> Self {
        Self::Color(color.into())
    }
}

impl TextureTracks {
    /// The texture at a moment, simplified: a pattern of two equal textures becomes that texture, an image of one
    /// colour becomes that colour.
    pub fn at(&self, time: Time) -> Texture {
        match self {
            // An easing may overshoot below 0. Reflectance must not be negative.
            Self::Color(color) => Texture::Color(color.at(time).max(Rgb::ZERO)),
            Self::VertexColor => Texture::VertexColor,
            Self::Data(texture) => Texture::Data(texture.clone()),
            Self::Image(tracks) => {
                let texture = tracks.at(time);
                texture.constant().map_or_else(|| Texture::Image(texture), Texture::Color)
            }
            Self::Pattern(tracks) => {
                let texture = tracks.at(time);
                if texture.first == texture.second {
                    texture.first
                } else {
                    Texture::Pattern(Box::new(texture))
                }
            }
            Self::Product(factors) => {
                let [first, second] = [factors[0].at(time), factors[1].at(time)];
                match (first.constant(), second.constant()) {
                    (Some(a), Some(b)) => Texture::Color(a * b),
                    (Some(Rgb::ONE), _) => second,
                    (_, Some(Rgb::ONE)) => first,
                    _ => Texture::Product(Box::new(ProductTexture { first, second })),
                }
            }
            Self::Cutout(texture, cutoff) => match texture.at(time) {
                texture if texture.has_alpha() || *cutoff > 1.0 => {
                    Texture::Cutout(Box::new(CutoutTexture { texture, cutoff: *cutoff }))
                }
                texture => texture,
            },
        }
    }

    /// Whether any part has keys.
    pub fn is_keyed(&self) -> bool {
        match self {
            Self::Color(color) => color.is_keyed(),
            Self::VertexColor | Self::Data(_) => false,
            Self::Image(tracks) => {
                let ImageTextureTracks {
                    tint,
                    mapping,
                    image: _,
                    wrap: _,
                    axis_wraps: _,
                    filter: _,
                    channel: _,
                    alpha: _,
                } = &**tracks;
                tint.is_keyed() || mapping.is_keyed()
            }
            Self::Pattern(tracks) => {
                let PatternTextureTracks { mapping, first, second, pattern: _, space: _ } = &**tracks;
                mapping.is_keyed() || first.is_keyed() || second.is_keyed()
            }
            Self::Product(factors) => factors.iter().any(Self::is_keyed),
            Self::Cutout(texture, _) => texture.is_keyed(),
        }
    }

    /// Calls `visit` with every part that shows data.
    pub fn each_data(&mut self, visit: &mut impl FnMut(&mut DataTexture)) {
        match self {
            Self::Color(_) | Self::VertexColor | Self::Image(_) => {}
            Self::Data(texture) => visit(texture),
            Self::Pattern(tracks) => {
                tracks.first.each_data(visit);
                tracks.second.each_data(visit);
            }
            Self::Product(factors) => factors.iter_mut().for_each(|factor| factor.each_data(visit)),
            Self::Cutout(texture, _) => texture.each_data(visit),
        }
    }

    /// Whether any part may have alpha below 1 at any time.
    pub fn has_alpha(&self) -> bool {
        match self {
            Self::Color(_) | Self::VertexColor | Self::Data(_) => false,
            Self::Image(tracks) => tracks.alpha && tracks.image.has_alpha(),
            Self::Pattern(tracks) => tracks.first.has_alpha() || tracks.second.has_alpha(),
            Self::Product(factors) => factors.iter().any(Self::has_alpha),
            Self::Cutout(texture, cutoff) => texture.has_alpha() || *cutoff > 1.0,
        }
    }
}

impl ImageTextureTracks {
    pub fn at(&self, time: Time) -> ImageTexture {
        let mapping = self.mapping.at(time);
        // An easing may overshoot below 0. Reflectance must not be negative.
        let tint = self.tint.at(time).max(Rgb::ZERO);
        let &Self { wrap, filter, channel, alpha, .. } = self;
        let surface_wrap = match self.axis_wraps {
            Some(wraps) => wraps.map(SurfaceWrap::fixed),
            None => [0, 1].map(|axis| mapping.surface_wrap(axis)),
        };
        let wrap = wrap.filter(|_| self.axis_wraps.is_none());
        ImageTexture { image: self.image.clone(), wrap, filter, channel, tint, alpha, mapping, surface_wrap }
    }
}

impl PatternTextureTracks {
    pub fn at(&self, time: Time) -> PatternTexture {
        let mapping = self.mapping.at(time);
        let (first, second) = (self.first.at(time), self.second.at(time));
        PatternTexture { pattern: self.pattern, space: self.space, mapping, first, second }
    }
}
