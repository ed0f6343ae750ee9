//! Denoises films of random samples, and measures the error that is left.
//!
//! The samples of a picture are traced as two films, the halves of one sequence. At several scales, the light of each half
//! in a window is fitted by a linear function of guides: position, distance, albedo and normal of the surfaces that are
//! seen (first-order regression after Bitterli, Rousselle et al., "Nonlinearly weighted first-order regression for denoising
//! Monte Carlo renderings", 2016; windows that overlap instead of weights after He, Sun, Tang, "Guided image filtering",
//! 2010). The fits of each half are compared with the samples of the other one, which shows the error of every scale around
//! each pixel. The samples themselves are candidates, with and without outliers, so more samples lead to the truth.
//!
//! Two small films of other samples, the audits, are never part of the picture. They show how much of the filter's changes
//! to keep (see [`trust`]), and the squared error of the result, bias included, without bias (see [`error`]).
//!
//! Every layer of light is filtered on its own, so the picture stays a weighted sum of layers.

mod candidates;
mod choice;
mod error;
mod guides;
mod outliers;
mod regression;
#[cfg(test)]
mod tests;
mod trial;
mod trust;

pub use error::RemainingError;
pub use trial::trial;

use super::aov::GUIDES;
use super::{AovSet, Film};
use crate::base::color::Rgb;
use candidates::Candidates;
use choice::Choice;
use rayon::prelude::*;
use std::sync::Arc;
use trust::{Change, Trust};

/// Films of the same scene that make one denoised film.
#[derive(Clone, Copy, Debug)]
pub struct SampleFilms<'a> {
    /// The samples of the picture, half of them each, with guides.
    pub halves: [&'a Film; 2],
    /// Two sets of samples that are independent of all others.
    pub audits: [&'a Film; 2],
}

impl SampleFilms<'_> {
    /// The mean of both halves, in a layer of light or of an AOV.
    fn samples(&self, pixel: usize, layer: usize) -> Rgb {
        let [first, second] = self.halves.map(|film| film.pixel(pixel)[layer]);
        (first + second) * 0.5
    }

    /// The light of both audits.
    fn audit(&self, pixel: usize, layer: usize) -> [Rgb; 2] {
        self.audits.map(|film| film.pixel(pixel)[layer])
    }
}

/// Samples per pixel of each audit of a picture of so many samples.
pub fn samples_of_audit(picture: u32) -> u32 {
    (picture / 8).max(2)
}

/// Bytes per pixel that denoising takes besides the film, if it has so many layers of light.
pub fn bytes_of_pixel(layers: u64) -> u64 {
    let films = (2 * (layers + GUIDES as u64) + 2 * layers) * size_of::<Rgb>() as u64;
    films + candidates::bytes_of_pixel(layers) + choice::BYTES_PER_PIXEL + trust::BYTES_PER_PIXEL
}

/// Denoises a picture. The film holds no guides. `samples` is the number of samples per pixel of all films.
pub fn denoise(films: &SampleFilms, samples: f64) -> Film {
    let [first, _] = films.halves;
    let aovs = AovSet { guides: false, ..first.aovs };
    let mut film = Film::with_aovs(first.width, first.height, first.weights.clone(), aovs);
    let filtered = filter(films);
    let (layers, lights) = (film.layers(), film.held.len());
    film.data_mut().par_chunks_exact_mut(layers.max(1)).enumerate().for_each(|(pixel, data)| {
        let (light, others) = data.split_at_mut(lights);
        light.copy_from_slice(&filtered[pixel * lights..][..lights]);
        for (layer, value) in (lights..).zip(others) {
            *value = films.samples(pixel, layer);
        }
    });
    film.samples = aovs.samples.then(|| {
        let pixels = 0..first.width as usize * first.height as usize;
        let samples = |pixel| (0..lights).map(move |layer| films.samples(pixel, layer));
        Arc::new(pixels.flat_map(samples).collect())
    });
    let remaining = RemainingError::measure(&film, &films.audits, samples);
    film.noise = Some(remaining.of(&film.weights));
    film.remaining = Some(Arc::new(remaining));
    film
}

/// The filtered light: all layers of each pixel, row by row.
fn filter(films: &SampleFilms) -> Vec<Rgb> {
    let [film, _] = films.halves;
    let (size, layers) = ((film.width as usize, film.height as usize), film.held.len());
    let candidates = Candidates::new(films.halves);
    let mut filtered = vec![Rgb::ZERO; size.0 * size.1 * layers];
    for layer in 0..layers {
        let choice = Choice::new(size, |pixel| candidates.measure(pixel, layer, films.audit(pixel, layer)));
        filtered.par_chunks_exact_mut(layers).enumerate().for_each(|(pixel, light)| {
            let [first, second] = candidates.at(pixel, layer);
            let means = first.into_iter().zip(second).map(|(first, second)| (first + second) * 0.5);
            let light_of_all: Rgb =
                means.zip(choice.weights(pixel)).map(|(light, weight)| light * weight).sum();
            light[layer] = if light_of_all.is_finite() { light_of_all } else { films.samples(pixel, layer) };
        });
        let change = |(pixel, light): (usize, &[Rgb])| {
            let change = [films.samples(pixel, layer), light[layer]];
            let unit = candidates.unit(pixel, layer);
            Change::new(change, films.audit(pixel, layer), choice.noise(pixel), unit)
        };
        let changes: Vec<Change> = filtered.par_chunks_exact(layers).enumerate().map(change).collect();
        let trust = Trust::new(size.0, &changes);
        filtered.par_chunks_exact_mut(layers).zip(&changes).enumerate().for_each(
            |(pixel, (light, change))| {
                let share = trust.samples(pixel, size.0, change);
                if share > 0.0 {
                    light[layer] += (films.samples(pixel, layer) - light[layer]) * share;
                }
            },
        );
    }
    filtered
}
