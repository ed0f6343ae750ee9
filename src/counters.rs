//! Exact counts of work done, for summaries and tests.

use std::ops::AddAssign;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};

/// Declares a struct of counts that add up.
macro_rules! counts {
    ($(#[$doc:meta])* $name:ident { $($(#[$field_doc:meta])* $field:ident),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct $name {
            $($(#[$field_doc])* pub $field: u64,)*
        }

        impl $name {
            pub fn total(&self) -> u64 {
                [$(self.$field),*].iter().sum()
            }
        }

        impl AddAssign for $name {
            fn add_assign(&mut self, other: Self) {
                $(self.$field += other.$field;)*
            }
        }
    };
}

counts! {
    /// Rays by kind.
    RayCounts {
        camera,
        /// Reflected by mirrors and boundaries, sharp or rough.
        mirror,
        /// Passed on through what is transparent, bent or not.
        transmitted,
        /// Scattered along paths.
        scattered,
        /// Towards lights. One that passes a transparent surface counts again.
        shadow,
    }
}

counts! {
    /// What effects ask for besides rays; exactly none where nothing calls for them.
    Evaluations {
        /// Ways through fog.
        fog,
        /// Points of surfaces that paint was looked up for.
        paint,
        /// Directions that were drawn towards lights with an area, things that shine and skies.
        light_samples,
        /// Points that were drawn on a lens.
        lens_samples,
    }
}

counts! {
    /// Samples that were left out of the picture because they are no light, by cause. A sample counts once in
    /// each of its layers.
    Dropped {
        /// Not a number.
        undefined,
        infinite,
        negative,
    }
}

/// All that tracing counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    pub rays: RayCounts,
    pub evaluations: Evaluations,
    pub dropped: Dropped,
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.evaluations += other.evaluations;
        self.dropped += other.dropped;
    }
}

/// How far a run has come, for whoever watches from another thread. Nothing is decided by it.
#[derive(Debug, Default)]
pub struct Meter {
    /// Frames made.
    pub frames: AtomicU32,
    /// Those of them that were made of the film of another.
    pub reused: AtomicU32,
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
