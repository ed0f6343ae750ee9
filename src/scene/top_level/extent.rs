//! How far a scene reaches, kept up to date while primitives move.

use crate::base::math::{Aabb, DVec3};
use crate::geometry::bvh::TreeSpace;
use crate::geometry::shape::Shape;
use crate::scene::Primitive;

/// The extent of primitives. Unions are exact and have no order, so an extent depends on the primitives alone.
///
/// One cache line: the lower corner of the box around all bounded primitives, the negated upper corner, the negated
/// largest coordinate of the points of planes, and 0. So a union is a minimum of each number.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Extent([f64; 8]);

impl Extent {
    const NONE: Self = Self::new(Aabb::EMPTY, 0.0);

    const fn new(Aabb { min, max }: Aabb, anchor: f64) -> Self {
        Self([min.x, min.y, min.z, -max.x, -max.y, -max.z, -anchor, 0.0])
    }

    #[inline]
    pub fn of(primitive: &Primitive) -> Self {
        let anchor = match &primitive.shape {
            Shape::Plane(plane) => plane.point.abs().max_element(),
            _ => 0.0,
        };
        Self::new(primitive.bounds().unwrap_or(Aabb::EMPTY), anchor)
    }

    #[inline]
    fn union(mut self, Self(other): &Self) -> Self {
        for (own, other) in self.0.iter_mut().zip(other) {
            *own = if *other < *own { *other } else { *own };
        }
        self
    }

    /// The box around all bounded primitives. None if there are none.
    #[inline]
    pub fn bounds(&self) -> Option<Aabb> {
        let [x, y, z, to_x, to_y, to_z, ..] = self.0;
        let bounds = Aabb { min: DVec3::new(x, y, z), max: -DVec3::new(to_x, to_y, to_z) };
        (!bounds.is_empty()).then_some(bounds)
    }

    /// The space of a tree over the bounded primitives.
    pub fn space(&self) -> TreeSpace {
        self.bounds().map_or_else(TreeSpace::default, TreeSpace::around)
    }

    /// The largest coordinate of all bounded primitives, rounded up, and of the points of planes.
    pub fn reach(&self) -> f64 {
        let [.., anchor, _] = self.0;
        self.space().reach().max(-anchor)
    }
}

/// Slots whose union is kept.
const GROUP: usize = 64;

/// The extents of all slots.
#[derive(Clone, Debug, Default)]
pub struct Extents {
    slots: Vec<Extent>,
    groups: Vec<Extent>,
    /// Groups of the slots that were set since the last update, in the order in which these were set. A group may occur
    /// again, but not twice in a row.
    dirty: Vec<usize>,
}

impl Extents {
    pub fn new(primitives: &[Primitive]) -> Self {
        let slots: Vec<Extent> = primitives.iter().map(Extent::of).collect();
        let groups = slots.chunks(GROUP).map(union).collect();
        Self { slots, groups, dirty: Vec::new() }
    }

    /// The number of slots.
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    /// The bounds of a slot. None if its primitive is infinite or the slot is empty.
    pub fn bounds(&self, slot: usize) -> Option<Aabb> {
        self.slots[slot].bounds()
    }

    /// Replaces the extent of a slot. Call [`Extents::update`] after the last one.
    #[inline]
    pub fn set(&mut self, slot: usize, extent: Extent) {
        self.slots[slot] = extent;
        if self.dirty.last() != Some(&(slot / GROUP)) {
            self.dirty.push(slot / GROUP);
        }
    }

    /// Brings the extent of everything up to date.
    pub fn update(&mut self) {
        self.dirty.sort_unstable();
        self.dirty.dedup();
        for group in self.dirty.drain(..) {
            let last = self.slots.len().min((group + 1) * GROUP);
            self.groups[group] = union(&self.slots[group * GROUP..last]);
        }
    }

    /// The extent of everything.
    pub fn all(&self) -> Extent {
        union(&self.groups)
    }
}

fn union(extents: &[Extent]) -> Extent {
    extents.iter().fold(Extent::NONE, Extent::union)
}
