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

    /// Whether each frame has random numbers of its own.
    pub fn varies_noise(&self) -> bool {
        self.quality.vary_noise
    }

    /// Whether frames are denoised with their neighbours.
    pub fn uses_neighbors(&self) -> bool {
        self.quality.uses_neighbors()
    }

    pub fn integrator(&self) -> Integrator {
        self.quality.integrator
    }

    /// Feeds the settings that matter for a frame's film with random samples, or without.
    pub fn feed(&self, random: bool, frame: u32, into: &mut Digester) {
        let Self { size: (width, height), coverage, quality } = self;
        let Quality { integrator, bounces, filter, antialias, samples, .. } = quality;
        // Frames that share samples of views have digests of these views besides.
        let Quality { threshold, clamp, smooth_terminator, noise, points, denoise, .. } = quality;
        (*width, *height, *coverage).feed(into);
        (integrator, *bounces, filter).feed(into);
        (*clamp, *smooth_terminator, random).feed(into);
        if *integrator == Integrator::Whitted {
            threshold.feed(into);
        }
        if random {
            (quality.of_frame(frame).seed, points).feed(into);
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
