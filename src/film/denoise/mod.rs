//! Denoises films of random samples, and measures the error that is left.
//!
//! The samples of a picture are traced as two films, the halves of one sequence. At several scales, the light of each
//! half in a window is fitted by a linear function of guides: position, distance, albedo and normal of the surfaces
//! that are seen (first-order regression after Bitterli, Rousselle et al., "Nonlinearly weighted first-order regression
//! for denoising Monte Carlo renderings", 2016; windows that overlap instead of weights after He, Sun, Tang, "Guided
//! image filtering", 2010). The fits of each half are compared with the samples of the other one, which shows the error
//! of every scale around each pixel. The samples themselves are candidates, with and without outliers, so more samples
//! lead to the truth.
//!
//! Two small films of other samples, the audits, are never part of the picture. They show how much of the filter's
//! changes to keep (`trust`), and the squared error of the result, bias included, without bias (`error`).
//!
//! Every layer of light is filtered on its own, so the picture stays a weighted sum of layers.

mod audits;
mod calibration;
mod candidates;
mod choice;
mod columns;
mod error;
mod guides;
mod halves;
mod measured;
mod memory;
mod neighbors;
mod outliers;
mod planes;
mod regression;
mod surroundings;
#[cfg(test)]
mod tests;
mod trial;
mod trust;

pub use error::RemainingError;
pub use halves::Halves;
pub use memory::Memory;
pub use neighbors::{Neighbor, Places, RUN, Reprojection, Run, Views};
pub use trial::trial;

use super::aov::GUIDES;
use super::{AovSet, Film};
use crate::base::color::Rgb;
use crate::base::lanes::dispatch;
use audits::AuditRow;
use calibration::Calibration;
use candidates::{Candidates, LayerCandidates};
use choice::MixRow;
use columns::Columns;
use guides::Guides;
use measured::Measured;
use planes::{Planes, channels_mut};
use rayon::prelude::*;
use std::sync::Arc;
use surroundings::surroundings;
use trust::Trust;

/// Films of the same scene that make one denoised film.
#[derive(Clone, Copy)]
pub struct SampleFilms<'a> {
    /// The samples of the picture.
    pub halves: &'a Halves,
    /// Pictures before and after it that may show the same light.
    pub neighbors: &'a [Neighbor<'a>],
    /// Two sets of samples that are independent of all others.
    pub audits: [&'a Film; 2],
}

/// Samples per pixel of each audit of a picture of so many samples.
pub fn samples_of_audit(picture: u32) -> u32 {
    (picture / 8).max(2)
}

/// Bytes per pixel of a layer while it is filtered: what is measured of its candidates, at the pixel and around it, and
/// changes.
const BYTES_OF_LAYER: u64 =
    Measured::BYTES_PER_PIXEL + ((candidates::CANDIDATES + trust::NUMBERS) * size_of::<f32>()) as u64;

/// Bytes that denoising a picture of this size takes besides the film, if it has so many layers of light and that many
/// neighbours.
pub fn bytes((width, height): (u32, u32), layers: u64, neighbors: u64) -> u64 {
    // Rows are padded: all numbers to columns, and guides to eight of these.
    let columns = Columns::new(width as usize);
    let [row, guides] = [columns.pixels(), columns.of_row()].map(|pixels| pixels as u64 * u64::from(height));
    // All films, and the filtered light.
    let films = 2 * (layers + GUIDES as u64) * (1 + neighbors) + 2 * layers + layers;
    let halves = Halves::bytes_of_pixel(layers).saturating_mul(1 + neighbors);
    let light = films.saturating_mul(size_of::<Rgb>() as u64).saturating_add(halves);
    let pooled = if neighbors > 0 { candidates::BYTES_OF_POOLED } else { 0 };
    let pixel =
        light.saturating_add(candidates::bytes_of_pixel(layers)).saturating_add(BYTES_OF_LAYER + pooled);
    let reprojected = neighbors * Neighbor::BYTES_PER_PIXEL;
    let pixel = pixel.saturating_add(reprojected);
    // Of both halves: those of the picture, and pooled ones to fit light to and to show fits at.
    let sets = if neighbors > 0 { 6 } else { 2 };
    row.saturating_mul(pixel).saturating_add(sets * guides * Guides::BYTES_PER_PIXEL)
}

