//! What carries a light or a camera: an object, and everything above it.

use super::transform::TransformTracks;
use crate::base::math::DAffine3;
use crate::base::time::Time;
use std::sync::Arc;

/// The transforms from an object to the world over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Carrier {
    /// The index of the object.
    pub object: usize,
    /// Outermost first.
    chain: Arc<[TransformTracks]>,
}

impl Carrier {
    /// `chain` holds the transforms of the object and of those above it, the outermost first.
    pub fn new(object: usize, chain: Vec<TransformTracks>) -> Self {
        Self { object, chain: chain.into() }
    }

    /// Whether the transform may change over time.
    pub fn is_keyed(&self) -> bool {
        self.chain.iter().any(TransformTracks::is_keyed)
    }

    /// The map from the object to the world.
    pub fn at(&self, time: Time) -> DAffine3 {
        self.chain.iter().fold(DAffine3::IDENTITY, |outer, inner| outer * inner.at(time))
    }
}
