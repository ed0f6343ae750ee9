//! Where rays start on eight surfaces.

use crate::shape::Surfaces;
use crate::simd::{Choice, Octo, Quad, Rows, Vector};

/// Where rays from eight surfaces start, as `super::super::spawn` has it for one.
pub struct Starts<Q: Quad> {
    pub point: Vector<Q>,
    normal: Vector<Q>,
    reach: Octo<Q>,
    /// On the side that the normals are on, where most rays lead.
    above: Vector<Q>,
    /// Lanes in which a smooth surface lies above the point, its normals, and the start there.
    smooth: Option<(Choice<Q>, Vector<Q>, Vector<Q>)>,
}

impl<Q: Quad> Starts<Q> {
    #[inline(always)]
    pub fn new(surfaces: &Surfaces) -> Self {
        let (point, normal) = (Vector::load(&surfaces.point), Vector::load(&surfaces.normal));
        let reach = normal.absolute().dot(Vector::load(&surfaces.error));
        Self { point, normal, reach, above: beyond(point, normal, reach), smooth: None }
    }

    /// Of rays along which light is gathered, as `super::super::spawn::spawn_gathering` has it, where the ways from points
    /// to the smooth surfaces that they stand for are not all zero.
    #[inline(always)]
    pub fn gathering(surfaces: &Surfaces, lift: Option<&Rows>) -> Self {
        let mut starts = Self::new(surfaces);
        if let Some(lift) = lift {
            let lift = Vector::load(lift);
            let lifted = Octo::splat(0.0).below(lift.longest());
            let start = beyond(starts.point + lift, starts.normal, starts.reach);
            starts.smooth = Some((lifted, Vector::load(&surfaces.shading), start));
        }
        starts
    }

    #[inline(always)]
    pub fn towards(&self, direction: Vector<Q>) -> Vector<Q> {
        let Self { point, normal, reach, above, .. } = *self;
        let zero = Octo::splat(0.0);
        let below = direction.dot(normal).below(zero);
        let mut start = above;
        if below.bits() != 0 {
            start = beyond(point, -normal, reach).pick(below, above);
        }
        match self.smooth {
            Some((lifted, shading, there)) => there.pick(lifted & zero.below(direction.dot(shading)), start),
            None => start,
        }
    }
}

/// Points moved to a side, each coordinate rounded away from where it was.
#[inline(always)]
fn beyond<Q: Quad>(point: Vector<Q>, side: Vector<Q>, reach: Octo<Q>) -> Vector<Q> {
    let moved = point + side * reach;
    Vector { x: moved.x.next_away(side.x), y: moved.y.next_away(side.y), z: moved.z.next_away(side.z) }
}
