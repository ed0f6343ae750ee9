//! Boxes in f32, as trees are built over them.

use glam::Vec4;

/// A box. The fourth numbers are no part of it.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    pub low: Vec4,
    pub high: Vec4,
}

/// Planes are no farther out than this, whatever rounding may have done to boxes: things lie between -1 and 1, and areas
/// must be numbers.
const FARTHEST: f32 = 1e9;

/// What length adds to area, for boxes that have none.
const LENGTH: f32 = 1e-12;

impl Bounds {
    pub const EMPTY: Self = Self { low: Vec4::INFINITY, high: Vec4::NEG_INFINITY };

    pub fn new([low, high]: [[f32; 3]; 2]) -> Self {
        let row = |[x, y, z]: [f32; 3]| Vec4::new(x, y, z, 0.0);
        Self { low: row(low), high: row(high) }.tamed()
    }

    /// With planes to compute with.
    #[inline(always)]
    pub fn tamed(self) -> Self {
        // -0 becomes 0: which of both is the smaller would depend on which comes first.
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

    /// How likely rays meet the box, by half the area of its sides. Of boxes without an area the longer ones come to
    /// more, and no box comes to nothing: so where all are lines or points, trees are balanced too.
    #[inline(always)]
    pub fn measure(&self) -> f32 {
        let side = self.high - self.low;
        let (length, area) = (side.x + side.y + side.z, side.x * (side.y + side.z) + side.y * side.z);
        area + (LENGTH * length + f32::MIN_POSITIVE)
    }

    /// Around boxes, and around twice their centres.
    pub fn both(boxes: &[Boxed]) -> [Self; 2] {
        let with = |[all, centres]: [Self; 2], boxed: &Boxed| {
            [all.union(boxed.bounds()), centres.with(boxed.centre())]
        };
        boxes.iter().fold([Self::EMPTY; 2], with)
    }

    /// The axis along which the box is longest.
    #[inline(always)]
    pub fn longest(&self) -> usize {
        let side = self.high - self.low;
        let (of_yz, yz) = if side.z > side.y { (2, side.z) } else { (1, side.y) };
        if side.x >= yz { 0 } else { of_yz }
    }

    /// The lower and the upper corner.
    pub fn corners(&self) -> [[f32; 3]; 2] {
        [self.low, self.high].map(|corner| corner.truncate().to_array())
    }
}

/// A thing to be found by its box, which may hold a part of it only.
#[derive(Clone, Copy, Debug)]
pub struct Boxed {
    /// Its fourth numbers are the thing's index, and 1 or 2, so that sums of both are numbers to compute with.
    bounds: Bounds,
}

impl Boxed {
    pub fn new(thing: u32, mut bounds: Bounds) -> Self {
        bounds.low.w = f32::from_bits(thing ^ 1.0_f32.to_bits());
        bounds.high.w = 1.0;
        Self { bounds }
    }

    pub fn thing(&self) -> u32 {
        self.bounds.low.w.to_bits() ^ 1.0_f32.to_bits()
    }

    /// With a mark or without.
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
    pub fn centre(&self) -> Vec4 {
        self.bounds.low + self.bounds.high
    }

    #[inline(always)]
    pub fn centre_along(&self, axis: usize) -> f32 {
        self.bounds.low[axis] + self.bounds.high[axis]
    }
}
