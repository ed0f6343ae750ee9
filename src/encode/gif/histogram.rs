//! The colours of a whole animation in bounded memory.

use super::palette::Palette;
use crate::encode::picture::Picture;

/// Colours that are told apart, at most.
const MOST: usize = 1 << 16;
/// Places of the table, as a power of two: at most half of them are taken.
const TABLE_BITS: u32 = 17;

/// Counts colours as frames pass: each by itself while there are not too many, and else the finest groups of
/// neighbouring ones that are few enough. What comes out does not depend on the order of the frames.
pub struct Histogram {
    /// The distinct colours as they are, until there are more than `exact_limit`.
    exact_limit: usize,
    /// Bits of every channel that do not count.
    coarse: u32,
    table: Vec<Group>,
    taken: usize,
}

/// How many pixels fell in, and the sum of their colours.
#[derive(Clone, Copy, Default)]
struct Group {
    key: u32,
    count: u64,
    sum: [u64; 3],
}

/// A colour that stands for `count` pixels, in 0..=255 per channel with fractions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weighted {
    pub color: [f32; 3],
    pub count: u64,
}

impl Histogram {
    /// `exact_limit` is the number of colours up to which they are kept as they are.
    pub fn new(exact_limit: usize) -> Self {
        Self { exact_limit, coarse: 0, table: vec![Group::default(); 1 << TABLE_BITS], taken: 0 }
    }

    /// Counts a frame's pixels.
    pub fn add(&mut self, picture: &Picture) {
        let pixels = picture.rgb.as_chunks::<3>().0;
        // Neighbours are often equal, and then one step counts them all.
        for run in pixels.chunk_by(|a, b| a == b) {
            let count = run.len() as u64;
            self.put(Group { key: self.key(run[0]), count, sum: run[0].map(|code| u64::from(code) * count) });
            if self.taken > MOST {
                self.coarsen();
            }
        }
    }

    fn key(&self, color: [u8; 3]) -> u32 {
        color.iter().fold(0, |key, code| key << 8 | u32::from(code >> self.coarse))
    }

    fn put(&mut self, group: Group) {
        let mut place = (group.key.wrapping_mul(0x9E37_79B1) >> (32 - TABLE_BITS)) as usize;
        while self.table[place].count > 0 && self.table[place].key != group.key {
            place = (place + 1) % self.table.len();
        }
        let found = &mut self.table[place];
        self.taken += usize::from(found.count == 0);
        found.key = group.key;
        found.count += group.count;
        found.sum = [0, 1, 2].map(|i| found.sum[i] + group.sum[i]);
    }

    /// Makes groups of eight out of what was told apart.
    fn coarsen(&mut self) {
        let groups = std::mem::replace(&mut self.table, vec![Group::default(); 1 << TABLE_BITS]);
        self.coarse += 1;
        self.taken = 0;
        for group in groups.into_iter().filter(|group| group.count > 0) {
            // Bits do not cross from one channel to the next.
            let key = (group.key >> 1) & 0x7f_7f7f;
            self.put(Group { key, ..group });
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

    /// The groups by their mean colours, in the order of their keys.
    fn weighted(&self) -> Vec<Weighted> {
        let mut groups: Vec<&Group> = self.table.iter().filter(|group| group.count > 0).collect();
        groups.sort_unstable_by_key(|group| group.key);
        let mean = |group: &&Group| group.sum.map(|sum| (sum as f64 / group.count as f64) as f32);
        groups.iter().map(|group| Weighted { color: mean(group), count: group.count }).collect()
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
        let expected =
            [([4.0, 8.0, 255.0], 3), ([6.0, 9.0, 252.0], 1)].map(|(color, count)| Weighted { color, count });
        assert_eq!(histogram.weighted(), expected);
        assert_eq!(histogram.distinct(), None);
    }

    #[test]
    fn too_many_colours_are_grouped_whatever_their_order() {
        let color = |i: u32| [i as u8, (i >> 8) as u8, (i >> 16) as u8 * 40];
        let mut colors: Vec<[u8; 3]> = (0..3 << 16).map(color).collect();
        let counted = |colors: &[[u8; 3]]| {
            let mut histogram = Histogram::new(256);
            colors.chunks(1000).for_each(|part| histogram.add(&picture(part)));
            assert_eq!(histogram.coarse, 1);
            histogram.weighted()
        };
        let groups = counted(&colors);
        assert!(groups.len() <= MOST && groups.iter().map(|group| group.count).sum::<u64>() == 3 << 16);
        assert_eq!(groups[0], Weighted { color: [0.5, 0.5, 0.0], count: 4 });
        colors.reverse();
        assert!(groups == counted(&colors));
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
