//! Wrapping: the continuation of an image beyond its edges.

use crate::base::digest::Content;

/// The continuation of an image beyond its edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Content)]
pub enum Wrap {
    /// The image again.
    #[default]
    Repeat,
    /// The image and its mirror image in turn.
    Mirror,
    /// The texels at the edge.
    Clamp,
}

/// Wrapping along one axis. If the image repeats, it does so between two whole numbers of copies. Filtering ignores
/// whatever is beyond them.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
pub struct AxisWrap {
    wrap: Wrap,
    from: f64,
    to: f64,
}

impl From<Wrap> for AxisWrap {
    fn from(wrap: Wrap) -> Self {
        Self { wrap, from: f64::NEG_INFINITY, to: f64::INFINITY }
    }
}

/// Two neighbouring texels, and the fraction of the way from the lower to the higher one.
pub struct TexelPair {
    pub low: u32,
    pub high: u32,
    pub fraction: f32,
}

impl AxisWrap {
    /// Repeats the image between two whole numbers, the second larger than the first. Each may be infinite.
    pub fn repeating(from: f64, to: f64) -> Self {
        Self { wrap: Wrap::Repeat, from, to }
    }

    /// The copy of a repeated image that holds a finite coordinate.
    #[inline(always)]
    fn copy(&self, coordinate: f64) -> f64 {
        coordinate.floor().min(self.to - 1.0).max(self.from)
    }

    /// Maps a finite coordinate to 0..=1. It can become 1 by rounding, or at the end of the last copy.
    #[inline(always)]
    fn wrapped(&self, coordinate: f64) -> f64 {
        match self.wrap {
            Wrap::Repeat => (coordinate - self.copy(coordinate)).clamp(0.0, 1.0),
            Wrap::Mirror => 1.0 - (1.0 - (coordinate - 2.0 * (coordinate * 0.5).floor())).abs(),
            Wrap::Clamp => coordinate.clamp(0.0, 1.0),
        }
    }

    /// The nearest texel in a row of `size` texels.
    #[inline(always)]
    pub fn nearest(&self, coordinate: f64, size: u32) -> u32 {
        ((self.wrapped(coordinate) * f64::from(size)) as u32).min(size - 1)
    }

    /// The two texels around a finite coordinate in a row of `size` texels.
    #[inline(always)]
    pub fn texels_around(&self, coordinate: f64, size: u32) -> TexelPair {
        let at = self.wrapped(coordinate) * f64::from(size) - 0.5;
        let low = at.floor();
        let index = |i: i64| self.index(i, i64::from(size), coordinate) as u32;
        TexelPair { low: index(low as i64), high: index(low as i64 + 1), fraction: (at - low) as f32 }
    }

    /// The texel at index -1..=size of the row that holds a coordinate. Beyond an edge, the texel at the edge repeats
    /// unless another copy follows.
    fn index(&self, i: i64, size: i64, coordinate: f64) -> i64 {
        if (0..size).contains(&i) {
            return i;
        }
        let ends = match self.wrap {
            Wrap::Repeat if i < 0 => self.copy(coordinate) <= self.from,
            Wrap::Repeat => self.copy(coordinate) >= self.to - 1.0,
            Wrap::Mirror | Wrap::Clamp => true,
        };
        if ends { i.clamp(0, size - 1) } else { i.rem_euclid(size) }
    }
}
