//! The error that is left in a denoised film.

use super::super::{Film, LayerId, Noise, Z_95};
use crate::base::color::Rgb;
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// The side of the blocks in which errors are summed, in pixels: noise of different blocks is independent, and bias
/// hardly depends on that of others.
const BLOCK: usize = 8;

/// The squared error of a denoised film, with any weights of its layers.
///
/// Let F be a value of the denoised film, T the truth, and a and b those of the audits, which are independent of F and
/// of each other and have no bias. Then the mean of (F - a) (F - b) is (F - T)², the squared error of F, whatever made
/// F. For two layers, the squares become products, so sums of products give the error with any weights.
#[derive(Clone, Debug, PartialEq)]
#[warn(missing_docs)]
pub struct RemainingError {
    /// Samples per pixel.
    samples: f64,
    /// The layers of light in the film.
    held: Arc<[LayerId]>,
    /// The pixels of each block.
    pixels: Vec<f64>,
    /// Per block: for each pair of layers (the second not above the first), the sums of the products per channel.
    products: Vec<DVec3>,
    /// The mean light of each layer over the picture.
    means: Vec<DVec3>,
}

#[warn(missing_docs)]
impl RemainingError {
    /// Measures the error of a film, which none of the audits' samples has a part in.
    pub(super) fn measure(film: &Film, audits: &[&Film; 2], samples: f64) -> Self {
        let layers = film.held.len();
        let (width, height) = (film.width as usize, film.height as usize);
        let columns = width.div_ceil(BLOCK);
        let blocks: Vec<BlockSums> = (0..columns * height.div_ceil(BLOCK))
            .into_par_iter()
            .map(|block| {
                let [left, top] = [block % columns, block / columns].map(|place| place * BLOCK);
                let [across, down] = [left..width.min(left + BLOCK), top..height.min(top + BLOCK)];
                BlockSums::new(down.map(|y| y * width + across.start..y * width + across.end), film, audits)
            })
            .collect();
        let mut means = vec![DVec3::ZERO; layers];
        for block in &blocks {
            means.iter_mut().zip(&block.light).for_each(|(mean, light)| *mean += *light);
        }
        means.iter_mut().for_each(|mean| *mean /= (width * height).max(1) as f64);
        let pixels = blocks.iter().map(|block| block.pixels).collect();
        let products = blocks.into_iter().flat_map(|block| block.products).collect();
        Self { samples, held: Arc::clone(&film.held), pixels, products, means }
    }

    /// The error with these weights. A squared error that is smaller than its own standard deviation, or even negative,
    /// is stated as that: smaller errors do not differ significantly from 0. The interval holds the true error in about
    /// 95 of 100 frames. Without two blocks, or if light overflows, nothing is known of the error: it and its interval
    /// are infinite.
    pub fn of(&self, weights: &[Rgb]) -> Noise {
        let weighted =
            self.means.iter().zip(self.held_weights(weights)).filter(|(_, weight)| *weight != DVec3::ZERO);
        let mean = weighted.map(|(mean, weight)| *mean * weight).sum::<DVec3>().element_sum() / 3.0;
        if mean <= 0.0 {
            return Noise { samples: self.samples, denoised: Some(true), ..Noise::default() };
        }
        let (square, variance) = self.square(weights);
        if self.pixels.len() < 2 || !(mean.is_finite() && square.is_finite() && variance.is_finite()) {
            let (error, high) = (f64::INFINITY, f64::INFINITY);
            return Noise { error, high, samples: self.samples, denoised: Some(true), ..Noise::default() };
        }
        let (deviation, within) = (variance.sqrt(), Z_95 * variance.sqrt());
        // The interval is never below the error that is stated.
        let stated = square.max(deviation);
        let [error, low, high] =
            [stated, square - within, stated + within].map(|square| square.max(0.0).sqrt() / mean);
        Noise { error, low, high, samples: self.samples, capped: 0.0, denoised: Some(true) }
    }

