//! A histogram of the colours of a whole animation, in bounded memory.

use super::palette::{Palette, WeightedColor};
use crate::encode::picture::Picture;

/// Maximum number of bins.
const MAX_BINS: usize = 1 << 16;
/// Slots of the hash table, as a power of two. At most half of them are used.
const TABLE_BITS: u32 = 17;

/// Counts the colours of frames. Each colour has its own bin until there are too many; then neighbouring colours share
/// bins that are as small as possible. The result does not depend on the order of the frames.
pub struct Histogram {
    /// The number of distinct colours up to which [`Histogram::distinct`] is known.
    exact_limit: usize,
    /// Low bits of every channel that are ignored.
    coarse: u32,
    table: Vec<Bin>,
    taken: usize,
}

/// The number of pixels and the sum of their colours.
#[derive(Clone, Copy, Default)]
struct Bin {
    key: u32,
    count: u64,
    sum: [u64; 3],
}

impl Histogram {
    /// `exact_limit` is the number of colours up to which the palette is exact.
    pub fn new(exact_limit: usize) -> Self {
        Self { exact_limit, coarse: 0, table: vec![Bin::default(); 1 << TABLE_BITS], taken: 0 }
    }

    /// Counts a frame's pixels.
    pub fn add(&mut self, picture: &Picture) {
        let pixels = picture.rgb.as_chunks::<3>().0;
        // Neighbouring pixels are often equal, so a run of them is counted at once.
        for run in pixels.chunk_by(|a, b| a == b) {
            let count = run.len() as u64;
            self.put(Bin { key: self.key(run[0]), count, sum: run[0].map(|code| u64::from(code) * count) });
            if self.taken > MAX_BINS {
                self.coarsen();
            }
        }
    }

    fn key(&self, color: [u8; 3]) -> u32 {
        color.iter().fold(0, |key, code| key << 8 | u32::from(code >> self.coarse))
    }

    fn put(&mut self, bin: Bin) {
        let mut place = (bin.key.wrapping_mul(0x9E37_79B1) >> (32 - TABLE_BITS)) as usize;
        while self.table[place].count > 0 && self.table[place].key != bin.key {
            place = (place + 1) % self.table.len();
        }
        let found = &mut self.table[place];
        self.taken += usize::from(found.count == 0);
        found.key = bin.key;
        found.count += bin.count;
        found.sum = [0, 1, 2].map(|i| found.sum[i] + bin.sum[i]);
    }

    /// Merges every eight bins into one.
    fn coarsen(&mut self) {
        let bins = std::mem::replace(&mut self.table, vec![Bin::default(); 1 << TABLE_BITS]);
        self.coarse += 1;
        self.taken = 0;
        for bin in bins.into_iter().filter(|bin| bin.count > 0) {
            // The mask keeps bits from crossing into the next channel.
            let key = (bin.key >> 1) & 0x7f_7f7f;
            self.put(Bin { key, ..bin });
        }
    }

    /// The best palette of at most `size` colours.
    pub fn palette(&self, size: usize) -> Palette {
        let weighted = self.weighted();
        match self.distinct() {
            Some(distinct) if distinct <= size => {
                Palette::exact(weighted.iter().map(|w| w.color.map(|code| code as u8)).collect())
            }
            _ => Palette::clustered(&weighted, size),
        }
    }

    /// The number of distinct colours, while it is within the limit.
    pub fn distinct(&self) -> Option<usize> {
        (self.coarse == 0 && self.taken <= self.exact_limit).then_some(self.taken)
    }

    /// The mean colours of the bins, in the order of their keys.
    fn weighted(&self) -> Vec<WeightedColor> {
        let mut bins: Vec<&Bin> = self.table.iter().filter(|bin| bin.count > 0).collect();
        bins.sort_unstable_by_key(|bin| bin.key);
        let mean = |bin: &&Bin| bin.sum.map(|sum| (sum as f64 / bin.count as f64) as f32);
        bins.iter().map(|bin| WeightedColor { color: mean(bin), count: bin.count }).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(colors: &[[u8; 3]]) -> Picture {
        Picture::opaque(colors.len() as u32, 1, colors.as_flattened().to_vec())
    }

    #[test]
    fn colours_are_counted_one_by_one() {
        let mut histogram = Histogram::new(1);
        histogram.add(&picture(&[[4, 8, 255], [6, 9, 252], [4, 8, 255], [4, 8, 255]]));
        let expected = [([4.0, 8.0, 255.0], 3), ([6.0, 9.0, 252.0], 1)]
            .map(|(color, count)| WeightedColor { color, count });
        assert_eq!(histogram.weighted(), expected);
        assert_eq!(histogram.distinct(), None);
    }

    #[test]
    fn too_many_colours_share_bins_in_any_order() {
        let color = |i: u32| [i as u8, (i >> 8) as u8, (i >> 16) as u8 * 40];
        let mut colors: Vec<[u8; 3]> = (0..3 << 16).map(color).collect();
        let counted = |colors: &[[u8; 3]]| {
            let mut histogram = Histogram::new(256);
            colors.chunks(1000).for_each(|part| histogram.add(&picture(part)));
            assert_eq!(histogram.coarse, 1);
            histogram.weighted()
        };
        let bins = counted(&colors);
        assert!(bins.len() <= MAX_BINS && bins.iter().map(|bin| bin.count).sum::<u64>() == 3 << 16);
        assert_eq!(bins[0], WeightedColor { color: [0.5, 0.5, 0.0], count: 4 });
        colors.reverse();
        assert!(bins == counted(&colors));
    }

    #[test]
    fn few_colors_stay_as_they_are() {
        let mut histogram = Histogram::new(3);
        histogram.add(&picture(&[[9, 9, 9], [1, 2, 3], [9, 9, 9]]));
        histogram.add(&picture(&[[0, 0, 1]]));
        assert_eq!(histogram.distinct(), Some(3));
        assert_eq!(histogram.palette(3).colors(), [[0, 0, 1], [1, 2, 3], [9, 9, 9]]);
        assert!(histogram.palette(2).colors().len() <= 2);
    }
}
