//! Renders the references, and all settings in turn.

use super::point::Layer;
use super::reference::Reference;
use super::results::SettingResults;
use super::sizing::{REFERENCE_PARTS, total_samples};
use crate::accuracy::change::SceneChange;
use crate::accuracy::image_error::{Flip, PIXELS_PER_DEGREE, ReferencePair};
use crate::accuracy::renderer::{Renderer, Rendering};
use crate::accuracy::settings::Experiment;
use crate::base::math::DVec3;
use crate::pipeline::render::RenderError;
use crate::sampling::{SamplerKind, hash};
use crate::sequence::Sequence;
use crate::sequence::quality::Quality;
use std::time::Instant;

/// A running measurement: its settings, the results so far, and the progress.
pub struct Benchmark<'a> {
    pub(super) renderer: &'a Renderer,
    pub settings: Experiment,
    pub(super) own: Quality,
    pub results: Vec<SettingResults>,
    progress: &'a mut dyn FnMut(f64),
    done: f64,
    whole: f64,
}

impl<'a> Benchmark<'a> {
    pub fn new(
        renderer: &'a Renderer,
        settings: Experiment,
        own: &Quality,
        progress: &'a mut dyn FnMut(f64),
    ) -> Self {
        let results = settings.all.iter().map(|_| SettingResults::default()).collect();
        let whole = total_samples(&settings);
        Self { renderer, settings, own: *own, results, progress, done: 0.0, whole }
    }

    /// Renders once, and reports `samples` per pixel as done.
    fn render(
        &mut self,
        quality: &Quality,
        change: SceneChange,
        samples: f64,
    ) -> Result<Rendering, RenderError> {
        let rendering = self.renderer.render_changed(quality, change)?;
        self.advance(samples);
        Ok(rendering)
    }

    /// Reports `samples` per pixel as done.
    pub(super) fn advance(&mut self, samples: f64) {
        self.done += samples;
        (self.progress)((self.done / self.whole).min(1.0));
    }

    /// The grid of the first reference, if nothing is random.
    pub(super) fn finest_grid(&self) -> u32 {
        libm::sqrt(f64::from(self.settings.reference)).ceil() as u32
    }

    /// Renders the two references: the file's own setting with many samples.
    pub fn reference(&mut self) -> Result<Reference, RenderError> {
        let samples = self.settings.reference;
        let quality = &Quality { samples, noise: None, points: SamplerKind::Sobol, ..self.own };
        let mut renderings = Vec::new();
        for which in 0..2 {
            renderings.push(match self.settings.random {
                true => self.long(quality, which)?,
                // Two fine grids with samples at different positions.
                false => {
                    let finest = self.finest_grid() + which;
                    let samples = f64::from(finest * finest);
                    self.render(&Quality { antialias: finest, ..*quality }, SceneChange::None, samples)?
                }
            });
        }
        let pair = ReferencePair { a: renderings[0].radiance(), b: renderings[1].radiance() };
        let displayed = self.renderer.displayed(&renderings[0].exposures(), &pair.best());
        let (width, each) = (self.renderer.size().0 as usize, displayed.len() / self.renderer.frames());
        let flips =
            displayed.chunks(each.max(1)).map(|frame| Flip::new(frame, width, PIXELS_PER_DEGREE)).collect();
        let count = renderings[0].films.first().map_or(0, |film| film.weights.len());
        let layers = if count > 1 { 0..count } else { 0..0 };
        let layers = layers.map(|layer| ReferencePair {
            a: renderings[0].radiance_of(layer),
            b: renderings[1].radiance_of(layer),
        });
        let layers = layers.collect();
        Ok(Reference { pair, displayed, flips, layers })
    }

