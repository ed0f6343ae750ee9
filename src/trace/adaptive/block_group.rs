//! Blocks whose samples share waves.
//!
//! The first rounds take a few samples per pixel, and with motion blur each moment a part of them, so the samples of one
//! block fill a small part of a wave. Short queues leave lanes empty and pay for the set-up of every stage.

use super::block::Block;
use super::round::Round;
use super::{PATCH, SIDE};
use crate::base::math::DVec3;
use crate::base::stats::Counts;
use crate::trace::pixels::{PixelTracer, SampleSet};
use crate::trace::wavefront::WAVE;

/// The most pixels of a group. With more, a round of many moments would be too few groups for all threads, and the costs
/// of blocks would be those of half the picture.
const MOST: usize = 1024;

/// Open blocks that are in the same round. The groups of a round depend on its blocks alone, so
/// the cost of each block does, too.
pub struct BlockGroup<'a> {
    round: Round,
    blocks: Vec<&'a mut Block>,
}

impl<'a> BlockGroup<'a> {
    /// The open blocks of rows of `columns`, in groups that fill at most one wave, unless a block alone fills more. A
    /// round has this number of moments.
    pub fn of_round(blocks: &'a mut [Block], columns: usize, moments: u32) -> Vec<Self> {
        let mut groups: Vec<Self> = Vec::new();
        // The last group of each round, and its pixels. There are few different rounds.
        let mut last: Vec<(Round, usize, usize)> = Vec::new();
        for block in by_patches(blocks, columns) {
            let Some(round) = block.round() else { continue };
            let pixels = block.pixels() as usize;
            let most = (WAVE * moments as usize / round.samples().len().max(1)).min(MOST);
            let known = last.iter().position(|(known, ..)| *known == round).unwrap_or_else(|| {
                last.push((round, groups.len(), 0));
                groups.push(Self { round, blocks: Vec::new() });
                last.len() - 1
            });
            let (_, group, filled) = &mut last[known];
            if *filled > 0 && *filled + pixels > most {
                (*group, *filled) = (groups.len(), 0);
                groups.push(Self { round, blocks: Vec::new() });
            }
            groups[*group].blocks.push(block);
            *filled += pixels;
        }
        groups
    }

    /// Shortens the current round as far as pixels keep samples. Returns what is left of it, and whether that leaves out any
    /// samples.
    pub fn shortened(mut self) -> (Option<Self>, bool) {
        let mut is_cut = false;
        for block in &mut self.blocks {
            is_cut |= block.shorten_round();
        }
        (self.round.shortened().map(|round| Self { round, ..self }), is_cut)
    }

    /// Traces the samples of the round that belong to the moment of `pixels`.
    pub fn trace(self, pixels: &PixelTracer, seed: u32) -> Counts {
        let Self { round, mut blocks } = self;
        let ends = round.ends();
        let count = blocks.iter().map(|block| block.pixels() as usize).sum();
        let mut places: Vec<(u32, u32)> = Vec::with_capacity(count);
        let mut sums: Vec<DVec3> = Vec::with_capacity(count * ends.len() * pixels.layers());
        for block in &blocks {
            places.extend(block.places());
            block.push_sums(&mut sums);
        }
        let set = SampleSet { samples: round.samples(), seed };
        let counts = pixels.add_to_ends(&places, (&set, ends), &mut sums);
        let (mut before, mut rest) = (0, &sums[..]);
        let rays_of = |pixel: u64| counts.rays.total() * pixel / count as u64;
        for block in &mut blocks {
            let own;
            (own, rest) = rest.split_at(block.pixels() as usize * ends.len() * pixels.layers());
            let end = before + u64::from(block.pixels());
            block.take_sums(own, rays_of(end) - rays_of(before), pixels.moment);
            before = end;
        }
        counts
    }
}

/// The blocks of rows of `columns`, patch by patch, so that the rays of a wave stay close to each other.
fn by_patches(blocks: &mut [Block], columns: usize) -> impl Iterator<Item = &mut Block> {
    const SIDE_OF_PATCH: usize = (PATCH / SIDE) as usize;
    blocks.chunks_mut(SIDE_OF_PATCH * columns).flat_map(move |rows| {
        let mut rows: Vec<_> = rows.chunks_mut(columns).map(|row| row.chunks_mut(SIDE_OF_PATCH)).collect();
        (0..columns.div_ceil(SIDE_OF_PATCH)).flat_map(move |_| {
            let parts: Vec<_> = rows.iter_mut().filter_map(Iterator::next).collect();
            parts.into_iter().flatten()
        })
    })
}

#[cfg(test)]
mod tests {
    use super::super::block::PixelLayers;
    use super::*;
    use std::sync::Arc;

    /// Two rows of blocks in rounds of these numbers of samples.
    fn rows(columns: u32, samples: impl Fn(u32) -> u32) -> Vec<Block> {
        let layers = Arc::new(PixelLayers { count: 1, held: vec![0] });
        let block = |place: u32| {
            let corner = (4 * (place % columns), 4 * (place / columns));
            let samples = samples(place);
            Block::new(corner, (4, 4), Arc::clone(&layers), Round::after(samples, 2 * samples))
        };
        (0..2 * columns).map(block).collect()
    }

    #[test]
    fn blocks_of_a_patch_follow_each_other() {
        let mut blocks = rows(5, |_| 4);
        let corners: Vec<_> = by_patches(&mut blocks, 5).filter_map(|block| block.places().next()).collect();
        let expected = [0, 0, 1, 1, 0, 0, 1, 1, 0, 1].iter().zip([0, 1, 0, 1, 2, 3, 2, 3, 4, 4]);
        assert_eq!(corners, expected.map(|(row, column)| (4 * column, 4 * row)).collect::<Vec<_>>());
        // 64 samples of 16 pixels fill a wave, and 16 those of a patch.
        for (samples, count) in [(64, 10), (16, 3)] {
            let mut blocks = rows(5, |_| samples);
            assert_eq!(BlockGroup::of_round(&mut blocks, 5, 1).len(), count);
        }
    }

    #[test]
    fn groups_fill_waves_across_blocks_of_other_rounds() {
        let mut blocks = rows(32, |place| [4, 8][place as usize & 1]);
        let groups = BlockGroup::of_round(&mut blocks, 32, 1);
        let samples = |group: &BlockGroup| (group.blocks.len(), group.round.samples().len());
        let mut found: Vec<_> = groups.iter().map(samples).collect();
        found.sort_unstable();
        assert_eq!(found, [(8, 8), (8, 8), (8, 8), (8, 8), (16, 4), (16, 4)]);
        let is_even =
            |group: &BlockGroup| group.blocks.iter().all(|block| block.round() == Some(group.round));
        assert!(groups.iter().all(is_even));
    }
}
