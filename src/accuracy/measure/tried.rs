//! What came of a setting, run by run.

use super::Point;
use super::bench::Reference;
use crate::accuracy::clock::Took;
use crate::accuracy::image_error::{References, psnr};
use crate::accuracy::settings::Setting;
use crate::accuracy::statistics::{Bias, Concentration, Estimate, Spread};
use crate::accuracy::studio::{Shot, Studio};
use crate::base::color::Rgb;
use crate::base::math::DVec3;

/// Runs whose pictures are compared by FLIP, which takes longer than some of them.
const FLIP_RUNS: u32 = 4;

/// What came of a setting so far.
#[derive(Default)]
pub struct Tried {
    took: Vec<Took>,
    rays: u64,
    samples: f64,
    squared: Vec<f64>,
    relative: Vec<f64>,
    psnr: Vec<f64>,
    flip: Vec<f64>,
    /// Of the radiance of even runs and of odd ones.
    halves: [Sum; 2],
    /// Of the squared lengths of the radiance of pixels, over all runs.
    powers: f64,
    concentrations: Vec<Concentration>,
    /// Squared errors of pixels, over all runs.
    errors: Vec<f64>,
    picture: Vec<[f32; 3]>,
    exposures: Vec<f32>,
    flips: Vec<f32>,
    /// Share of the pixels that hit the limit of samples.
    pub capped: f64,
}

/// Pictures added up.
#[derive(Default)]
struct Sum {
    pixels: Vec<DVec3>,
    count: u32,
}

impl Sum {
    fn add(&mut self, radiance: &[Rgb]) {
        self.pixels.resize(radiance.len(), DVec3::ZERO);
        self.pixels.iter_mut().zip(radiance).for_each(|(sum, value)| *sum += value.as_dvec3());
        self.count += 1;
    }

    fn mean(&self) -> Vec<Rgb> {
        let count = f64::from(self.count.max(1));
        self.pixels.iter().map(|sum| (*sum / count).as_vec3()).collect()
    }
}

impl Tried {
    /// Adds a run. What shows the same every time is compared once.
    pub fn add(&mut self, shot: &Shot, setting: &Setting, reference: &Reference, studio: &Studio, run: u32) {
        self.took.push(shot.took);
        self.rays += shot.rays;
        self.exposures = shot.exposures();
        let taken = shot.films.iter().map(|film| film.noise.map(|noise| noise.samples));
        let taken: f64 = taken.map(|taken| taken.unwrap_or(setting.samples)).sum();
        self.samples += taken / studio.frames() as f64;
        let capped = shot.films.iter().filter_map(|film| film.noise).map(|noise| noise.capped);
        self.capped = capped.fold(self.capped, f64::max);
        if !setting.random && run > 0 {
            return;
        }
        let radiance = shot.radiance();
        self.halves[(run % 2) as usize].add(&radiance);
        if !setting.random {
            self.halves[1].add(&radiance);
        }
        self.powers += radiance.iter().map(|light| light.as_dvec3().length_squared()).sum::<f64>();
        let errors = reference.pair.squared_errors(&radiance);
        self.squared.push(errors.iter().sum::<f64>() / errors.len().max(1) as f64);
        self.concentrations.push(Concentration::of(&errors));
        self.errors.resize(errors.len(), 0.0);
        self.errors.iter_mut().zip(&errors).for_each(|(sum, error)| *sum += error);
        self.relative.push(reference.pair.relative_squared_error(&radiance));
        self.look(shot, &radiance, reference, studio, run);
    }

    /// Compares what is displayed.
    fn look(&mut self, shot: &Shot, radiance: &[Rgb], reference: &Reference, studio: &Studio, run: u32) {
        let picture = studio.displayed(&shot.exposures(), radiance);
        let squares = picture
            .iter()
            .zip(&reference.displayed)
            .flat_map(|(a, b)| (0..3).map(move |i| f64::from(a[i] - b[i]) * f64::from(a[i] - b[i])));
        self.psnr.push(psnr(squares.sum::<f64>() / (3 * picture.len()) as f64));
        if run < FLIP_RUNS {
            let each = (picture.len() / reference.flips.len().max(1)).max(1);
            let frames = picture.chunks(each).zip(&reference.flips);
            let map: Vec<f32> = frames.flat_map(|(frame, flip)| flip.map(frame)).collect();
            self.flip.push(map.iter().map(|&value| f64::from(value)).sum::<f64>() / map.len() as f64);
            if run == 0 {
                (self.picture, self.flips) = (picture, map);
            }
        }
    }

