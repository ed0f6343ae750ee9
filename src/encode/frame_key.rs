//! What identifies the image of a frame before it is rendered.

use crate::base::digest::Digest;

/// The digests and settings that decide what a frame looks like before it is developed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameKey {
    /// Digest of the light that the frame shows, before exposure.
    pub image_hash: Digest,
    /// Digest of all layers of its film, dark ones included.
    pub film: Digest,
    /// Factor of the displayed picture.
    pub exposure: f32,
    /// Whether its samples are random, so that they depend on a seed.
    pub random: bool,
}
