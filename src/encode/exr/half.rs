//! Conversion to 16-bit floats.

use exr::prelude::f16;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Converts values to 16-bit floats. Values that are too large are clamped and counted, because an infinity would spoil
/// every later filter of the picture.
#[derive(Default)]
pub struct HalfConverter {
    clipped: AtomicU64,
}

impl HalfConverter {
    /// The nearest 16-bit float, clamped to ±65,504. NaN stays NaN.
    pub fn half(&self, value: f32) -> f16 {
        let half = f16::from_f32(value);
        if !half.is_infinite() {
            return half;
        }
        self.clipped.fetch_add(1, Relaxed);
        if value > 0.0 { f16::MAX } else { f16::MIN }
    }

    /// The number of values that were clamped.
    pub fn clipped(&self) -> u64 {
        self.clipped.load(Relaxed)
    }
}