    /// Squared errors of pixels, over all runs.
    pub fn errors(&self) -> &[f64] {
        &self.errors
    }

    /// The mean of all runs.
    fn mean(&self) -> Vec<Rgb> {
        let [even, odd] = &self.halves;
        let count = f64::from((even.count + odd.count).max(1));
        let sums = even.pixels.iter().enumerate();
        let odd = |pixel: usize| odd.pixels.get(pixel).copied().unwrap_or_default();
        sums.map(|(pixel, sum)| ((*sum + odd(pixel)) / count).as_vec3()).collect()
    }

    /// The variance of a pixel between runs, summed over its channels: the mean over pixels.
    fn variance(&self, mean: &[Rgb]) -> f64 {
        let runs = self.squared.len() as f64;
        if runs < 2.0 {
            return 0.0;
        }
        let squares: f64 = mean.iter().map(|light| light.as_dvec3().length_squared()).sum();
        ((self.powers - runs * squares) / (runs - 1.0) / mean.len().max(1) as f64).max(0.0)
    }

    /// What is known in the end; `twin` is what it is compared with if that is not the reference.
    pub fn point(
        &self,
        setting: Setting,
        twin: Option<&Self>,
        reference: &Reference,
        studio: &Studio,
    ) -> Point {
        let (count, frames) = (self.took.len() as f64, studio.frames() as f64);
        let wall: Vec<f64> = self.took.iter().map(|took| took.wall / frames).collect();
        let cpu: Option<Vec<f64>> = self.took.iter().map(|took| Some(took.cpu? / frames)).collect();
        let mean = self.mean();
        let runs = self.concentrations.len().max(1) as f64;
        let concentration =
            self.concentrations.iter().fold(Concentration::default(), |sum, one| Concentration {
                worst_hundredth: sum.worst_hundredth + one.worst_hundredth / runs,
                nine_tenths: sum.nine_tenths + one.nine_tenths / runs,
            });
        let heavy = concentration.is_heavy();
        let estimate = if heavy { Estimate::bootstrapped } else { Estimate::of };
        let [even, odd] = self.halves.each_ref().map(Sum::mean);
        let bias = match twin {
            Some(twin) => {
                let [a, b] = twin.halves.each_ref().map(Sum::mean);
                Bias::of(&differences(&even, &a), &differences(&odd, &b))
            }
            None => {
                let References { a, b } = &reference.pair;
                Bias::of(&differences(&even, a), &differences(&odd, b))
            }
        };
        let settled = studio.displayed(&self.exposures, &mean);
        Point {
            wall: Spread::of(&wall),
            cpu: cpu.map(|cpu| Spread::of(&cpu)),
            rays: self.rays as f64 / count / frames,
            samples: self.samples / count,
            squared: estimate(&self.squared),
            relative: estimate(&self.relative),
            psnr: Estimate::of(&self.psnr),
            flip: Estimate::of(&self.flip),
            bias,
            largest_change: twin.map_or(0.0, |twin| {
                largest_change(&settled, &studio.displayed(&twin.exposures, &twin.mean()))
            }),
            variance: self.variance(&mean),
            concentration,
            errors: self.errors.iter().map(|sum| (sum / runs) as f32).collect(),
            capped: self.capped,
            picture: self.picture.clone(),
            runs: self.squared.clone(),
            flips: self.flips.clone(),
            setting,
        }
    }
}

fn differences(a: &[Rgb], b: &[Rgb]) -> Vec<DVec3> {
    a.iter().zip(b).map(|(a, b)| a.as_dvec3() - b.as_dvec3()).collect()
}

/// The largest difference between what two pictures display, from 0 to 1.
fn largest_change(a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
    let changes = a.iter().zip(b).flat_map(|(a, b)| (0..3).map(move |i| (a[i] - b[i]).abs()));
    f64::from(changes.fold(0.0, f32::max))
}
