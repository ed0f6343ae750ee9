//! A pilot of a frame: it traces a few patches of pixels at full resolution, to estimate the cost and the variance of
//! samples.
//!
//! A smaller image would not do. Its pixels cover more edges, so they are noisier than those of the frame. Each patch
//! is as large as those that [`super::adaptive`] traces together, and has the same blocks.

use super::ONE_EACH;
use super::adaptive::halves::SampleHalves;
use super::adaptive::{PATCH, SIDE};
use super::pixels::{PixelTracer, SampleSet};
use super::settings::{Moment, TraceSettings};
use super::wavefront::WAVE;
use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::base::stats::Counts;
use crate::scene::Scene;
use crate::scene::top_level::Bvh;
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// Blocks of some patches of a frame. All of their pixels have the same number of samples.
pub struct PilotBlocks {
    seed: u32,
    layers: usize,
    /// Patch by patch.
    blocks: Vec<PilotBlock>,
    /// The pixels of all blocks.
    places: Vec<(u32, u32)>,
    /// The layers of each pixel: the sums of all samples, and of the samples before the last pass.
    all: Vec<DVec3>,
    first: Vec<DVec3>,
}

#[derive(Clone)]
struct PilotBlock {
    /// The column and row of the block.
    cell: (u32, u32),
    /// Its pixels among those of all blocks.
    pixels: Range<usize>,
    rays: u64,
}

/// The error of a block from the halves of its samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BlockError {
    pub pixels: f64,
    /// The mean over pixels and colours.
    pub mean: f64,
    /// The mean squared error, if samples were independent; and the sum of the squared contributions of pixels to it,
    /// which bounds the variance of the estimate.
    pub square: f64,
    pub variance: f64,
    /// Rays per sample of a pixel.
    pub rays: f64,
}

impl PilotBlocks {
    /// The numbers of pixels of a whole patch and of a whole block.
    pub const PATCH: f64 = (PATCH * PATCH) as f64;
    pub const BLOCK: f64 = (SIDE * SIDE) as f64;

    /// Spreads `count` patches over a frame of this size, but no more than the frame has.
    pub fn new((width, height): (u32, u32), count: usize, layers: usize, seed: u32) -> Self {
        let (columns, rows) = (width.div_ceil(PATCH), height.div_ceil(PATCH));
        let (mut places, mut blocks) = (Vec::new(), Vec::new());
        let starts =
            |patch: u32, end: u32| (patch * PATCH..end.min((patch + 1) * PATCH)).step_by(SIDE as usize);
        for (column, row) in spread(columns, rows, count) {
            let corners =
                starts(row, height).flat_map(|top| starts(column, width).map(move |left| (left, top)));
            for (left, top) in corners {
                let (first, xs) = (places.len(), left..width.min(left + SIDE));
                places.extend((top..height.min(top + SIDE)).flat_map(|y| xs.clone().map(move |x| (x, y))));
                blocks.push(PilotBlock {
                    cell: (left / SIDE, top / SIDE),
                    pixels: first..places.len(),
                    rays: 0,
                });
            }
        }
        let sums = vec![DVec3::ZERO; places.len() * layers];
        Self { seed, layers, blocks, places, all: sums.clone(), first: sums }
    }

    /// For each block, itself and those that are next to it, as far as they are among these blocks.
    pub fn neighbourhoods(&self) -> Vec<Vec<usize>> {
        let places: HashMap<(u32, u32), usize> =
            self.blocks.iter().enumerate().map(|(place, block)| (block.cell, place)).collect();
        let around = |block: &PilotBlock| {
            let (column, row) = block.cell;
            let near = |at: u32| at.saturating_sub(1)..=at + 1;
            let cells = near(row).flat_map(|row| near(column).map(move |column| (column, row)));
            cells.filter_map(|cell| places.get(&cell).copied()).collect()
        };
        self.blocks.iter().map(around).collect()
    }

