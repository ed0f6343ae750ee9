//! Blocks whose samples share waves.
//!
//! The first rounds take a few samples per pixel, and with motion blur each moment a part of them, so the samples of one
//! block fill a small part of a wave. Short queues leave lanes empty and pay for the set-up of every stage.

use super::block::Block;
use crate::base::math::DVec3;
use crate::base::stats::Counts;
use crate::trace::pixels::{PixelTracer, SampleSet};
use crate::trace::wavefront::WAVE;
use std::collections::HashMap;
use std::ops::Range;

/// The most pixels of a group. With more, a round of many moments would be too few groups for all threads, and the costs
/// of blocks would be those of half the picture.
const MOST: usize = 1024;

/// Open blocks whose round takes the same samples of each pixel. The groups of a round depend on its blocks alone, so
/// the cost of each block does, too.
pub struct BlockGroup<'a>(Vec<&'a mut Block>);

impl<'a> BlockGroup<'a> {
    /// The open blocks in groups that fill at most one wave, unless a block alone fills more. A round has this number
    /// of moments.
    pub fn of_round(blocks: &'a mut [Block], moments: u32) -> Vec<Self> {
        let mut open: Vec<&mut Block> = blocks.iter_mut().filter(|block| block.is_open()).collect();
        open.sort_by_key(|block| block.patch());
        let mut groups: Vec<Self> = Vec::new();
        // The last group of each round, and its pixels.
        let mut last: HashMap<Range<u32>, (usize, usize)> = HashMap::new();
        for block in open {
            let (pixels, round) = (block.pixels() as usize, block.round());
            let most = (WAVE * moments as usize / round.len().max(1)).min(MOST);
            match last.get_mut(&round) {
                Some((group, filled)) if *filled + pixels <= most => {
                    groups[*group].0.push(block);
                    *filled += pixels;
                }
                _ => {
                    last.insert(round, (groups.len(), pixels));
                    groups.push(Self(vec![block]));
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
        let count = blocks.iter().map(|block| block.pixels() as usize).sum();
        let mut places: Vec<(u32, u32)> = Vec::with_capacity(count);
        let mut sums: Vec<DVec3> = Vec::with_capacity(count * pixels.layers());
        for block in &blocks {
            places.extend(block.places());
            sums.extend_from_slice(block.sums());
        }
        let counts = pixels.add(&places, &SampleSet { samples, seed }, &mut sums);
        let (mut before, mut rest) = (0, &sums[..]);
        let rays_of = |pixel: u64| counts.rays.total() * pixel / count as u64;
        for block in &mut blocks {
            let own;
            (own, rest) = rest.split_at(block.sums().len());
            let end = before + u64::from(block.pixels());
            block.take_sums(own, rays_of(end) - rays_of(before), pixels.moment);
            before = end;
        }
        counts
    }
}

#[cfg(test)]
mod tests {
    use super::super::block::PixelLayers;
    use super::*;
    use std::sync::Arc;

    #[test]
    fn groups_fill_waves_across_blocks_of_other_rounds() {
        let layers = Arc::new(PixelLayers { count: 1, held: vec![0] });
        let block =
            |place: u32| Block::new((4 * place, 0), (4, 4), Arc::clone(&layers), [4, 8][place as usize & 1]);
        let mut blocks: Vec<Block> = (0..64).map(block).collect();
        let groups = BlockGroup::of_round(&mut blocks, 1);
        let samples = |BlockGroup(blocks): &BlockGroup| (blocks.len(), blocks[0].round().len());
        let mut found: Vec<_> = groups.iter().map(samples).collect();
        found.sort_unstable();
        assert_eq!(found, [(8, 8), (8, 8), (8, 8), (8, 8), (16, 4), (16, 4)]);
        assert!(groups.iter().all(|BlockGroup(all)| all.iter().all(|block| block.round() == all[0].round())));
    }
}
