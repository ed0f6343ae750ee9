//! Blocks whose samples share waves.
//!
//! The first rounds take a few samples per pixel, and with motion blur each moment a part of them, so the samples of one
//! block fill a small part of a wave. Short queues leave lanes empty and pay for the set-up of every stage.

use super::block::Block;
use crate::base::math::DVec3;
use crate::base::stats::Counts;
use crate::trace::pixels::{PixelTracer, SampleSet};
use crate::trace::wavefront::WAVE;

/// The most blocks of a group. With more, a round of many moments would be too few groups for all threads, and the costs
/// of blocks would be those of half the picture.
const MOST: usize = 16;

/// Open blocks whose round takes the same samples of each pixel. The groups of a round depend on its blocks alone, so
/// the cost of each block does, too.
pub struct BlockGroup<'a>(Vec<&'a mut Block>);

impl<'a> BlockGroup<'a> {
    /// The open blocks in groups that fill at most one wave, unless a block alone fills more. A round has this number
    /// of moments.
    pub fn of_round(blocks: &'a mut [Block], moments: u32) -> Vec<Self> {
        let mut groups: Vec<Self> = Vec::new();
        let mut filled = 0;
        for block in blocks.iter_mut().filter(|block| block.is_open()) {
            let samples = block.pixels() as usize * block.round().len() / moments as usize;
            match groups.last_mut() {
                Some(Self(last))
                    if last[0].round() == block.round() && last.len() < MOST && filled + samples <= WAVE =>
                {
                    last.push(block);
                    filled += samples;
                }
                _ => {
                    groups.push(Self(vec![block]));
                    filled = samples;
                }
            }
        }
        groups
    }

    /// Discards the samples of the current round. Returns whether an earlier round exists; without one, nothing
    /// happens.
    pub fn discard_round(&mut self) -> bool {
        self.0.iter_mut().all(|block| block.discard_round())
    }

    /// Traces the samples of the round that belong to the moment of `pixels`.
    pub fn trace(self, pixels: &PixelTracer, seed: u32) -> Counts {
        let Self(mut blocks) = self;
        let samples = blocks[0].round();
        let places: Vec<(u32, u32)> = blocks.iter().flat_map(|block| block.places()).collect();
        let mut sums: Vec<DVec3> = blocks.iter().flat_map(|block| block.sums()).copied().collect();
        let counts = pixels.add(&places, &SampleSet { samples, seed }, &mut sums);
        let (pixels, mut before, mut rest) = (places.len() as u64, 0, &sums[..]);
        let rays_of = |pixel: u64| counts.rays.total() * pixel / pixels;
        for block in &mut blocks {
            let own;
            (own, rest) = rest.split_at(block.sums().len());
            let end = before + u64::from(block.pixels());
            block.take_sums(own, rays_of(end) - rays_of(before));
            before = end;
        }
        counts
    }
}
