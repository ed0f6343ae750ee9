//! The results of a setting, accumulated over its runs.

use super::point::Point;
use super::reference::Reference;
use crate::accuracy::image_error::{ReferencePair, psnr};
use crate::accuracy::renderer::{Renderer, Rendering};
use crate::accuracy::settings::Setting;
use crate::accuracy::statistics::{Bias, Concentration, ConfidenceInterval, Quartiles};
use crate::base::clock::ElapsedTime;
use crate::base::color::Rgb;
use crate::base::math::DVec3;

/// Runs whose pictures are compared by FLIP, which takes longer than rendering some of them.
const FLIP_RUNS: u32 = 4;

/// The results of a setting over the runs so far.
#[derive(Default)]
pub struct SettingResults {
    took: Vec<ElapsedTime>,
    rays: u64,
    samples: f64,
    squared: Vec<f64>,
    relative: Vec<f64>,
    psnr: Vec<f64>,
    flip: Vec<f64>,
    /// Sums of the radiance of even runs, and of odd runs.
    halves: [Sum; 2],
    /// The sum of squared radiance over pixels, channels and runs.
    powers: f64,
    concentrations: Vec<Concentration>,
    /// Squared error of each pixel, summed over all runs.
    errors: Vec<f64>,
    picture: Vec<[f32; 3]>,
    exposures: Vec<f32>,
    flips: Vec<f32>,
    /// Fraction of the pixels that hit the limit of samples.
    pub capped: f64,
}

/// A sum of pictures.
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

impl SettingResults {
    /// Adds a run. If nothing is random, only the first run is compared, because all pictures are the same.
    pub fn add(
        &mut self,
        rendering: &Rendering,
        setting: &Setting,
        reference: &Reference,
        renderer: &Renderer,
        run: u32,
    ) {
        self.took.push(rendering.took);
        self.rays += rendering.rays;
        self.exposures = rendering.exposures();
        let taken = rendering.films.iter().map(|film| film.noise.map(|noise| noise.samples));
        let taken: f64 = taken.map(|taken| taken.unwrap_or(setting.samples)).sum();
        self.samples += taken / renderer.frames() as f64;
        let capped = rendering.films.iter().filter_map(|film| film.noise).map(|noise| noise.capped);
        self.capped = capped.fold(self.capped, f64::max);
        if !setting.random && run > 0 {
            return;
        }
        let radiance = rendering.radiance();
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
        self.compare_displayed(rendering, &radiance, reference, renderer, run);
    }

    /// Compares the displayed pictures.
    fn compare_displayed(
        &mut self,
        rendering: &Rendering,
        radiance: &[Rgb],
        reference: &Reference,
        renderer: &Renderer,
        run: u32,
    ) {
        let picture = renderer.displayed(&rendering.exposures(), radiance);
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

    /// Squared error of each pixel, summed over all runs.
    pub fn errors(&self) -> &[f64] {
        &self.errors
    }

    /// The mean radiance of all runs.
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

    /// The measured point. It is compared with `baseline` or, without one, with the reference.
    pub fn point(
        &self,
        setting: Setting,
        baseline: Option<&Self>,
        reference: &Reference,
        renderer: &Renderer,
    ) -> Point {
        let (count, frames) = (self.took.len() as f64, renderer.frames() as f64);
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
        let estimate = if heavy { ConfidenceInterval::bootstrapped } else { ConfidenceInterval::of };
        let [even, odd] = self.halves.each_ref().map(Sum::mean);
        let bias = match baseline {
            Some(baseline) => {
                let [a, b] = baseline.halves.each_ref().map(Sum::mean);
                Bias::of(&differences(&even, &a), &differences(&odd, &b))
            }
            None => {
                let ReferencePair { a, b } = &reference.pair;
                Bias::of(&differences(&even, a), &differences(&odd, b))
            }
        };
        let settled = renderer.displayed(&self.exposures, &mean);
        Point {
            wall: Quartiles::of(&wall),
            cpu: cpu.map(|cpu| Quartiles::of(&cpu)),
            rays: self.rays as f64 / count / frames,
            samples: self.samples / count,
            squared: estimate(&self.squared),
            relative: estimate(&self.relative),
            psnr: ConfidenceInterval::of(&self.psnr),
            flip: ConfidenceInterval::of(&self.flip),
            bias,
            largest_change: baseline.map_or(0.0, |baseline| {
                largest_change(&settled, &renderer.displayed(&baseline.exposures, &baseline.mean()))
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

/// The differences of two pictures.
pub fn differences(a: &[Rgb], b: &[Rgb]) -> Vec<DVec3> {
    a.iter().zip(b).map(|(a, b)| a.as_dvec3() - b.as_dvec3()).collect()
}

/// The largest difference between two displayed pictures, from 0 to 1.
fn largest_change(a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
    let changes = a.iter().zip(b).flat_map(|(a, b)| (0..3).map(move |i| (a[i] - b[i]).abs()));
    f64::from(changes.fold(0.0, f32::max))
}