    /// The estimate of the mean squared error over pixels and channels with these weights, and its variance. The
    /// estimate may be negative by chance.
    pub(super) fn square(&self, weights: &[Rgb]) -> (f64, f64) {
        let weights: Vec<DVec3> = self.held_weights(weights).collect();
        let pairs = weights.len() * (weights.len() + 1) / 2;
        let blocks = self.products.chunks_exact(pairs.max(1));
        let squares: Vec<f64> = blocks.map(|block| square(block, &weights)).collect();
        let (sum, pixels) = (squares.iter().sum::<f64>(), self.pixels.iter().sum::<f64>());
        // The sum varies as sums of as many blocks vary.
        let deviations = squares.iter().zip(&self.pixels).map(|(square, own)| square - sum * own / pixels);
        let count = squares.len() as f64;
        let variance =
            deviations.map(|deviation| deviation * deviation).sum::<f64>() * count / (count - 1.0).max(1.0);
        let values = 3.0 * pixels;
        (sum / values, variance / (values * values))
    }

    /// The weights of the layers in the film.
    fn held_weights(&self, weights: &[Rgb]) -> impl Iterator<Item = DVec3> {
        self.held.iter().map(|layer| weights[layer.index()].as_dvec3())
    }
}

/// The sum of squares of a block with these weights, over all channels.
fn square(products: &[DVec3], weights: &[DVec3]) -> f64 {
    let mut products = products.iter();
    let mut sum = 0.0;
    for (row, a) in weights.iter().enumerate() {
        for (b, product) in weights[..=row].iter().zip(products.by_ref()) {
            sum += (*a * *b * *product).element_sum();
        }
    }
    sum
}

/// Sums over the pixels of a block.
struct BlockSums {
    pixels: f64,
    light: Vec<DVec3>,
    products: Vec<DVec3>,
}

impl BlockSums {
    /// Those of a block, given the pixels of its rows. One sum after the other: the compiler keeps it in registers.
    fn new(rows: impl Iterator<Item = Range<usize>> + Clone, film: &Film, audits: &[&Film; 2]) -> Self {
        let layers = film.held.len();
        let mut sums = Self { pixels: 0.0, light: Vec::with_capacity(layers), products: Vec::new() };
        sums.pixels = rows.clone().map(|row| row.len() as f64).sum();
        for row in 0..layers {
            let light = rows.clone().flat_map(|pixels| layer(film, pixels, row));
            sums.light.push(light.fold(DVec3::ZERO, |sum, light| sum + light));
            for column in 0..=row {
                let mut sum = DVec3::ZERO;
                for pixels in rows.clone() {
                    let [a, b] = [row, column].map(|place| differences(film, audits, &pixels, place));
                    for (a, b) in a.zip(b) {
                        let product = (a[0] * b[1] + a[1] * b[0]) / 2.0;
                        // The pairs of different layers occur in both orders.
                        sum += if column < row { product * 2.0 } else { product };
                    }
                }
                sums.products.push(sum);
            }
        }
        sums
    }
}

/// A layer of light of some pixels.
fn layer(film: &Film, pixels: Range<usize>, layer: usize) -> impl Iterator<Item = DVec3> {
    let count = film.layers();
    let pixels = film.data[pixels.start * count..pixels.end * count].chunks_exact(count);
    pixels.map(move |pixel| pixel[layer].as_dvec3())
}

/// How much a layer of some pixels differs from both audits.
fn differences(
    film: &Film,
    audits: &[&Film; 2],
    pixels: &Range<usize>,
    place: usize,
) -> impl Iterator<Item = [DVec3; 2]> {
    let [a, b] = audits.map(|audit| layer(audit, pixels.clone(), place));
    layer(film, pixels.clone(), place).zip(a.zip(b)).map(|(own, (a, b))| [own - a, own - b])
}
