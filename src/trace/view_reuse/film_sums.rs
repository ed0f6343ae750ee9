//! The weighted sums of a film's pixels, to which samples of any view are added.

use super::raster::Raster;
use super::view::ViewMap;
use crate::base::lanes::{Level, Row, SimdKernel};
use crate::base::math::DVec3;
use crate::film::filter::FilterWeights;

/// Traced samples of a view, in the order of tracing.
#[derive(Default)]
pub struct SampleBatch {
    /// In pixels from the left and the top, with room for the lanes behind the last sample.
    pub across: Vec<f64>,
    pub down: Vec<f64>,
    /// The solid angle that each sample stands for.
    pub weight: Vec<f64>,
    /// Three channels of each layer that films hold, sample by sample.
    pub light: Vec<f64>,
}

impl SampleBatch {
    pub fn push(&mut self, [across, down]: [f64; 2], weight: f64) {
        self.across.push(across);
        self.down.push(down);
        self.weight.push(weight);
    }

    /// Adds room for the lanes behind the last sample. Their weight is 0.
    pub fn pad(&mut self) {
        for column in [&mut self.across, &mut self.down, &mut self.weight] {
            column.resize(column.len() + 8, 0.0);
        }
    }
}

/// The sums of all pixels of a film.
pub struct FilmSums {
    width: usize,
    height: usize,
    layers: usize,
    /// The layer whose first channel is a distance along the line of sight.
    depth_layer: Option<usize>,
    /// For each pixel: the sum of the weights, the number of samples, and three channels of each layer.
    sums: Vec<f64>,
}

/// Numbers of a pixel before its layers.
const HEAD: usize = 2;

/// The bytes of the sums of a film.
pub fn bytes_of_sums(pixels: u64, layers: u64) -> u64 {
    pixels.saturating_mul((HEAD as u64 + 3 * layers) * size_of::<f64>() as u64)
}

impl FilmSums {
    pub fn new(raster: &Raster, layers: usize, depth_layer: Option<usize>) -> Self {
        let [width, height] = raster.size().map(|side| side as usize);
        let sums = vec![0.0; width * height * (HEAD + 3 * layers)];
        Self { width, height, layers, depth_layer, sums }
    }

    /// Of a pixel: the number of its samples, the sum of their weights, and the weighted mean of its layers. Zero without
    /// samples.
    pub fn pixel(&self, index: usize) -> (f64, f64, impl Iterator<Item = DVec3>) {
        let stride = HEAD + 3 * self.layers;
        let sums = &self.sums[index * stride..][..stride];
        let (weight, count) = (sums[0], sums[1]);
        let mean = move |layer: &[f64]| match weight > 0.0 {
            true => DVec3::new(layer[0], layer[1], layer[2]) / weight,
            false => DVec3::ZERO,
        };
        (count, weight, sums[HEAD..].chunks_exact(3).map(mean))
    }

    /// Adds a sample at a position to the pixels whose filter reaches it.
    #[inline(always)]
    fn add(
        &mut self,
        [across, down]: [f64; 2],
        (weight, depth): (f64, f64),
        light: &[f64],
        filter: &FilterWeights,
    ) {
        if filter.is_pixel() {
            if across >= 0.0 && down >= 0.0 {
                let (column, row) = (across as usize, down as usize);
                if column < self.width && row < self.height {
                    self.add_to(row * self.width + column, weight, depth, light);
                }
            }
            return;
        }
        for row in filter.reached(down, self.height) {
            let by_row = weight * filter.at(down - (row as f64 + 0.5));
            for column in filter.reached(across, self.width) {
                let weight = by_row * filter.at(across - (column as f64 + 0.5));
                if weight > 0.0 {
                    self.add_to(row * self.width + column, weight, depth, light);
                }
            }
        }
    }

    #[inline(always)]
    fn add_to(&mut self, pixel: usize, weight: f64, depth: f64, light: &[f64]) {
        let stride = HEAD + 3 * self.layers;
        let sums = &mut self.sums[pixel * stride..][..stride];
        sums[0] += weight;
        sums[1] += 1.0;
        sums[HEAD..].iter_mut().zip(light).for_each(|(sum, light)| *sum += weight * light);
        if let Some(layer) = self.depth_layer {
            // Along another line of sight, points have another distance.
            sums[HEAD + 3 * layer] += weight * light[3 * layer] * (depth - 1.0);
        }
    }
}

/// Adds samples to a film.
pub struct AddSamples<'a> {
    pub batch: &'a SampleBatch,
    /// From the view of the samples to that of the film.
    pub map: &'a ViewMap,
    pub filter: &'a FilterWeights,
    pub film: &'a mut FilmSums,
}

impl SimdKernel for AddSamples<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { batch, map, filter, film } = self;
        let channels = 3 * film.layers;
        let count = batch.light.len() / channels.max(1);
        let row = |coefficients: &[f64; 3]| coefficients.map(L::F64::splat);
        let (xs, ys, depths) = (row(&map.across), row(&map.down), row(&map.depth));
        for first in (0..count).step_by(8) {
            let across = L::F64::load(&batch.across, first);
            let down = L::F64::load(&batch.down, first);
            let weight = L::F64::load(&batch.weight, first);
            let depth = depths[0] * across + depths[1] * down + depths[2];
            let near = L::F64::splat(1.0) / depth;
            let x = (xs[0] * across + xs[1] * down + xs[2]) * near;
            let y = (ys[0] * across + ys[1] * down + ys[2]) * near;
            let weight = weight * (near * near * near);
            let (x, y, weight, depth) = (x.to_array(), y.to_array(), weight.to_array(), depth.to_array());
            for lane in 0..(count - first).min(8) {
                if depth[lane] > 0.0 {
                    let light = &batch.light[(first + lane) * channels..][..channels];
                    film.add([x[lane], y[lane]], (weight[lane], depth[lane]), light, filter);
                }
            }
        }
    }
}
