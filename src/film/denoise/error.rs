//! The error that is left in a denoised film.

use super::super::{Film, LayerId, Noise, Z_95};
use crate::base::color::Rgb;
use glam::DVec3;
use rayon::prelude::*;
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
                let (left, top) = (block % columns * BLOCK, block / columns * BLOCK);
                let mut sums = BlockSums::new(layers);
                for y in top..height.min(top + BLOCK) {
                    for x in left..width.min(left + BLOCK) {
                        sums.add(y * width + x, film, audits);
                    }
                }
                sums
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
    fn new(layers: usize) -> Self {
        let products = vec![DVec3::ZERO; layers * (layers + 1) / 2];
        Self { pixels: 0.0, light: vec![DVec3::ZERO; layers], products }
    }

    fn add(&mut self, pixel: usize, film: &Film, audits: &[&Film; 2]) {
        self.pixels += 1.0;
        let (own, audits) = (film.pixel(pixel), audits.map(|audit| audit.pixel(pixel)));
        let light = |layer: usize| own[layer].as_dvec3();
        let differences = |layer: usize| audits.map(|audit| light(layer) - audit[layer].as_dvec3());
        let mut products = self.products.iter_mut();
        for row in 0..self.light.len() {
            self.light[row] += light(row);
            let a = differences(row);
            for (column, sum) in (0..=row).zip(products.by_ref()) {
                let b = differences(column);
                let product = (a[0] * b[1] + a[1] * b[0]) / 2.0;
                // The pairs of different layers occur in both orders.
                *sum += if column < row { product * 2.0 } else { product };
            }
        }
    }
}
