//! The colours of a whole animation in bounded memory.

use super::palette::Palette;
use crate::encode::picture::Picture;
use std::collections::BTreeSet;

/// Bits per channel that select a bin: 2^18 bins of 16 bytes.
const BITS: u32 = 6;

/// Counts colours as frames pass: one by one while they are few, and always in bins.
pub struct Histogram {
    /// The distinct colours, until there are more than `exact_limit`.
    exact: Option<BTreeSet<[u8; 3]>>,
    exact_limit: usize,
    bins: Vec<Bin>,
}

/// How many pixels fell in, and the sum of their colours' lower bits (the upper ones are the bin's own).
#[derive(Clone, Copy, Default)]
struct Bin {
    count: u64,
    low: [u64; 3],
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
        let bins = vec![Bin::default(); 1 << (3 * BITS)];
        Self { exact: Some(BTreeSet::new()), exact_limit, bins }
    }

    /// Counts a frame's pixels.
    pub fn add(&mut self, picture: &Picture) {
        let pixels = picture.rgb.as_chunks::<3>().0;
        self.add_exact(pixels);
        for &[r, g, b] in pixels {
            let high = |channel: u8| usize::from(channel >> (8 - BITS));
            let low = |channel: u8| u64::from(channel & ((1 << (8 - BITS)) - 1));
            let bin = &mut self.bins[(high(r) << (2 * BITS)) | (high(g) << BITS) | high(b)];
            bin.count += 1;
            bin.low[0] += low(r);
            bin.low[1] += low(g);
            bin.low[2] += low(b);
        }
    }

    fn add_exact(&mut self, pixels: &[[u8; 3]]) {
        let mut last = None;
        for &color in pixels {
            let Some(exact) = &mut self.exact else { return };
            if last != Some(color) && exact.insert(color) && exact.len() > self.exact_limit {
                self.exact = None;
            }
            last = Some(color);
        }
    }

    /// The best palette of at most `size` colours.
    pub fn palette(&self, size: usize) -> Palette {
        match &self.exact {
            Some(exact) if exact.len() <= size => Palette::exact(exact.iter().copied().collect()),
            _ => Palette::clustered(&self.weighted(), size),
        }
    }

    /// The number of distinct colours, while it is within the limit.
    pub fn distinct(&self) -> Option<usize> {
        self.exact.as_ref().map(BTreeSet::len)
    }

    /// The bins that hold something, by their mean colours.
    fn weighted(&self) -> Vec<Weighted> {
        let full = self.bins.iter().enumerate().filter(|(_, bin)| bin.count > 0);
        full.map(|(index, bin)| {
            let mean = |channel: u32| {
                let high = (index >> ((2 - channel) * BITS)) & ((1 << BITS) - 1);
                let low = bin.low[channel as usize] as f64 / bin.count as f64;
                ((high << (8 - BITS)) as f64 + low) as f32
            };
            Weighted { color: [mean(0), mean(1), mean(2)], count: bin.count }
        })
        .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(colors: &[[u8; 3]]) -> Picture {
        Picture::opaque(colors.len() as u32, 1, colors.as_flattened().to_vec())
    }

    #[test]
    fn bins_hold_counts_and_means() {
        let mut histogram = Histogram::new(1);
        histogram.add(&picture(&[[4, 8, 255], [6, 9, 252], [200, 0, 0]]));
        let weighted = histogram.weighted();
        let expected = [
            Weighted { color: [5.0, 8.5, 253.5], count: 2 },
            Weighted { color: [200.0, 0.0, 0.0], count: 1 },
        ];
        assert_eq!(weighted, expected);
        assert_eq!(histogram.distinct(), None);
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
