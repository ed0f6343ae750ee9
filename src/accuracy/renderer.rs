//! Renders the frames of a sequence at any quality, and returns the films.

use super::change::SceneChange;
use super::layering::Layering;
use crate::base::cancel::Stop;
use crate::base::clock::{ElapsedTime, timed};
use crate::base::color::Rgb;
use crate::base::stats::ProgressMeter;
use crate::base::time::Time;
use crate::encode::displayed;
use crate::film::{AovSet, Film, LayerId};
use crate::pipeline::render::{RenderError, pool};
use crate::pipeline::schedule::{FilmCollector, FrameLoop, FrameState, Preview, frame_states};
use crate::scene::Scene;
use crate::sequence::Sequence;
use crate::sequence::quality::{Denoise, Integrator, Quality, SampleReuse};
use rayon::ThreadPool;
use std::num::NonZeroUsize;
use std::sync::Arc;

/// A sequence, the frames to render, and the threads to render with.
pub struct Renderer {
    sequence: Sequence,
    frames: Vec<u32>,
    pool: ThreadPool,
}

/// All frames at one quality.
pub struct Rendering {
    /// One film for each frame.
    pub films: Vec<Film>,
    /// The time of rendering, without start-up, loading and writing.
    pub took: ElapsedTime,
    pub rays: u64,
}

impl Renderer {
    pub fn new(
        sequence: &Sequence,
        frames: &[u32],
        threads: Option<NonZeroUsize>,
    ) -> Result<Self, RenderError> {
        Ok(Self { sequence: sequence.clone(), frames: frames.to_vec(), pool: pool(threads)? })
    }

    /// A renderer of other frames, with the same size and number of threads.
    pub fn with_frames(&self, frames: &[u32]) -> Result<Self, RenderError> {
        Self::new(&self.sequence, frames, NonZeroUsize::new(self.threads()))
    }

    /// Sets the size of the pictures, in pixels.
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

    /// Number of pixels of all frames together.
    pub fn pixels(&self) -> f64 {
        let (width, height) = self.size();
        f64::from(width) * f64::from(height) * self.frames.len() as f64
    }

    /// Renders the sequence as it is.
    pub fn render(&self, quality: &Quality) -> Result<Rendering, RenderError> {
        self.render_changed(quality, SceneChange::None)
    }

    /// Renders the sequence with a change, which is applied at the time of the first frame.
    pub fn render_changed(&self, quality: &Quality, change: SceneChange) -> Result<Rendering, RenderError> {
        let sequence = Sequence { quality: alone(quality), ..change.of(&self.sequence, self.time()) };
        let mut frames =
            FrameLoop::new(&sequence, FilmCollector::default(), Arc::new(ProgressMeter::default()));
        let all = || self.frames.iter().try_for_each(|&frame| frames.frame(frame));
        let (done, took) = timed(|| self.pool.install(all));
        done?;
        let rays = frames.stats().counts.rays.total();
        let films = frames.into_sink().map_or_else(Vec::new, |films| films.0);
        Ok(Rendering { films, took, rays })
    }

    /// Renders one film of the plan, with the film layers `lit`.
    pub fn render_film(
        &self,
        quality: &Quality,
        aovs: AovSet,
        look: &FrameState,
        lit: &[LayerId],
    ) -> Result<Rendering, RenderError> {
        let sequence = Sequence { quality: alone(quality), ..self.sequence.clone() };
        let meter = Arc::new(ProgressMeter::default());
        let mut frames = FrameLoop::with_aovs(&sequence, aovs, FilmCollector::default(), meter);
        let (film, took) = timed(|| self.pool.install(|| frames.trace(&look.alone(), lit)));
        Ok(Rendering { films: film?.into_iter().collect(), took, rays: frames.stats().counts.rays.total() })
    }

    /// Runs a function in the renderer's thread pool.
    pub fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        self.pool.install(work)
    }

    /// The start of the first frame.
    pub fn time(&self) -> Time {
        let first = self.frames.first().copied().unwrap_or_default();
        self.sequence.timeline.clock(first).start
    }

    /// Calls `see` with the scene of the first frame; `None` if that frame has no camera.
    pub fn scene<T>(&self, see: impl FnOnce(&Scene) -> T) -> Option<T> {
        let first = self.frames.first().copied().unwrap_or_default();
        Preview::with_rays(&self.sequence).scene_of(first, see)
    }

    /// The possible layerings with their numbers of film layers, in ascending order; each number occurs once, and the
    /// sequence's own layering is included. Empty unless one frame with several lights is measured.
    pub fn layerings(&self) -> Vec<(Layering, u64)> {
        if self.frames.len() != 1 || self.sequence.lights.len() < 2 {
            return Vec::new();
        }
        let count = |layering: Layering| (layering, layering.of(&self.sequence, self.time()).layers());
        let own = count(Layering::AsKeyed);
        let others = [Layering::Merged, Layering::Separate].map(count);
        let mut all: Vec<_> =
            others.into_iter().filter(|(_, layers)| *layers != own.1).chain([own]).collect();
        all.sort_by_key(|(_, layers)| *layers);
        all
    }

    /// Whether pixels have random samples in any of the frames with an integrator.
    pub fn is_random(&self, integrator: Integrator) -> bool {
        self.are_random(integrator).contains(&true)
    }

    /// The same for each frame.
    pub fn are_random(&self, integrator: Integrator) -> Vec<bool> {
        let quality = Quality { integrator, ..self.sequence.quality };
        let sequence = Sequence { quality, ..self.sequence.clone() };
        frame_states(&sequence, &self.frames, &Stop::default()).iter().map(|look| look.random).collect()
    }

    /// The displayed colours of frames with this radiance, each frame at its exposure.
    pub fn displayed(&self, exposures: &[f32], radiance: &[Rgb]) -> Vec<[f32; 3]> {
        let each = (radiance.len() / exposures.len().max(1)).max(1);
        let frames = radiance.chunks(each).zip(exposures);
        let pixel = |light: Rgb| displayed(self.sequence.output.tonemap, light).map(|value| value as f32);
        frames
            .flat_map(|(frame, &exposure)| frame.iter().map(move |&light| pixel(light * exposure)))
            .collect()
    }
}

/// The quality of frames that share no samples and are not denoised. Settings are compared frame by frame, by their samples.
fn alone(quality: &Quality) -> Quality {
    Quality { reuse: SampleReuse::Off, denoise: Denoise::Off, ..*quality }
}

impl Rendering {
    /// The radiance of all frames, one after the other.
    pub fn radiance(&self) -> Vec<Rgb> {
        self.films.iter().flat_map(Film::radiance).collect()
    }

    /// The exposure factor of each frame.
    pub fn exposures(&self) -> Vec<f32> {
        self.films.iter().map(|film| film.exposure).collect()
    }

    /// The contribution of one film layer to the radiance.
    pub fn radiance_of(&self, layer: usize) -> Vec<Rgb> {
        let of = |film: &Film| {
            let pixels = film.width as usize * film.height as usize;
            (0..pixels).map(|pixel| film.radiance_of(pixel, layer)).collect::<Vec<_>>()
        };
        self.films.iter().flat_map(of).collect()
    }
}
