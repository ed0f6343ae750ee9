//! How far a scene reaches, kept up to date while primitives move.

use crate::base::math::Aabb;
use crate::geometry::bvh::TreeSpace;
use crate::geometry::shape::Shape;
use crate::scene::Primitive;

/// The extent of primitives. Unions are exact and have no order, so an extent depends on the primitives alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Around all bounded primitives.
    pub bounds: Aabb,
    /// The largest coordinate of the points of planes.
    anchor: f64,
}

impl Extent {
    const NONE: Self = Self { bounds: Aabb::EMPTY, anchor: 0.0 };

    pub fn of(primitive: &Primitive) -> Self {
        let anchor = match &primitive.shape {
            Shape::Plane(plane) => plane.point.abs().max_element(),
            _ => 0.0,
        };
        Self { bounds: primitive.bounds().unwrap_or(Aabb::EMPTY), anchor }
    }

    fn union(self, other: &Self) -> Self {
        Self { bounds: self.bounds.union(other.bounds), anchor: self.anchor.max(other.anchor) }
    }

    /// The space of a tree over the bounded primitives.
    pub fn space(&self) -> TreeSpace {
        if self.bounds.is_empty() { TreeSpace::default() } else { TreeSpace::around(self.bounds) }
    }

    /// The largest coordinate of all bounded primitives, rounded up, and of the points of planes.
    pub fn reach(&self) -> f64 {
        self.space().reach().max(self.anchor)
    }
}

/// Slots whose union is kept.
const GROUP: usize = 64;

/// The extents of all slots.
#[derive(Clone, Debug, Default)]
pub struct Extents {
    slots: Vec<Extent>,
    groups: Vec<Extent>,
}

impl Extents {
    pub fn new(primitives: &[Primitive]) -> Self {
        let slots: Vec<Extent> = primitives.iter().map(Extent::of).collect();
        let groups = slots.chunks(GROUP).map(union).collect();
        Self { slots, groups }
    }

    /// The number of slots.
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    /// The bounds of a slot. None if its primitive is infinite or the slot is empty.
    pub fn bounds(&self, slot: usize) -> Option<Aabb> {
        Some(self.slots[slot].bounds).filter(|bounds| !bounds.is_empty())
    }

    /// Replaces the extents of slots; slots may occur several times.
    pub fn update(&mut self, changes: impl Iterator<Item = (usize, Extent)>) {
        let mut dirty = Vec::new();
        for (slot, extent) in changes {
            self.slots[slot] = extent;
            dirty.push(slot / GROUP);
        }
        dirty.sort_unstable();
        dirty.dedup();
        for group in dirty {
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
