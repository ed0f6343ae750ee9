//! Settings in turn, and the references that their pictures are compared with.

use super::Layer;
use super::sizing::{PARTS, RUNS, STILL_RUNS, work};
use super::tried::Tried;
use crate::accuracy::layering::Layering;
use crate::accuracy::settings::{Axis, Setting, Settings, samples_of};
use crate::accuracy::studio::{Shot, Studio};
use crate::math::DVec3;
use crate::metrics::{Flip, PIXELS_PER_DEGREE, References};
use crate::quality::Quality;
use crate::render::RenderError;
use crate::sampling::hash;
use crate::sequence::Sequence;

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
    pub runs: u32,
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
        let runs = if settings.random { RUNS } else { STILL_RUNS };
        let whole = work(&settings, own);
        Self { studio, settings, own: *own, runs, tries, progress, done: 0.0, whole }
    }

    fn shoot(&mut self, quality: &Quality) -> Result<Shot, RenderError> {
        self.shoot_in(quality, Layering::Own)
    }

    fn shoot_in(&mut self, quality: &Quality, layering: Layering) -> Result<Shot, RenderError> {
        let shot = self.studio.shoot_in(quality, layering)?;
        self.done += samples_of(quality, self.settings.random);
        (self.progress)((self.done / self.whole).min(1.0));
        Ok(shot)
    }

    /// Those for most axes, and those for bounces.
    pub fn references(&mut self) -> Result<[Reference; 2], RenderError> {
        let [main, deep] = self.settings.references(&self.own);
        Ok([self.reference(&main, false)?, self.reference(&deep, true)?])
    }

    fn reference(&mut self, quality: &Quality, deep: bool) -> Result<Reference, RenderError> {
        let mut shots = Vec::new();
        for which in 0..2 {
            shots.push(match self.settings.random {
                true => self.long(quality, which)?,
                // Two fine grids whose samples fall on different places.
                false => {
                    let finest = libm::sqrt(f64::from(self.settings.reference)).ceil() as u32 + which;
                    let antialias = if deep { quality.antialias } else { finest };
                    self.shoot(&Quality { antialias, ..*quality })?
                }
            });
        }
        let pair = References { a: shots[0].radiance(), b: shots[1].radiance() };
        let displayed = self.studio.displayed(&shots[0].exposures(), &pair.best());
        let (width, each) = (self.studio.size().0 as usize, displayed.len() / self.studio.frames());
        let flips =
            displayed.chunks(each.max(1)).map(|frame| Flip::new(frame, width, PIXELS_PER_DEGREE)).collect();
        let count = shots[0].films.first().map_or(0, |film| film.weights.len());
        let layers = if count > 1 && !deep { 0..count } else { 0..0 };
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
            let shot = self.shoot(&Quality { samples, seed, ..*quality })?;
            sums.resize(shot.films.len(), Vec::new());
            for (sum, film) in sums.iter_mut().zip(&shot.films) {
                sum.resize(film.data.len(), DVec3::ZERO);
                sum.iter_mut().zip(film.data.iter()).for_each(|(sum, value)| *sum += value.as_dvec3());
            }
            last = Some(shot);
        }
        let mut shot = match last {
            Some(shot) => shot,
            None => self.shoot(quality)?,
        };
        for (film, sum) in shot.films.iter_mut().zip(sums) {
            let mean = |sum: DVec3| (sum / f64::from(PARTS)).as_vec3();
            film.data_mut().iter_mut().zip(sum).for_each(|(value, sum)| *value = mean(sum));
        }
        Ok(shot)
    }

    /// All settings in turn, again and again, so that whatever else the machine does falls on all of them.
    pub fn run(&mut self, references: &[Reference; 2]) -> Result<(), RenderError> {
        for run in 0..self.runs {
            let seed = hash([self.own.seed, run, 1]);
            for index in 0..self.settings.all.len() {
                let Setting { axis, quality, layering, .. } = self.settings.all[index];
                if self.settings.is_unfinished(index, self.tries[index].capped > 0.0) {
                    continue;
                }
                let shot = self.shoot_in(&Quality { seed, ..quality }, layering)?;
                let reference = &references[usize::from(axis == Axis::Bounces)];
                let random = self.settings.random;
                self.tries[index].add(&shot, &quality, random, reference, self.studio, run);
            }
        }
        Ok(())
    }

    /// What the file's own setting makes of each layer.
    pub fn layers(
        &mut self,
        references: &[Reference; 2],
        sequence: &Sequence,
    ) -> Result<Vec<Layer>, RenderError> {
        let of = &references[0].layers;
        if of.is_empty() {
            return Ok(Vec::new());
        }
        let shot = self.studio.shoot(&Quality { seed: hash([self.own.seed, 0, 1]), ..self.own })?;
        let whole = references[0].pair.brightness();
        let names = sequence.about().layers;
        let layer = |(index, (pair, name)): (usize, (&References, String))| {
            let brightness = pair.brightness();
            let error = pair.squared_error(&shot.radiance_of(index)).max(0.0).sqrt();
            (brightness > 0.0).then(|| Layer { name, share: brightness / whole, error: error / brightness })
        };
        Ok(of.iter().zip(names).enumerate().filter_map(layer).collect())
    }
}
