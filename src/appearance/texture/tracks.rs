//! Textures over time.

use super::evaluate::{ColorChannel, ImageTexture, PatternTexture, Texture};
use super::{
    DataTexture, Image, Pattern, SharedAsset, TextureFilter, TextureMappingTracks, TextureSpace, Wrap,
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
}

/// An [`ImageTexture`] over time.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageTextureTracks {
    pub image: SharedAsset<Image>,
    pub wrap: Option<Wrap>,
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
        }
    }

    /// Whether any part has keys.
    pub fn is_keyed(&self) -> bool {
        match self {
            Self::Color(color) => color.is_keyed(),
            Self::VertexColor | Self::Data(_) => false,
            Self::Image(tracks) => {
                let ImageTextureTracks { tint, mapping, image: _, wrap: _, filter: _, channel: _, alpha: _ } =
                    &**tracks;
                tint.is_keyed() || mapping.is_keyed()
            }
            Self::Pattern(tracks) => {
                let PatternTextureTracks { mapping, first, second, pattern: _, space: _ } = &**tracks;
                mapping.is_keyed() || first.is_keyed() || second.is_keyed()
            }
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
        }
    }

    /// Whether any part may have alpha below 1 at any time.
    pub fn has_alpha(&self) -> bool {
        match self {
            Self::Color(_) | Self::VertexColor | Self::Data(_) => false,
            Self::Image(tracks) => tracks.alpha && tracks.image.has_alpha(),
            Self::Pattern(tracks) => tracks.first.has_alpha() || tracks.second.has_alpha(),
        }
    }
}

impl ImageTextureTracks {
    pub fn at(&self, time: Time) -> ImageTexture {
        let mapping = self.mapping.at(time);
        // An easing may overshoot below 0. Reflectance must not be negative.
        let tint = self.tint.at(time).max(Rgb::ZERO);
        let &Self { wrap, filter, channel, alpha, .. } = self;
        let surface_wrap = [0, 1].map(|axis| mapping.surface_wrap(axis));
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