    /// Renders many samples as the mean of several sets, so that progress can be reported.
    fn long(&mut self, quality: &Quality, which: u32) -> Result<Rendering, RenderError> {
        let mut sums: Vec<Vec<DVec3>> = Vec::new();
        let mut last = None;
        for part in 0..REFERENCE_PARTS {
            let seed = hash([self.own.seed, part, 2 + which]);
            let samples = quality.samples.div_ceil(REFERENCE_PARTS);
            let rendering =
                self.render(&Quality { samples, seed, ..*quality }, SceneChange::None, f64::from(samples))?;
            sums.resize(rendering.films.len(), Vec::new());
            for (sum, film) in sums.iter_mut().zip(&rendering.films) {
                sum.resize(film.data.len(), DVec3::ZERO);
                sum.iter_mut().zip(film.data.iter()).for_each(|(sum, value)| *sum += value.as_dvec3());
            }
            last = Some(rendering);
        }
        let mut rendering = match last {
            Some(rendering) => rendering,
            None => self.render(quality, SceneChange::None, f64::from(quality.samples))?,
        };
        for (film, sum) in rendering.films.iter_mut().zip(sums) {
            let mean = |sum: DVec3| (sum / f64::from(REFERENCE_PARTS)).as_vec3();
            film.data_mut().iter_mut().zip(sum).for_each(|(value, sum)| *value = mean(sum));
        }
        Ok(rendering)
    }

    /// Renders all settings in turn, run by run, so that other work on the machine affects all of them alike. After
    /// `LEAST` runs of all settings, stops at `end`.
    pub fn run(&mut self, reference: &Reference, end: Instant) -> Result<(), RenderError> {
        const MIN_PIXELS: u32 = 4;
        let runs = self.settings.all.iter().map(|setting| setting.runs).max().unwrap_or(0);
        for run in 0..runs {
            if run >= MIN_PIXELS && Instant::now() > end {
                break;
            }
            let seed = hash([self.own.seed, run, 1]);
            for index in 0..self.settings.all.len() {
                let setting = &self.settings.all[index];
                let stopped = self.settings.is_unfinished(index, self.results[index].capped > 0.0);
                if run >= setting.runs || stopped {
                    continue;
                }
                let setting = setting.clone();
                let rendering =
                    self.render(&Quality { seed, ..setting.quality }, setting.change, setting.samples)?;
                self.results[index].add(&rendering, &setting, reference, self.renderer, run);
            }
        }
        Ok(())
    }

    /// The brightness and the error of each film layer at the file's own setting, from a few runs.
    pub fn layers(&mut self, reference: &Reference, sequence: &Sequence) -> Result<Vec<Layer>, RenderError> {
        let of = &reference.layers;
        if of.is_empty() {
            return Ok(Vec::new());
        }
        let own = &self.results[0];
        let worst = worst_hundredth(own.errors());
        let mut squares = vec![(0.0, 0.0); of.len()];
        for run in 0..LAYER_RUNS {
            let rendering =
                self.renderer.render(&Quality { seed: hash([self.own.seed, run, 1]), ..self.own })?;
            for (layer, (pair, sums)) in of.iter().zip(&mut squares).enumerate() {
                let errors = pair.squared_errors(&rendering.radiance_of(layer));
                sums.0 += errors.iter().sum::<f64>() / (errors.len().max(1) * LAYER_RUNS as usize) as f64;
                sums.1 += worst.iter().map(|&pixel| errors[pixel].max(0.0)).sum::<f64>();
            }
        }
        let whole = reference.pair.brightness();
        let of_all: f64 = squares.iter().map(|(_, worst)| worst).sum();
        let layers = of.iter().zip(squares).zip(sequence.about().layers);
        let layer = |((pair, (square, in_worst)), name): ((&ReferencePair, (f64, f64)), String)| {
            let brightness = pair.brightness();
            let error = square.max(0.0).sqrt() / brightness;
            let of_worst = if of_all > 0.0 { in_worst / of_all } else { 0.0 };
            (brightness > 0.0).then(|| Layer { name, share: brightness / whole, error, of_worst })
        };
        Ok(layers.filter_map(layer).collect())
    }
}

/// Runs from which the errors of film layers are computed.
const LAYER_RUNS: u32 = 4;

/// Indices of the worst 1 % of the pixels, in descending order of their errors.
fn worst_hundredth(errors: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..errors.len()).collect();
    order.sort_by(|&a, &b| errors[b].total_cmp(&errors[a]));
    order.truncate(errors.len().div_ceil(100));
    order
}
