//! Rounds: the samples that blocks take between two estimates of their errors.

use super::MIN_SAMPLES;
use std::ops::Range;

/// The samples that a round takes of each pixel, and the numbers of samples at which it compares sums.
///
/// The decay of the error is measured from two comparisons. So the first round makes two: at a quarter, at half and at all
/// of its samples. Each later round doubles the samples of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Round {
    start: u32,
    /// Ascending; the first `parts` of them.
    ends: [u32; Self::MOST_ENDS],
    parts: usize,
}

impl Round {
    pub const MOST_ENDS: usize = 3;

    /// The first round, if pixels take at most `most` samples.
    pub fn first(most: u32) -> Self {
        let end = MIN_SAMPLES.min(most);
        let mut round = Self { start: 0, ends: [0; Self::MOST_ENDS], parts: 0 };
        let mut part = end.div_ceil(4);
        while part < end {
            round.push(part);
            part *= 2;
        }
        round.push(end);
        round
    }

    /// The round from `start` samples on.
    pub fn after(start: u32, most: u32) -> Self {
        Self { start, ends: [start.saturating_mul(2).min(most), 0, 0], parts: 1 }
    }

    fn push(&mut self, end: u32) {
        self.ends[self.parts] = end;
        self.parts += 1;
    }

    /// The number of samples before the round.
    pub fn start(&self) -> u32 {
        self.start
    }

    pub fn ends(&self) -> &[u32] {
        &self.ends[..self.parts]
    }

    /// The number of samples after the round.
    pub fn end(&self) -> u32 {
        self.ends[self.parts - 1]
    }

    pub fn samples(&self) -> Range<u32> {
        self.start..self.end()
    }

    /// The least of the round that leaves each pixel with samples: nothing, or the first part of the first round.
    pub fn shortened(self) -> Option<Self> {
        (self.start == 0).then(|| Self { ends: [self.ends[0], 0, 0], parts: 1, ..self })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_rounds_reach_the_minimum_or_the_limit() {
        for (most, ends) in [
            (1, &[1][..]),
            (2, &[1, 2]),
            (3, &[1, 2, 3]),
            (5, &[2, 4, 5]),
            (8, &[2, 4, 8]),
            (4096, &[2, 4, 8]),
        ] {
            let first = Round::first(most);
            assert_eq!((first.ends(), first.samples()), (ends, 0..ends[ends.len() - 1]));
            let shorter = first.shortened().expect("pixels need samples");
            assert_eq!((shorter.ends(), shorter.shortened()), (&ends[..1], Some(shorter)));
        }
        let later = Round::after(16, 24);
        assert_eq!((later.samples(), later.ends(), later.shortened()), (16..24, &[24][..], None));
    }
}
