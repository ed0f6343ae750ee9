//! What an image shows beyond its edges.

use crate::base::digest::content;

/// What is seen beyond the edges of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The image again.
    #[default]
    Repeat,
    /// The image and its mirror image in turn.
    Mirror,
    /// The texels at the edge.
    Clamp,
}

content!(
    enum Wrap {
        Repeat,
        Mirror,
        Clamp,
    }
);

/// How an image goes on along an axis: a wrap and, where it repeats, the whole numbers of copies between which it does.
/// What lies beyond them is not mixed in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    wrap: Wrap,
    from: f64,
    to: f64,
}

content!(struct Axis { wrap, from, to });

impl From<Wrap> for Axis {
    fn from(wrap: Wrap) -> Self {
        Self { wrap, from: f64::NEG_INFINITY, to: f64::INFINITY }
    }
}

/// Two neighbours, and how far from the lower to the higher one.
pub struct Between {
    pub low: u32,
    pub high: u32,
    pub share: f32,
}

impl Axis {
    /// The image repeats between two whole numbers, the second the larger; each may be infinite.
    pub fn repeating(from: f64, to: f64) -> Self {
        Self { wrap: Wrap::Repeat, from, to }
    }

    /// Of the copies of a repeated image, the one that a finite coordinate is in.
    fn copy(&self, coordinate: f64) -> f64 {
        coordinate.floor().min(self.to - 1.0).max(self.from)
    }

    /// A finite coordinate brought into 0..=1. The end is reached by rounding, or at the end of the last copy.
    fn reduced(&self, coordinate: f64) -> f64 {
        match self.wrap {
            Wrap::Repeat => (coordinate - self.copy(coordinate)).clamp(0.0, 1.0),
            Wrap::Mirror => 1.0 - (1.0 - (coordinate - 2.0 * (coordinate * 0.5).floor())).abs(),
            Wrap::Clamp => coordinate.clamp(0.0, 1.0),
        }
    }

    /// The nearest of a row of `size` texels.
    pub fn nearest(&self, coordinate: f64, size: u32) -> u32 {
        ((self.reduced(coordinate) * f64::from(size)) as u32).min(size - 1)
    }

    /// The two texels around a finite coordinate in a row of `size`.
    pub fn between(&self, coordinate: f64, size: u32) -> Between {
        let at = self.reduced(coordinate) * f64::from(size) - 0.5;
        let low = at.floor();
        let index = |i: i64| self.index(i, i64::from(size), coordinate) as u32;
        Between { low: index(low as i64), high: index(low as i64 + 1), share: (at - low) as f32 }
    }

    /// Which texel stands at index -1..=size of the row that a coordinate is in. The texels at an edge are repeated there
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