/// Denoises a picture. The film holds no guides. `samples` is the number of samples per pixel of all films. Memory is
/// that of the halves.
pub fn denoise(films: &SampleFilms, samples: f64) -> Film {
    let first = films.halves.film();
    let aovs = AovSet { guides: false, ..first.aovs };
    let mut film = Film::with_aovs(first.width, first.height, first.weights.clone(), aovs);
    let filtered = filter(films);
    let (layers, lights, width) = (film.layers(), film.held.len(), film.width as usize);
    film.data_mut().par_chunks_exact_mut((width * layers).max(1)).enumerate().for_each(|(y, row)| {
        for layer in 0..lights {
            let [red, green, blue] = filtered.channels(layer, y);
            for (x, pixel) in row.chunks_exact_mut(layers).enumerate() {
                pixel[layer] = Rgb::new(red[x], green[x], blue[x]);
            }
        }
        for (x, pixel) in row.chunks_exact_mut(layers).enumerate() {
            for (layer, value) in pixel.iter_mut().enumerate().skip(lights) {
                *value = films.halves.mean(y * width + x, layer);
            }
        }
    });
    film.samples = aovs.samples.then(|| {
        let pixels = 0..first.width as usize * first.height as usize;
        let samples = |pixel| (0..lights).map(move |layer| films.halves.mean(pixel, layer));
        Arc::new(pixels.flat_map(samples).collect())
    });
    let remaining = RemainingError::measure(&film, &films.audits, samples);
    film.noise = Some(remaining.of(&film.weights));
    film.remaining = Some(Arc::new(remaining));
    films.halves.memory().settle();
    film
}

/// The filtered light of all layers.
fn filter(films: &SampleFilms) -> Planes {
    let film = films.halves.film();
    let layers = film.held.len();
    let size = (film.width as usize, film.height as usize);
    let mut filtered = Planes::unset(films.halves.memory(), size, 3 * layers);
    let candidates = Candidates::new(films.halves);
    for layer in 0..layers {
        filter_layer(&candidates.of_layer(layer, films.neighbors), layer, films.audits, &mut filtered);
    }
    filtered
}

/// Filters a layer of light.
fn filter_layer(candidates: &LayerCandidates, layer: usize, audits: [&Film; 2], filtered: &mut Planes) {
    let measured = Measured::new(candidates, layer, audits);
    let around = surroundings(&measured, candidates.count());
    let calibration = Calibration::new(candidates, &measured, &around);
    let (stride, mut changes) = (filtered.stride, filtered.unset_like(trust::NUMBERS));
    let of_layer = 3 * layer * stride;
    filtered.par_lines_mut().zip(changes.par_lines_mut()).enumerate().for_each(|(y, (line, changes))| {
        let candidates = candidates.row(y);
        let audits = AuditRow::new(audits, layer, y);
        let light = channels_mut(&mut line[of_layer..][..3 * stride], stride);
        let (around, calibration) = (&around, &calibration);
        dispatch(MixRow { candidates, around, calibration, audits, y, light, changes });
    });
    let trust = Trust::new(&changes);
    filtered.par_lines_mut().enumerate().for_each(|(y, line)| {
        let (samples, shares) = (candidates.samples(y), trust.samples(y, &changes));
        for (light, halves) in line[of_layer..].chunks_exact_mut(stride).zip(samples) {
            // Without branches, the compiler finds lanes.
            let samples = halves[0].iter().zip(halves[1]);
            for ((light, share), (first, second)) in light.iter_mut().zip(&shares).zip(samples) {
                let mixed = *light + ((first + second) * 0.5 - *light) * share;
                *light = if *share > 0.0 { mixed } else { *light };
            }
        }
    });
}
