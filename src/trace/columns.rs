//! Columns of streams: reading eight items of any indices, and appending those of a mask.

use crate::base::lanes::{Color, Lookup, Real, Single, Vec3};

/// Padding behind the last number, which stages may overwrite.
pub(super) const SLACK: usize = 8;

/// A column of numbers.
pub(super) type Reals = Vec<f64>;
pub(super) type Singles = Vec<f32>;
pub(super) type Wholes = Vec<u32>;

#[inline(always)]
pub(super) fn gather<F: Real>([x, y, z]: &[Reals; 3], at: &Lookup) -> Vec3<F> {
    Vec3::gather([x, y, z], at)
}

#[inline(always)]
pub(super) fn colors<S: Single>([r, g, b]: &[Singles; 3], at: &Lookup) -> Color<S> {
    Color::gather([r, g, b], at)
}

#[inline(always)]
pub(super) fn compress<F: Real>([x, y, z]: &mut [Reals; 3], v: Vec3<F>, mask: F::Mask, at: usize) {
    v.x.compress(mask, x, at);
    v.y.compress(mask, y, at);
    v.z.compress(mask, z, at);
}

#[inline(always)]
pub(super) fn compress_colors<S: Single>(
    [r, g, b]: &mut [Singles; 3],
    color: Color<S>,
    mask: S::Mask,
    at: usize,
) {
    color.r.compress(mask, r, at);
    color.g.compress(mask, g, at);
    color.b.compress(mask, b, at);
}

#[inline(always)]
pub(super) fn store_colors<S: Single>([r, g, b]: &mut [Singles; 3], color: Color<S>, at: usize) {
    color.r.store(r, at);
    color.g.store(g, at);
    color.b.store(b, at);
}
