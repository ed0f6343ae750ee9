//! Settings in turn, and the references that their pictures are compared with.

use super::Layer;
use super::sizing::{PARTS, work};
use super::tried::Tried;
use crate::accuracy::change::Change;
use crate::accuracy::image_error::{Flip, PIXELS_PER_DEGREE, References};
use crate::accuracy::settings::Settings;
use crate::accuracy::studio::{Shot, Studio};
use crate::base::math::DVec3;
use crate::pipeline::render::RenderError;
use crate::sampling::{Points, hash};
use crate::sequence::Sequence;
use crate::sequence::quality::Quality;
use std::time::Instant;

/// References with what comparing needs of them.
pub struct Reference {
    pub pair: References,
    pub displayed: Vec<[f32; 3]>,
    /// One for each frame.
    pub flips: Vec<Flip>,
    /// Of each layer, if there are several.
    pub layers: Vec<References>,
}

/// The work in hand.
pub struct Bench<'a> {
    studio: &'a Studio,
    pub settings: Settings,
    own: Quality,
    pub tries: Vec<Tried>,
    progress: &'a mut dyn FnMut(f64),
    done: f64,
    whole: f64,
}

impl<'a> Bench<'a> {
    pub fn new(
        studio: &'a Studio,
        settings: Settings,
        own: &Quality,
        progress: &'a mut dyn FnMut(f64),
    ) -> Self {
        let tries = settings.all.iter().map(|_| Tried::default()).collect();
        let whole = work(&settings);
        Self { studio, settings, own: *own, tries, progress, done: 0.0, whole }
    }

    /// One picture of so many samples in a pixel.
    fn shoot(&mut self, quality: &Quality, change: Change, samples: f64) -> Result<Shot, RenderError> {
        let shot = self.studio.shoot_changed(quality, change)?;
        self.done += samples;
        (self.progress)((self.done / self.whole).min(1.0));
        Ok(shot)
    }

    /// What the file's own setting would show without noise, twice.
    pub fn reference(&mut self) -> Result<Reference, RenderError> {
        let samples = self.settings.reference;
        let quality = &Quality { samples, noise: None, points: Points::Sobol, ..self.own };
        let mut shots = Vec::new();
        for which in 0..2 {
            shots.push(match self.settings.random {
                true => self.long(quality, which)?,
                // Two fine grids whose samples fall on different places.
                false => {
                    let finest = libm::sqrt(f64::from(self.settings.reference)).ceil() as u32 + which;
                    let samples = f64::from(finest * finest);
                    self.shoot(&Quality { antialias: finest, ..*quality }, Change::None, samples)?
                }
            });
        }
        let pair = References { a: shots[0].radiance(), b: shots[1].radiance() };
        let displayed = self.studio.displayed(&shots[0].exposures(), &pair.best());
        let (width, each) = (self.studio.size().0 as usize, displayed.len() / self.studio.frames());
        let flips =
            displayed.chunks(each.max(1)).map(|frame| Flip::new(frame, width, PIXELS_PER_DEGREE)).collect();
        let count = shots[0].films.first().map_or(0, |film| film.weights.len());
        let layers = if count > 1 { 0..count } else { 0..0 };
        let layers =
            layers.map(|layer| References { a: shots[0].radiance_of(layer), b: shots[1].radiance_of(layer) });
        let layers = layers.collect();
        Ok(Reference { pair, displayed, flips, layers })
    }

