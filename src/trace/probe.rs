//! A trial of a frame: a few of its blocks of pixels are traced, at full resolution, to find what samples cost and how
//! far they are from each other.
//!
//! A smaller picture would not do: its pixels cover more edges, so they are noisier than those of the frame.

use super::pixels::{Pixels, SampleSet};
use super::{Moment, TraceSettings};
use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::base::stats::Counts;
use crate::scene::Scene;
use crate::scene::top_level::Bvh;
use rayon::prelude::*;
use std::collections::HashSet;
use std::ops::Range;

/// Side of a block in pixels.
const SIDE: u32 = 8;

/// Blocks of a frame whose pixels all have the same number of samples.
pub struct Probe {
    seed: u32,
    layers: usize,
    blocks: Vec<Block>,
}

struct Block {
    places: Vec<(u32, u32)>,
    /// Each pixel's layers: sums of all samples, and of those before the last pass.
    all: Vec<DVec3>,
    first: Vec<DVec3>,
    rays: u64,
}

/// What the two halves of a block's samples say.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BlockError {
    pub pixels: f64,
    /// Mean over the pixels and colours.
    pub mean: f64,
    /// The mean squared error, if samples were independent; and the sum over the pixels of the squares of what they add
    /// to that mean, which bounds the variance of the estimate.
    pub square: f64,
    pub variance: f64,
    /// Rays that a sample of one pixel takes.
    pub rays: f64,
}

impl Probe {
    /// Pixels of a whole block.
    pub const BLOCK: f64 = (SIDE * SIDE) as f64;

    /// So many blocks, spread over a frame of this size. A frame has no more than all of its blocks.
    pub fn new((width, height): (u32, u32), count: usize, layers: usize, seed: u32) -> Self {
        let (columns, rows) = (width.div_ceil(SIDE), height.div_ceil(SIDE));
        let block = |(column, row): (u32, u32)| {
            let (left, top) = (column * SIDE, row * SIDE);
            let xs = left..width.min(left + SIDE);
            let places: Vec<_> =
                (top..height.min(top + SIDE)).flat_map(|y| xs.clone().map(move |x| (x, y))).collect();
            let sums = vec![DVec3::ZERO; places.len() * layers];
            Block { places, first: sums.clone(), all: sums, rays: 0 }
        };
        Self { seed, layers, blocks: spread(columns, rows, count).into_iter().map(block).collect() }
    }

    /// How many blocks a frame of this size has.
    pub fn blocks_of((width, height): (u32, u32)) -> usize {
        width.div_ceil(SIDE) as usize * height.div_ceil(SIDE) as usize
    }

    /// Pixels of all its blocks.
    pub fn pixels(&self) -> u64 {
        self.blocks.iter().map(|block| block.places.len() as u64).sum()
    }

    /// Starts a pass: what is traced from now on is the second half.
    pub fn begin_pass(&mut self) {
        self.blocks.iter_mut().for_each(|block| block.first.copy_from_slice(&block.all));
    }

    /// Adds those of the samples that fall on this moment: random ones, or those of a regular grid.
    pub fn trace(
        &mut self,
        scene: &Scene,
        bvh: &Bvh,
        settings: &TraceSettings,
        (moment, random): (Moment, bool),
        samples: &Range<u32>,
    ) -> Counts {
        let (seed, mut pixels) = (self.seed, Pixels::new(scene, bvh, settings, moment));
        pixels.random = random;
        let pixels = &pixels;
        let counts = self.blocks.par_iter_mut().map(|block| {
            let set = SampleSet { samples: samples.clone(), seed };
            let counts = pixels.add(&block.places, &set, &mut block.all);
            block.rays += counts.rays.total();
            counts
        });
        counts.reduce(Counts::default, |mut a, b| {
            a += b;
            a
        })
    }

    /// What the blocks say with these weights after passes of so many samples, and so many more.
    pub fn errors(&self, weights: &[Rgb], (before, after): (u32, u32)) -> Vec<BlockError> {
        self.blocks.iter().map(|block| block.error(weights, self.layers, (before, after))).collect()
    }
}

impl Block {
    fn error(&self, weights: &[Rgb], layers: usize, (before, after): (u32, u32)) -> BlockError {
        let (a, b) = (f64::from(before), f64::from(after - before));
        // Of two means of a and b independent samples, see `adaptive::block`.
        let factor = a * b / ((a + b) * (a + b)) / 3.0;
        let pixels = self.places.len() as f64;
        let mut found =
            BlockError { pixels, rays: self.rays as f64 / (pixels * (a + b)), ..BlockError::default() };
        for (all, first) in self.all.chunks_exact(layers).zip(self.first.chunks_exact(layers)) {
            let sum = |sums: &[DVec3]| -> DVec3 {
                sums.iter().zip(weights).map(|(sum, weight)| weight.as_dvec3() * *sum).sum()
            };
            let (all, first) = (sum(all), sum(first));
            found.mean += all.element_sum() / (3.0 * (a + b) * pixels);
            if factor > 0.0 {
                let square = factor * (first / a - (all - first) / b).length_squared();
                found.square += square / pixels;
                found.variance += square * square / (pixels * pixels);
            }
        }
        found
    }
}

/// So many places of a lattice, evenly spread, each once: the additive sequence of Roberts (*The unreasonable
/// effectiveness of quasirandom sequences*, 2018), by the plastic number.
fn spread(columns: u32, rows: u32, count: usize) -> Vec<(u32, u32)> {
    const STEPS: (f64, f64) = (0.754_877_666_246_692_7, 0.569_840_290_998_053_2);
    let all = columns as usize * rows as usize;
    if count >= all {
        return (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row))).collect();
    }
    let mut taken = HashSet::new();
    let place = |index: u64| {
        let at = |step: f64, cells: u32| ((0.5 + step * index as f64).fract() * f64::from(cells)) as u32;
        (at(STEPS.0, columns), at(STEPS.1, rows))
    };
    (0..).map(place).filter(|place| taken.insert(*place)).take(count).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_spread_and_each_is_there_once() {
        for (columns, rows, count) in [(40, 23, 64), (7, 5, 34), (7, 5, 99), (1, 1, 3)] {
            let places = spread(columns, rows, count);
            let different: HashSet<_> = places.iter().collect();
            assert_eq!(different.len(), places.len());
            assert_eq!(places.len(), count.min((columns * rows) as usize));
            assert!(places.iter().all(|(column, row)| *column < columns && *row < rows));
        }
        // Every quarter of the frame has its share.
        let left = spread(40, 24, 64).into_iter().filter(|(column, row)| *column < 20 && *row < 12).count();
        assert!((14..=18).contains(&left), "{left}");
    }

    #[test]
    fn blocks_at_the_edge_have_the_pixels_that_are_left() {
        let probe = Probe::new((20, 9), usize::MAX, 1, 0);
        assert_eq!((probe.blocks.len(), probe.pixels()), (6, 180));
        assert_eq!(Probe::blocks_of((20, 9)), 6);
    }

    /// One pixel whose halves are 1 and 3 in all colours: independent samples would leave a squared error of 1.
    #[test]
    fn halves_tell_the_error() {
        let mut probe = Probe::new((1, 1), 1, 1, 0);
        probe.blocks[0].all[0] = DVec3::splat(4.0);
        probe.begin_pass();
        probe.blocks[0].all[0] = DVec3::splat(16.0);
        let error = probe.errors(&[Rgb::splat(0.5)], (4, 8))[0];
        assert_eq!((error.mean, error.square, error.variance), (1.0, 0.25, 0.0625));
    }
}
