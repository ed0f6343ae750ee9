//! Finds the best split: bins boxes along the three axes and applies the surface area heuristic between the bins (Wald
//! 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies").

use super::bounds::{Bounds, CHUNK, PrimRef};
use glam::Vec4;
use rayon::prelude::*;

/// Adding this to a small number leaves the number, rounded to an integer, in the lowest bits.
const ROUNDING: f32 = (3 << 22) as f32;

/// If all centres lie within this extent, they count as one, because the number of bins per length must be finite.
const CLOSEST: f32 = 1e-30;

/// The best split of boxes whose doubled centres lie in `centres`. None if all centres coincide.
pub fn split(boxes: &[PrimRef], centres: &Bounds) -> Option<Split> {
    match boxes.len() {
        0..=63 => bins::<8>(boxes, centres),
        64..=511 => bins::<16>(boxes, centres),
        512..=4095 => bins::<32>(boxes, centres),
        _ => bins::<128>(boxes, centres),
    }
}

fn bins<const N: usize>(boxes: &[PrimRef], centres: &Bounds) -> Option<Split> {
    let grid = Grid::new(centres, N);
    let bins = if boxes.len() < 2 * CHUNK {
        Bins::<N>::of(&grid, boxes)
    } else {
        // The union of counts and bounds does not depend on the order.
        let parts = boxes.par_chunks(CHUNK).map(|part| Bins::of(&grid, part));
        parts.reduce(|| Bins::EMPTY, Bins::union)
    };
    bins.split(&grid)
}

/// A grid of bins over the doubled centres of boxes.
#[derive(Clone, Copy)]
struct Grid {
    low: Vec4,
    /// Bins per unit of length.
    per_length: Vec4,
}

impl Grid {
    fn new(centres: &Bounds, bins: usize) -> Self {
        let extent = centres.high - centres.low;
        // Slightly less than N bins, so that the last centre falls into the last bin.
        let per_length = Vec4::splat(bins as f32 * 0.9999) / extent;
        let per_length = Vec4::select(extent.cmpgt(Vec4::splat(CLOSEST)), per_length, Vec4::ZERO);
        Self { low: centres.low, per_length }
    }

    /// The bin of a box along each axis.
    #[inline(always)]
    fn places(&self, prim: &PrimRef) -> [usize; 3] {
        let place =
            (prim.doubled_centre() - self.low) * self.per_length - Vec4::splat(0.5) + Vec4::splat(ROUNDING);
        let bin = |place: f32| (place.to_bits() & 0xffff) as usize;
        [bin(place.x), bin(place.y), bin(place.z)]
    }
}

/// A plane between bins, with the bounds of the boxes on both sides.
pub struct Split {
    axis: usize,
    low: f32,
    per_length: f32,
    /// The first bin of the right side.
    right: f32,
    pub bounds: [Bounds; 2],
}

impl Split {
    #[inline(always)]
    pub fn is_left(&self, prim: &PrimRef) -> bool {
        // The same rounding as in `places`.
        (prim.doubled_centre_along(self.axis) - self.low) * self.per_length - 0.5 + ROUNDING < self.right
    }
}

#[derive(Clone)]
struct Bins<const N: usize> {
    bounds: [[Bounds; N]; 3],
    counts: [[u32; N]; 3],
}

impl<const N: usize> Bins<N> {
    const EMPTY: Self = Self { bounds: [[Bounds::EMPTY; N]; 3], counts: [[0; N]; 3] };

    fn of(grid: &Grid, boxes: &[PrimRef]) -> Self {
        let mut bins = Self::EMPTY;
        // Alternates between both halves of the list: neighbours often share a bin, and updates of one bin wait for
        // each other.
        let (front, back) = boxes.split_at(boxes.len() / 2);
        for (a, b) in front.iter().zip(back) {
            bins.count(grid, a);
            bins.count(grid, b);
        }
        if let [last] = back[front.len()..] {
            bins.count(grid, &last);
        }
        bins
    }

    #[inline(always)]
    fn count(&mut self, grid: &Grid, prim: &PrimRef) {
        let bounds = prim.bounds();
        for (axis, place) in grid.places(prim).into_iter().enumerate() {
            // N is a power of two.
            let place = place % N;
            let bin = &mut self.bounds[axis][place];
            *bin = bin.union(bounds);
            self.counts[axis][place] += 1;
        }
    }

    fn union(mut self, other: Self) -> Self {
        for axis in 0..3 {
            for bin in 0..N {
                self.bounds[axis][bin] = self.bounds[axis][bin].union(other.bounds[axis][bin]);
                self.counts[axis][bin] += other.counts[axis][bin];
            }
        }
        self
    }

    fn split(&self, grid: &Grid) -> Option<Split> {
        let mut best = (f32::INFINITY, 0, 0);
        for axis in 0..3 {
            let (bounds, counts) = (&self.bounds[axis], &self.counts[axis]);
            let mut right = [0.0; N];
            let (mut sum, mut count) = (Bounds::EMPTY, 0);
            for bin in (1..N).rev() {
                sum = sum.union(bounds[bin]);
                count += counts[bin];
                right[bin] = if count == 0 { f32::INFINITY } else { sum.half_area() * count as f32 };
            }
            (sum, count) = (Bounds::EMPTY, 0);
            for bin in 1..N {
                sum = sum.union(bounds[bin - 1]);
                count += counts[bin - 1];
                let cost =
                    if count == 0 { f32::INFINITY } else { sum.half_area() * count as f32 } + right[bin];
                if cost < best.0 {
                    best = (cost, axis, bin);
                }
            }
        }
        let (cost, axis, right) = best;
        if cost == f32::INFINITY {
            return None;
        }
        let (left, rest) = self.bounds[axis].split_at(right);
        let bounds = [left, rest].map(|bins| bins.iter().copied().fold(Bounds::EMPTY, Bounds::union));
        Some(Split {
            axis,
            low: grid.low[axis],
            per_length: grid.per_length[axis],
            right: ROUNDING + right as f32,
            bounds,
        })
    }
}
