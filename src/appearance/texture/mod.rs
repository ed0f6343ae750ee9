//! Textures: colours that vary over a surface, from images, patterns, vertices and data.

pub mod color_map;
mod data;
mod decode;
mod error;
mod footprint;
mod texel;
mod image;
mod noise;
mod evaluate;
mod pattern;
pub mod relief;
mod mapping;
mod asset;
#[cfg(test)]
mod tests;
mod tracks;
mod wrap;

pub use asset::SharedAsset;
pub use color_map::{ColorMap, NamedMap};
pub use data::{DataScale, DataSource, DataTexture};
pub use decode::ColorEncoding;
pub use error::ImageError;
pub use evaluate::{
    ColorChannel, CutoutTexture, ImageTexture, PatternTexture, ProductTexture, Texture, TextureEvalContext,
    TextureInputs, TexturedObject,
};
pub use footprint::Footprint;
pub use image::{Image, TextureFilter};
pub use mapping::{SurfaceWrap, TextureMapping, TextureMappingTracks, TextureSpace};
pub use pattern::Pattern;
pub use texel::Texel;
pub use tracks::{ImageTextureTracks, PatternTextureTracks, TextureTracks};
pub use wrap::{AxisWrap, LaneWrap, Wrap};
