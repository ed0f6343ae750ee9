//! Floats of 16 bits, as far as they reach.

use exr::prelude::f16;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// What is too large for 16-bit floats becomes the largest of them, for infinity would spoil whatever is made of the
/// picture; and is counted.
#[derive(Default)]
pub struct Halves {
    clipped: AtomicU64,
}

impl Halves {
    /// The nearest; 65,504 for all beyond it. What is no number stays none.
    pub fn half(&self, value: f32) -> f16 {
        let half = f16::from_f32(value);
        if !half.is_infinite() {
            return half;
        }
        self.clipped.fetch_add(1, Relaxed);
        if value > 0.0 { f16::MAX } else { f16::MIN }
    }

    /// How many were too large.
    pub fn clipped(&self) -> u64 {
        self.clipped.load(Relaxed)
    }
}
