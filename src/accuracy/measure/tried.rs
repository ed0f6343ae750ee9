//! What came of a setting, run by run.

use super::Point;
use super::bench::Reference;
use crate::accuracy::clock::Took;
use crate::accuracy::settings::{Axis, Setting, samples_of};
use crate::accuracy::statistics::{Estimate, Spread};
use crate::accuracy::studio::{Shot, Studio};
use crate::color::Rgb;
use crate::math::DVec3;
use crate::metrics::psnr;
use crate::quality::Quality;

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
    sum: Vec<DVec3>,
    picture: Vec<[f32; 3]>,
    exposures: Vec<f32>,
    flips: Vec<f32>,
    /// Share of the pixels that had all the samples that they may.
    pub capped: f64,
}

impl Tried {
    pub fn add(
        &mut self,
        shot: &Shot,
        quality: &Quality,
        random: bool,
        reference: &Reference,
        studio: &Studio,
        run: u32,
    ) {
        let radiance = shot.radiance();
        self.took.push(shot.took);
        self.rays += shot.rays;
        self.exposures = shot.exposures();
        let taken = shot.films.iter().map(|film| film.noise.map(|noise| noise.samples));
        let taken: f64 = taken.map(|taken| taken.unwrap_or_else(|| samples_of(quality, random))).sum();
        self.samples += taken / studio.frames() as f64;
        self.capped = shot
            .films
            .iter()
            .filter_map(|film| film.noise)
            .map(|noise| noise.capped)
            .fold(self.capped, f64::max);
        self.sum.resize(radiance.len(), DVec3::ZERO);
        self.sum.iter_mut().zip(&radiance).for_each(|(sum, value)| *sum += value.as_dvec3());
        if !random && run > 0 {
            return;
        }
        self.squared.push(reference.pair.squared_error(&radiance));
        self.relative.push(reference.pair.relative_squared_error(&radiance));
        let picture = studio.displayed(&shot.exposures(), &radiance);
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

    pub fn point(self, setting: Setting, references: &[Reference; 2], studio: &Studio) -> Point {
        let (count, frames) = (self.took.len() as f64, studio.frames() as f64);
        let reference = &references[usize::from(setting.axis == Axis::Bounces)];
        let wall: Vec<f64> = self.took.iter().map(|took| took.wall / frames).collect();
        let cpu: Option<Vec<f64>> = self.took.iter().map(|took| Some(took.cpu? / frames)).collect();
        let mean: Vec<Rgb> = self.sum.iter().map(|sum| (*sum / count).as_vec3()).collect();
        let squared = Estimate::of(&self.squared);
        // Of the products of all runs with each other, those with themselves hold their noise.
        let bias = match self.squared.len() as f64 {
            n if n > 1.0 => (n * reference.pair.squared_error(&mean) - squared.mean) / (n - 1.0),
            _ => squared.mean,
        };
        Point {
            wall: Spread::of(&wall),
            cpu: cpu.map(|cpu| Spread::of(&cpu)),
            rays: self.rays as f64 / count / frames,
            samples: self.samples / count,
            squared,
            relative: Estimate::of(&self.relative),
            psnr: Estimate::of(&self.psnr),
            flip: Estimate::of(&self.flip),
            bias,
            picture: self.picture,
            settled: studio.displayed(&self.exposures, &mean),
            runs: self.squared,
            flips: self.flips,
            setting,
        }
    }
}
