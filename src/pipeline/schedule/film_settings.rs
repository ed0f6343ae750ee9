//! The settings that decide what a film holds.

use crate::base::digest::{Content, Digester};
use crate::sequence::Sequence;
use crate::sequence::quality::{Denoise, Integrator, Quality};

/// Settings that are part of a film's digest.
pub struct FilmSettings {
    size: (u32, u32),
    coverage: bool,
    quality: Quality,
}

impl FilmSettings {
    pub fn of(sequence: &Sequence) -> Self {
        Self { size: sequence.output.size, coverage: sequence.output.transparent, quality: sequence.quality }
    }

    /// Whether views from one point share samples.
    pub fn shares_views(&self) -> bool {
        self.quality.shares_views()
    }

    pub fn integrator(&self) -> Integrator {
        self.quality.integrator
    }

    /// Feeds the settings that matter for films with random samples, or for films without.
    pub fn feed(&self, random: bool, into: &mut Digester) {
        let Self { size: (width, height), coverage, quality } = self;
        let Quality { integrator, bounces, filter, antialias, samples, .. } = quality;
        // Frames that share samples of views have digests of these views besides.
        let Quality { threshold, clamp, smooth_terminator, seed, noise, points, denoise, .. } = quality;
        (*width, *height, *coverage).feed(into);
        (integrator, *bounces, filter).feed(into);
        (*clamp, *smooth_terminator, random).feed(into);
        if *integrator == Integrator::Whitted {
            threshold.feed(into);
        }
        if random {
            (*seed, points).feed(into);
            // Films that are not denoised keep their digests.
            if *denoise != Denoise::Off {
                denoise.feed(into);
            }
            match noise {
                Some(target) => target.feed(into),
                None => samples.feed(into),
            }
        } else {
            antialias.feed(into);
        }
    }
}
