//! Wrapping: the continuation of an image beyond its edges.

use crate::base::digest::Content;
use crate::base::lanes::Real;

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

/// The indices of two neighbouring texels, and the fraction of the way from the lower to the higher one.
pub struct TexelPair<F: Real> {
    pub low: F,
    pub high: F,
    pub fraction: F::F32,
}

impl AxisWrap {
    /// Repeats the image between two whole numbers, the second larger than the first. Each may be infinite.
    pub fn repeating(from: f64, to: f64) -> Self {
        Self { wrap: Wrap::Repeat, from, to }
    }

    /// The same wrap in all lanes.
    #[inline(always)]
    pub fn splat<F: Real>(self) -> LaneWrap<F> {
        LaneWrap { wrap: self.wrap, from: F::splat(self.from), to: F::splat(self.to) }
    }

    /// The same wrap, but without ends in the lanes of a mask.
    #[inline(always)]
    pub fn endless_in<F: Real>(self, mask: F::Mask) -> LaneWrap<F> {
        let LaneWrap { wrap, from, to } = self.splat();
        let infinity = F::splat(f64::INFINITY);
        LaneWrap { wrap, from: F::select(mask, -infinity, from), to: F::select(mask, infinity, to) }
    }
}

/// An [`AxisWrap`] in each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaneWrap<F> {
    wrap: Wrap,
    from: F,
    to: F,
}

impl<F: Real> LaneWrap<F> {
    /// The copy of a repeated image that holds a finite coordinate.
    #[inline(always)]
    fn copy(&self, coordinate: F) -> F {
        coordinate.floor().min(self.to - F::splat(1.0)).max(self.from)
    }

    /// Maps a finite coordinate to 0..=1. It can become 1 by rounding, or at the end of the last copy.
    #[inline(always)]
    fn wrapped(&self, coordinate: F) -> F {
        let (zero, half, one, two) = (F::splat(0.0), F::splat(0.5), F::splat(1.0), F::splat(2.0));
        match self.wrap {
            Wrap::Repeat => (coordinate - self.copy(coordinate)).max(zero).min(one),
            Wrap::Mirror => one - (one - (coordinate - two * (coordinate * half).floor())).abs(),
            Wrap::Clamp => coordinate.max(zero).min(one),
        }
    }

    /// The index of the nearest texel in a row of `size` texels.
    #[inline(always)]
    pub fn nearest(&self, coordinate: F, size: u32) -> F {
        let size = f64::from(size);
        (self.wrapped(coordinate) * F::splat(size)).floor().min(F::splat(size - 1.0))
    }

    /// The two texels around a finite coordinate in a row of `size` texels. Beyond an edge, the texel at the edge
    /// repeats unless another copy follows.
    #[inline(always)]
    pub fn texels_around(&self, coordinate: F, size: u32) -> TexelPair<F> {
        let (zero, last) = (F::splat(0.0), F::splat(f64::from(size) - 1.0));
        let at = self.wrapped(coordinate) * F::splat(f64::from(size)) - F::splat(0.5);
        let low = at.floor();
        let high = low + F::splat(1.0);
        let fraction = (at - low).to_f32();
        let (mut before, mut beyond) = (zero, last);
        if self.wrap == Wrap::Repeat {
            let copy = self.copy(coordinate);
            before = F::select(copy.le(self.from), before, last);
            beyond = F::select((self.to - F::splat(1.0)).le(copy), beyond, zero);
        }
        let low = F::select(low.lt(zero), before, low);
        let high = F::select(last.lt(high), beyond, high);
        TexelPair { low, high, fraction }
    }
}
