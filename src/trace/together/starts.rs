//! Where rays start on eight surfaces.

use crate::shape::Surfaces;
use crate::simd::{Octo, Quad, Vector};

/// Where rays from eight surfaces start, as `super::super::spawn` has it for one.
pub struct Starts<Q> {
    pub point: Vector<Q>,
    normal: Vector<Q>,
    reach: Octo<Q>,
    /// On the side that the normals are on, where most rays lead.
    above: Vector<Q>,
}

impl<Q: Quad> Starts<Q> {
    #[inline(always)]
    pub fn new(surfaces: &Surfaces) -> Self {
        let (point, normal) = (Vector::load(&surfaces.point), Vector::load(&surfaces.normal));
        let reach = normal.absolute().dot(Vector::load(&surfaces.error));
        Self { point, normal, reach, above: beyond(point, normal, reach) }
    }

    #[inline(always)]
    pub fn towards(&self, direction: Vector<Q>) -> Vector<Q> {
        let Self { point, normal, reach, above } = *self;
        let below = direction.dot(normal).below(Octo::splat(0.0));
        if below.bits() == 0 {
            return above;
        }
        beyond(point, -normal, reach).pick(below, above)
    }
}

/// Points moved to a side, each coordinate rounded away from where it was.
#[inline(always)]
fn beyond<Q: Quad>(point: Vector<Q>, side: Vector<Q>, reach: Octo<Q>) -> Vector<Q> {
    let moved = point + side * reach;
    Vector { x: moved.x.next_away(side.x), y: moved.y.next_away(side.y), z: moved.z.next_away(side.z) }
}