    /// Many samples, as the mean of several sets of them.
    fn long(&mut self, quality: &Quality, which: u32) -> Result<Shot, RenderError> {
        let mut sums: Vec<Vec<DVec3>> = Vec::new();
        let mut last = None;
        for part in 0..PARTS {
            let seed = hash([self.own.seed, part, 2 + which]);
            let samples = quality.samples.div_ceil(PARTS);
            let shot =
                self.shoot(&Quality { samples, seed, ..*quality }, Change::None, f64::from(samples))?;
            sums.resize(shot.films.len(), Vec::new());
            for (sum, film) in sums.iter_mut().zip(&shot.films) {
                sum.resize(film.data.len(), DVec3::ZERO);
                sum.iter_mut().zip(film.data.iter()).for_each(|(sum, value)| *sum += value.as_dvec3());
            }
            last = Some(shot);
        }
        let mut shot = match last {
            Some(shot) => shot,
            None => self.shoot(quality, Change::None, f64::from(quality.samples))?,
        };
        for (film, sum) in shot.films.iter_mut().zip(sums) {
            let mean = |sum: DVec3| (sum / f64::from(PARTS)).as_vec3();
            film.data_mut().iter_mut().zip(sum).for_each(|(value, sum)| *value = mean(sum));
        }
        Ok(shot)
    }

    /// All settings in turn, again and again, so that whatever else the machine does falls on all of them.
    /// After so many runs of all of them, the rest is left out where the time is over.
    pub fn run(&mut self, reference: &Reference, end: Instant) -> Result<(), RenderError> {
        const LEAST: u32 = 4;
        let runs = self.settings.all.iter().map(|setting| setting.runs).max().unwrap_or(0);
        for run in 0..runs {
            if run >= LEAST && Instant::now() > end {
                break;
            }
            let seed = hash([self.own.seed, run, 1]);
            for index in 0..self.settings.all.len() {
                let setting = &self.settings.all[index];
                let stopped = self.settings.is_unfinished(index, self.tries[index].capped > 0.0);
                if run >= setting.runs || stopped {
                    continue;
                }
                let setting = setting.clone();
                let shot =
                    self.shoot(&Quality { seed, ..setting.quality }, setting.change, setting.samples)?;
                self.tries[index].add(&shot, &setting, reference, self.studio, run);
            }
        }
        Ok(())
    }

    /// What the file's own setting makes of each layer, over a few runs.
    pub fn layers(&mut self, reference: &Reference, sequence: &Sequence) -> Result<Vec<Layer>, RenderError> {
        let of = &reference.layers;
        if of.is_empty() {
            return Ok(Vec::new());
        }
        let own = &self.tries[0];
        let worst = worst_hundredth(own.errors());
        let mut squares = vec![(0.0, 0.0); of.len()];
        for run in 0..LAYER_RUNS {
            let shot = self.studio.shoot(&Quality { seed: hash([self.own.seed, run, 1]), ..self.own })?;
            for (layer, (pair, sums)) in of.iter().zip(&mut squares).enumerate() {
                let errors = pair.squared_errors(&shot.radiance_of(layer));
                sums.0 += errors.iter().sum::<f64>() / (errors.len().max(1) * LAYER_RUNS as usize) as f64;
                sums.1 += worst.iter().map(|&pixel| errors[pixel].max(0.0)).sum::<f64>();
            }
        }
        let whole = reference.pair.brightness();
        let of_all: f64 = squares.iter().map(|(_, worst)| worst).sum();
        let layers = of.iter().zip(squares).zip(sequence.about().layers);
        let layer = |((pair, (square, in_worst)), name): ((&References, (f64, f64)), String)| {
            let brightness = pair.brightness();
            let error = square.max(0.0).sqrt() / brightness;
            let of_worst = if of_all > 0.0 { in_worst / of_all } else { 0.0 };
            (brightness > 0.0).then(|| Layer { name, share: brightness / whole, error, of_worst })
        };
        Ok(layers.filter_map(layer).collect())
    }
}

/// Runs in which the layers of the worst pixels are compared.
const LAYER_RUNS: u32 = 4;

/// The worst hundredth of the pixels, the worst first.
fn worst_hundredth(errors: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..errors.len()).collect();
    order.sort_by(|&a, &b| errors[b].total_cmp(&errors[a]));
    order.truncate(errors.len().div_ceil(100));
    order
}
