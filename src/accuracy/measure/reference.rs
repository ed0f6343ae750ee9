//! The references that pictures are compared with.

use crate::accuracy::image_error::{Flip, ReferencePair};

/// Two reference pictures, and what is computed from them once for all comparisons.
pub struct Reference {
    pub pair: ReferencePair,
    pub displayed: Vec<[f32; 3]>,
    /// One for each frame.
    pub flips: Vec<Flip>,
    /// The references of each film layer, if there are several.
    pub layers: Vec<ReferencePair>,
}
