//! The f32 boxes over which trees are built.

use glam::Vec4;
use std::ops::{Add, Mul};

/// Boxes per parallel task.
pub const CHUNK: usize = 1 << 14;

/// A box. The fourth components do not belong to it.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    pub low: Vec4,
    pub high: Vec4,
}

/// Box planes are clamped to this distance, whatever rounding does. Primitives lie between -1 and 1, and areas must
/// stay finite.
const FARTHEST: f32 = 1e9;

/// Weight of the length in the area, which orders boxes that have no area.
const LENGTH: f32 = 1e-12;

impl Bounds {
    pub const EMPTY: Self = Self { low: Vec4::INFINITY, high: Vec4::NEG_INFINITY };

    pub fn new([low, high]: [[f32; 3]; 2]) -> Self {
        let row = |[x, y, z]: [f32; 3]| Vec4::new(x, y, z, 0.0);
        Self { low: row(low), high: row(high) }.clamped()
    }

    /// The box with -0 replaced by 0 and with planes clamped to [`FARTHEST`].
    #[inline(always)]
    pub fn clamped(self) -> Self {
        // -0 becomes 0: the minimum of the two would depend on their order.
        let row = |row: Vec4| (row + Vec4::ZERO).max(Vec4::splat(-FARTHEST)).min(Vec4::splat(FARTHEST));
        Self { low: row(self.low), high: row(self.high) }
    }

    #[inline(always)]
    pub fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    #[inline(always)]
    pub fn with(self, point: Vec4) -> Self {
        Self { low: self.low.min(point), high: self.high.max(point) }
    }

    /// Half the surface area, which is proportional to the probability that a ray hits the box. Among boxes without
    /// area, longer ones count more, and no box counts zero. So trees over lines and points are balanced too.
    #[inline(always)]
    pub fn half_area(&self) -> f32 {
        half_area((self.high - self.low).truncate().to_array())
    }

    /// The bounds of boxes, and the bounds of their doubled centres.
    pub fn of_boxes_and_centres(boxes: &[PrimRef]) -> [Self; 2] {
        let with = |[all, centres]: [Self; 2], prim: &PrimRef| {
            [all.union(prim.bounds()), centres.with(prim.doubled_centre())]
        };
        boxes.iter().fold([Self::EMPTY; 2], with)
    }

    /// The longest axis of the box.
    #[inline(always)]
    pub fn longest(&self) -> usize {
        let side = self.high - self.low;
        let (of_yz, yz) = if side.z > side.y { (2, side.z) } else { (1, side.y) };
        if side.x >= yz { 0 } else { of_yz }
    }

    /// The lower and the upper corner.
    pub fn corners(&self) -> [[f32; 3]; 2] {
        [self.low.truncate().to_array(), self.high.truncate().to_array()]
    }
}

/// [`Bounds::half_area`] for the sides of a box, or of several.
#[inline(always)]
pub fn half_area<T>([x, y, z]: [T; 3]) -> T
where
    T: Copy + Add<Output = T> + Add<f32, Output = T> + Mul<Output = T> + Mul<f32, Output = T>,
{
    let (length, area) = (x + y + z, x * (y + z) + y * z);
    area + (length * LENGTH + f32::MIN_POSITIVE)
}

/// A primitive reference: the index of a primitive and a box around it or around a piece of it.
#[derive(Clone, Copy, Debug)]
pub struct PrimRef {
    /// The fourth components hold the primitive's index and the mark (1 or 2). The index is XORed with the bits of
    /// 1.0, so that sums of the components stay normal numbers.
    bounds: Bounds,
}

impl PrimRef {
    pub fn new(primitive: u32, mut bounds: Bounds) -> Self {
        bounds.low.w = f32::from_bits(primitive ^ 1.0_f32.to_bits());
        bounds.high.w = 1.0;
        Self { bounds }
    }

    pub fn primitive(&self) -> u32 {
        self.bounds.low.w.to_bits() ^ 1.0_f32.to_bits()
    }

    /// Sets or clears the mark.
    pub fn marked(mut self, mark: bool) -> Self {
        self.bounds.high.w = if mark { 2.0 } else { 1.0 };
        self
    }

    pub fn is_marked(&self) -> bool {
        self.bounds.high.w == 2.0
    }

    #[inline(always)]
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Twice the centre.
    #[inline(always)]
    pub fn doubled_centre(&self) -> Vec4 {
        self.bounds.low + self.bounds.high
    }

    #[inline(always)]
    pub fn doubled_centre_along(&self, axis: usize) -> f32 {
        self.bounds.low[axis] + self.bounds.high[axis]
    }
}
