//! Where rays start on eight surfaces.

use crate::shape::{Rays, Surfaces};
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
        let start = self.beside(direction);
        match self.smooth {
            Some((lifted, shading, there)) => {
                there.pick(lifted & Octo::splat(0.0).below(direction.dot(shading)), start)
            }
            None => start,
        }
    }

    /// On the side of the flat surfaces that directions lead to.
    #[inline(always)]
    fn beside(&self, direction: Vector<Q>) -> Vector<Q> {
        let Self { point, normal, reach, above, .. } = *self;
        let below = direction.dot(normal).below(Octo::splat(0.0));
        match below.bits() {
            0 => above,
            _ => beyond(point, -normal, reach).pick(below, above),
        }
    }

    /// The rays by which mirrors send light on, as `super::super::spawn::spawn_mirrored` has them.
    #[inline(always)]
    pub fn mirrored(&self, direction: Vector<Q>) -> Rays {
        let zero = Octo::splat(0.0);
        let along = self.normal.dot(direction);
        let above = zero.below(along);
        if above.bits() == 0xff {
            return Rays { origin: self.above.store(), direction: direction.store() };
        }
        let up = direction - self.normal * (Octo::splat(2.0) * along);
        let Some((lifted, shading, there)) = self.smooth else {
            let direction = direction.pick(above, up);
            return Rays { origin: self.beside(direction).store(), direction: direction.store() };
        };
        let away = lifted & zero.below(direction.dot(shading));
        let direction = direction.pick(above | away, up);
        let beside = self.beside(direction);
        let origin = beside.pick(above, there.pick(away, beside));
        Rays { origin: origin.store(), direction: direction.store() }
    }
}

/// Points moved to a side, each coordinate rounded away from where it was.
#[inline(always)]
fn beyond<Q: Quad>(point: Vector<Q>, side: Vector<Q>, reach: Octo<Q>) -> Vector<Q> {
    let moved = point + side * reach;
    Vector { x: moved.x.next_away(side.x), y: moved.y.next_away(side.y), z: moved.z.next_away(side.z) }
}
