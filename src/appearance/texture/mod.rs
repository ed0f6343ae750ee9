//! Textures: colours that vary over a surface, from images, patterns and vertices.

mod decode;
mod error;
mod footprint;
mod image;
mod noise;
mod paint;
mod pattern;
mod placement;
mod shared;
#[cfg(test)]
mod tests;
mod tracks;
mod wrap;

pub use decode::Encoding;
pub use error::ImageError;
pub use footprint::Footprint;
pub use image::{Filter, Image, Texel};
pub use paint::{Channel, ImagePaint, Paint, PatternPaint, Spot};
pub use pattern::Pattern;
pub use placement::{Placement, PlacementTracks, Reach, Space};
pub use shared::Shared;
pub use tracks::{ImageTracks, PaintTracks, PatternTracks};
pub use wrap::{Axis, Wrap};