    /// Keeps these blocks only.
    pub fn keep(&mut self, places: &[usize]) {
        let mut kept =
            Self { blocks: Vec::new(), places: Vec::new(), all: Vec::new(), first: Vec::new(), ..*self };
        for (_, block) in self.blocks.iter().enumerate().filter(|(place, _)| places.contains(place)) {
            let (first, sums) = (kept.places.len(), self.sums_of(block));
            kept.places.extend_from_slice(&self.places[block.pixels.clone()]);
            kept.all.extend_from_slice(&self.all[sums.clone()]);
            kept.first.extend_from_slice(&self.first[sums]);
            kept.blocks.push(PilotBlock { pixels: first..kept.places.len(), ..block.clone() });
        }
        *self = kept;
    }

    /// The sums of a block among those of all blocks.
    fn sums_of(&self, block: &PilotBlock) -> Range<usize> {
        block.pixels.start * self.layers..block.pixels.end * self.layers
    }

    /// The number of pixels of all its blocks.
    pub fn pixels(&self) -> u64 {
        self.places.len() as u64
    }

    /// Starts a pass. Its samples form the second half.
    pub fn begin_pass(&mut self) {
        self.first.copy_from_slice(&self.all);
    }

    /// Adds the samples that belong to this moment, either random ones or those of a regular grid.
    pub fn trace(
        &mut self,
        scene: &Scene,
        bvh: &Bvh,
        settings: &TraceSettings,
        (moment, random): (Moment, bool),
        samples: &Range<u32>,
    ) -> Counts {
        let (seed, mut pixels) = (self.seed, PixelTracer::new(scene, bvh, settings, moment));
        pixels.random = random;
        let pixels = &pixels;
        let most = self.places.len().div_ceil(rayon::current_num_threads());
        let together = pixels_together(samples.len(), moment.of).min(most);
        let mut groups = Vec::new();
        let (mut places, mut sums, mut rest) = (&self.places[..], &mut self.all[..], &mut self.blocks[..]);
        while !rest.is_empty() {
            let (blocks, own, own_sums);
            let (count, pixels) = first_group(rest, together);
            (blocks, rest) = rest.split_at_mut(count);
            (own, places) = places.split_at(pixels);
            (own_sums, sums) = sums.split_at_mut(pixels * self.layers);
            groups.push((blocks, own, own_sums));
        }
        let counts = groups.into_par_iter().with_max_len(ONE_EACH).map(|(blocks, places, sums)| {
            let counts = pixels.add(places, &SampleSet { samples: samples.clone(), seed }, sums);
            divide_rays(blocks, counts.rays.total());
            counts
        });
        counts.reduce(Counts::default, |mut a, b| {
            a += b;
            a
        })
    }

    /// The errors of the blocks with these weights, from the first `before` of `after` samples and the rest.
    pub fn errors(&self, weights: &[Rgb], (before, after): (u32, u32)) -> Vec<BlockError> {
        let blocks = self.blocks.par_iter();
        let found = blocks.map(|block| {
            let sums = self.sums_of(block);
            block.error(weights, [&self.all[sums.clone()], &self.first[sums]], (before, after))
        });
        found.collect()
    }
}

/// How many pixels fill a wave if each takes so many samples at several moments; at least those of a patch. A frame's waves
/// are full, but a moment's samples of one patch are few, so each would take up to twice as long. Without moments, the rays
/// of each patch are its own.
fn pixels_together(samples: usize, moments: u32) -> usize {
    let patch = (PATCH * PATCH) as usize;
    if moments > 1 { (WAVE * moments as usize / samples.max(1)).max(patch) } else { patch }
}

/// The numbers of the first blocks, and of their pixels: whole patches of at most `most` pixels, and at least one.
fn first_group(blocks: &[PilotBlock], most: usize) -> (usize, usize) {
    let (mut count, mut pixels) = (0, 0);
    for patch in blocks.chunk_by(|a, b| a.patch() == b.patch()) {
        let more: usize = patch.iter().map(|block| block.pixels.len()).sum();
        if count > 0 && pixels + more > most {
            break;
        }
        (count, pixels) = (count + patch.len(), pixels + more);
    }
    (count, pixels)
}

