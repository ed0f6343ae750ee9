//! Rays with all that searches of solids need of them.

use crate::base::lanes::{Mask, Real, Vec3};
use crate::base::math::{Aabb, gamma};
use crate::geometry::shape::{PreparedRay, RayInterval, StoredRays};

/// Rays on their way through a solid and all solids of which it is made.
pub struct SolidRays<'a, F: Real> {
    pub prepared: &'a PreparedRay<F>,
    pub stored: StoredRays,
    /// 1 / direction.
    inverse: Vec3<F>,
}

impl<'a, F: Real> SolidRays<'a, F> {
    #[inline(always)]
    pub fn new(prepared: &'a PreparedRay<F>) -> Self {
        let (one, Vec3 { x, y, z }) = (F::splat(1.0), prepared.ray.direction);
        let inverse = Vec3::new(one / x, one / y, one / z);
        Self { prepared, stored: StoredRays::of(&prepared.ray), inverse }
    }

    /// The lanes whose rays meet a box within bounds, and perhaps others: the crossings of its faces are moved apart by
    /// their rounding, that of three operations and of the move itself. An axis whose inverse is not finite only excludes
    /// rays beside the box.
    #[inline(always)]
    pub fn may_meet(&self, bounds: &Aabb, within: RayInterval<F>) -> F::Mask {
        let (origin, inverse) = (self.prepared.ray.origin, self.inverse);
        let (mut from, mut to, mut beside) = (within.min, within.max, F::Mask::splat(false));
        let (infinity, rounding) = (F::splat(f64::INFINITY), F::splat(gamma(5)));
        let axes = [(origin.x, inverse.x), (origin.y, inverse.y), (origin.z, inverse.z)];
        for (axis, (origin, inverse)) in axes.into_iter().enumerate() {
            let (min, max) = (F::splat(bounds.min[axis]), F::splat(bounds.max[axis]));
            let is_across = infinity.le(inverse.abs());
            beside = beside | (is_across & (origin.lt(min) | max.lt(origin)));
            let (a, b) = ((min - origin) * inverse, (max - origin) * inverse);
            let (near, far) = (a.min(b), a.max(b));
            let (near, far) = (near - near.abs() * rounding, far + far.abs() * rounding);
            from = F::select(is_across, from, from.max(near));
            to = F::select(is_across, to, to.min(far));
        }
        from.le(to) & !beside
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::{DVec3, Ray};
    use crate::geometry::bvh::TraversalRay;
    use crate::testing::Random;

    fn may_meet(bounds: &Aabb, origin: DVec3, direction: DVec3, max: f64) -> bool {
        let ray = PreparedRay::<f64>::splat(&TraversalRay::new(Ray { origin, direction }));
        SolidRays::new(&ray).may_meet(bounds, RayInterval::up_to(max))
    }

    const BOX: Aabb = Aabb { min: DVec3::new(-1.0, -2.0, 3.0), max: DVec3::new(1.0, 2.0, 4.0) };

    /// Rays through points of the box, from far away and from near it, never miss it.
    #[test]
    fn rays_through_the_box_meet_it() {
        let mut random = Random(12);
        for round in 0..100_000 {
            let mut share = DVec3::new(random.unit(), random.unit(), random.unit());
            if round % 2 == 0 {
                // On a face, an edge or a corner.
                let ends = share.map(f64::round);
                share = if round % 4 == 0 { ends } else { DVec3::new(ends.x, share.y, share.z) };
            }
            let target = BOX.min + (BOX.max - BOX.min) * share;
            let far = libm::pow(10.0, 12.0 * random.unit() - 3.0);
            let direction = random.direction();
            let origin = target - direction * far;
            // The rounding of the origin moves the ray: of a product and a sum of terms that are at most `far + 4`.
            let margin = DVec3::splat(gamma(2) * (far + 4.0));
            let around = Aabb { min: BOX.min - margin, max: BOX.max + margin };
            assert!(may_meet(&around, origin, direction, f64::INFINITY), "{origin} {direction}");
        }
    }

    #[test]
    fn rays_along_axes_are_decided_by_their_origins() {
        for zero in [0.0, -0.0, 5e-324] {
            let along = DVec3::new(zero, zero, 1.0);
            for (x, y, wanted) in [(0.0, 0.0, true), (1.0, -2.0, true), (1.1, 0.0, false), (0.0, -2.1, false)]
            {
                for (z, ahead) in [(-9.0, true), (3.0, true), (3.5, true), (4.5, false)] {
                    let met = may_meet(&BOX, DVec3::new(x, y, z), along, f64::INFINITY);
                    assert_eq!(met, wanted && ahead, "{x} {y} {z} along {along}");
                }
            }
        }
        assert!(!may_meet(&BOX, DVec3::ZERO, DVec3::Z, 2.9) && may_meet(&BOX, DVec3::ZERO, DVec3::Z, 3.1));
        assert!(!may_meet(&BOX, DVec3::ZERO, DVec3::NAN, f64::INFINITY));
    }
}
