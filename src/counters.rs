//! Exact counts of work done, for summaries and tests.

use std::ops::AddAssign;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};

/// Rays by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    pub camera: u64,
    pub mirror: u64,
    pub shadow: u64,
}

impl RayCounts {
    pub fn total(&self) -> u64 {
        self.camera + self.mirror + self.shadow
    }
}

impl AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        self.camera += other.camera;
        self.mirror += other.mirror;
        self.shadow += other.shadow;
    }
}

/// How far a run has come, for whoever watches from another thread. Nothing is decided by it.
#[derive(Debug, Default)]
pub struct Meter {
    /// Frames traced.
    pub frames: AtomicU32,
    /// Share of the frame in hand, in thousandths.
    pub thousandths: AtomicU32,
    pub rays: AtomicU64,
}

impl Meter {
    /// Frames traced so far, with the part of the one in hand.
    pub fn frames_done(&self) -> f64 {
        f64::from(self.frames.load(Relaxed)) + f64::from(self.thousandths.load(Relaxed)) / 1000.0
    }
}