/// Divides the rays of blocks that share waves by their pixels.
fn divide_rays(blocks: &mut [PilotBlock], rays: u64) {
    let all: u64 = blocks.iter().map(|block| block.pixels.len() as u64).sum();
    let mut before = 0;
    for block in blocks {
        let end = before + block.pixels.len() as u64;
        block.rays += rays * end / all - rays * before / all;
        before = end;
    }
}

impl PilotBlock {
    /// The column and row of its patch.
    fn patch(&self) -> (u32, u32) {
        (self.cell.0 * SIDE / PATCH, self.cell.1 * SIDE / PATCH)
    }

    /// The error by the sums of all samples and of the first ones.
    fn error(&self, weights: &[Rgb], [all, first]: [&[DVec3]; 2], (before, after): (u32, u32)) -> BlockError {
        let (halves, layers) = (SampleHalves::new(before, after), all.len() / self.pixels.len());
        let factor = halves.factor() / 3.0;
        let pixels = self.pixels.len() as f64;
        let mut found = BlockError {
            pixels,
            rays: self.rays as f64 / (pixels * halves.count()),
            ..BlockError::default()
        };
        for (all, first) in all.chunks_exact(layers).zip(first.chunks_exact(layers)) {
            let sum = |sums: &[DVec3]| -> DVec3 {
                sums.iter().zip(weights).map(|(sum, weight)| weight.as_dvec3() * *sum).sum()
            };
            let (all, first) = (sum(all), sum(first));
            found.mean += all.element_sum() / (3.0 * halves.count() * pixels);
            if factor > 0.0 {
                let square = factor * halves.difference(first, all).length_squared();
                found.square += square / pixels;
                found.variance += square * square / (pixels * pixels);
            }
        }
        found
    }
}

/// Chooses `count` different cells of a lattice, evenly spread, by the additive sequence of the plastic number
/// (Roberts, *The unreasonable effectiveness of quasirandom sequences*, 2018).
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
        let pilot = PilotBlocks::new((20, 9), usize::MAX, 1, 0);
        assert_eq!((pilot.blocks.len(), pilot.pixels()), (15, 180));
    }

    #[test]
    fn neighbours_are_those_that_were_chosen() {
        // Four blocks of one patch, then two of the next one.
        let mut pilot = PilotBlocks::new((12, 8), usize::MAX, 1, 0);
        assert_eq!(pilot.neighbourhoods()[0], [0, 1, 2, 3]);
        assert_eq!(pilot.neighbourhoods()[1], [0, 1, 4, 2, 3, 5]);
        pilot.keep(&[5, 0, 1]);
        assert_eq!(pilot.blocks.iter().map(|block| block.cell).collect::<Vec<_>>(), [(0, 0), (1, 0), (2, 1)]);
        assert_eq!(pilot.neighbourhoods(), [vec![0, 1], vec![0, 1, 2], vec![1, 2]]);
    }

    #[test]
    fn few_samples_of_a_moment_share_waves() {
        let together = [(1, 1), (16, 16), (64, 16), (512, 32)].map(|(n, of)| pixels_together(n, of));
        assert_eq!(together, [64, 1024, 256, 64]);
        let mut pilot = PilotBlocks::new((16, 8), usize::MAX, 1, 0);
        let groups = |pilot: &PilotBlocks| [1, 64, 128].map(|most| first_group(&pilot.blocks, most));
        assert_eq!(groups(&pilot), [(4, 64), (4, 64), (8, 128)]);
        // Two blocks of the first patch, and one of the second.
        pilot.keep(&[0, 3, 5]);
        assert_eq!(groups(&pilot), [(2, 32), (3, 48), (3, 48)]);
    }

    /// One pixel whose halves are 1 and 3 in all colours. Independent samples would have a squared error of 1.
    #[test]
    fn halves_give_the_error() {
        let mut pilot = PilotBlocks::new((1, 1), 1, 1, 0);
        pilot.all[0] = DVec3::splat(4.0);
        pilot.begin_pass();
        pilot.all[0] = DVec3::splat(16.0);
        let error = pilot.errors(&[Rgb::splat(0.5)], (4, 8))[0];
        assert_eq!((error.mean, error.square, error.variance), (1.0, 0.25, 0.0625));
    }
}
