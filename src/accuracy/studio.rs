//! Renders frames of a sequence by any quality, and keeps what comes of it.

use super::change::Change;
use super::clock::{Took, timed};
use super::layering::Layering;
use crate::base::cancel::Stop;
use crate::base::color::Rgb;
use crate::base::stats::Meter;
use crate::base::time::Time;
use crate::encode::displayed;
use crate::film::{Extras, Film, LayerId};
use crate::pipeline::render::{RenderError, pool};
use crate::pipeline::schedule::{Films, FrameLoop, Look, Preview, looks};
use crate::scene::Scene;
use crate::sequence::Sequence;
use crate::sequence::quality::{Integrator, Quality};
use rayon::ThreadPool;
use std::num::NonZeroUsize;
use std::sync::Arc;

/// What is rendered, again and again.
pub struct Studio {
    sequence: Sequence,
    frames: Vec<u32>,
    pool: ThreadPool,
}

/// All frames by one quality.
pub struct Shot {
    /// One for each frame.
    pub films: Vec<Film>,
    /// Without start-up, loading and writing.
    pub took: Took,
    pub rays: u64,
}

impl Studio {
    pub fn new(
        sequence: &Sequence,
        frames: &[u32],
        threads: Option<NonZeroUsize>,
    ) -> Result<Self, RenderError> {
        Ok(Self { sequence: sequence.clone(), frames: frames.to_vec(), pool: pool(threads)? })
    }

    /// The same at another size.
    pub fn resize(&mut self, size: (u32, u32)) {
        self.sequence.output.size = size;
    }

    pub fn size(&self) -> (u32, u32) {
        self.sequence.output.size
    }

    pub fn threads(&self) -> usize {
        self.pool.current_num_threads()
    }

    pub fn frames(&self) -> usize {
        self.frames.len()
    }

    /// Pixels of all frames.
    pub fn pixels(&self) -> f64 {
        let (width, height) = self.size();
        f64::from(width) * f64::from(height) * self.frames.len() as f64
    }

    pub fn shoot(&self, quality: &Quality) -> Result<Shot, RenderError> {
        self.shoot_changed(quality, Change::None)
    }

    /// The same of a sequence with a change, whose light is kept apart as it is in the first frame.
    pub fn shoot_changed(&self, quality: &Quality, change: Change) -> Result<Shot, RenderError> {
        let sequence = Sequence { quality: *quality, ..change.of(&self.sequence, self.time()) };
        let mut frames = FrameLoop::new(&sequence, Films::default(), Arc::new(Meter::default()));
        let all = || self.frames.iter().try_for_each(|&frame| frames.frame(frame));
        let (done, took) = timed(|| self.pool.install(all));
        done?;
        let rays = frames.tally().counts.rays.total();
        let films = frames.into_sink().map_or_else(Vec::new, |films| films.0);
        Ok(Shot { films, took, rays })
    }

    /// The film of a frame that has been looked at, with these layers of light.
    pub fn take(
        &self,
        quality: &Quality,
        extras: Extras,
        look: &Look,
        lit: &[LayerId],
    ) -> Result<Shot, RenderError> {
        let sequence = Sequence { quality: *quality, ..self.sequence.clone() };
        let meter = Arc::new(Meter::default());
        let mut frames = FrameLoop::with_extras(&sequence, extras, Films::default(), meter);
        let (film, took) = timed(|| self.pool.install(|| frames.trace(look, lit)));
        Ok(Shot { films: film?.into_iter().collect(), took, rays: frames.tally().counts.rays.total() })
    }

    /// Does something on the studio's threads.
    pub fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        self.pool.install(work)
    }

    /// When the first frame begins.
    pub fn time(&self) -> Time {
        let first = self.frames.first().copied().unwrap_or_default();
        self.sequence.timeline.clock(first).start
    }

    /// Hands over the scene of the first frame; nothing if it has no camera.
    pub fn scene<T>(&self, see: impl FnOnce(&Scene) -> T) -> Option<T> {
        let first = self.frames.first().copied().unwrap_or_default();
        Preview::new(&self.sequence).scene_of(first, see)
    }

    /// In how many layers light can be kept apart, if that is one frame of several lights: from the fewest on, each number
    /// once, with the sequence's own among them.
    pub fn layerings(&self) -> Vec<(Layering, u64)> {
        if self.frames.len() != 1 || self.sequence.lights.len() < 2 {
            return Vec::new();
        }
        let count = |layering: Layering| (layering, layering.of(&self.sequence, self.time()).layers());
        let own = count(Layering::Own);
        let others = [Layering::Together, Layering::Apart].map(count);
        let mut all: Vec<_> =
            others.into_iter().filter(|(_, layers)| *layers != own.1).chain([own]).collect();
        all.sort_by_key(|(_, layers)| *layers);
        all
    }

    /// Whether pixels have random samples in any of the frames, by an integrator.
    pub fn is_random(&self, integrator: Integrator) -> bool {
        let quality = Quality { integrator, ..self.sequence.quality };
        let sequence = Sequence { quality, ..self.sequence.clone() };
        looks(&sequence, &self.frames, &Stop::default()).iter().any(|look| look.random)
    }

    /// How the frames with this radiance display, each by its exposure.
    pub fn displayed(&self, exposures: &[f32], radiance: &[Rgb]) -> Vec<[f32; 3]> {
        let each = (radiance.len() / exposures.len().max(1)).max(1);
        let frames = radiance.chunks(each).zip(exposures);
        let pixel = |light: Rgb| displayed(self.sequence.output.tonemap, light).map(|value| value as f32);
        frames
            .flat_map(|(frame, &exposure)| frame.iter().map(move |&light| pixel(light * exposure)))
            .collect()
    }
}

impl Shot {
    /// The radiance of all frames, one after the other.
    pub fn radiance(&self) -> Vec<Rgb> {
        self.films.iter().flat_map(Film::radiance).collect()
    }

    /// By how much each frame is brightened.
    pub fn exposures(&self) -> Vec<f32> {
        self.films.iter().map(|film| film.exposure).collect()
    }

    /// What one layer adds to it.
    pub fn radiance_of(&self, layer: usize) -> Vec<Rgb> {
        let of = |film: &Film| {
            let pixels = film.width as usize * film.height as usize;
            (0..pixels).map(|pixel| film.radiance_of(pixel, layer)).collect::<Vec<_>>()
        };
        self.films.iter().flat_map(of).collect()
    }
}
