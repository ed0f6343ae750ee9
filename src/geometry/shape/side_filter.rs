//! A filter for edge tests: which rays certainly pass through a parallelogram, and which certainly miss it.

use super::PreparedRay;
use crate::base::lanes::{Real, Vec3};
use crate::base::math::{DVec3, UNIT_ROUNDOFF};

/// The rays of eight lanes in three classes: through the parallelogram, beside it, and those in neither mask, which are
/// too close to an edge to decide.
#[derive(Clone, Copy)]
pub struct SideFilter<F: Real> {
    pub inside: F::Mask,
    pub outside: F::Mask,
}

impl<F: Real> SideFilter<F> {
    /// The classes for the parallelogram `corner` + a·`u` + b·`v`, for a and b in 0..=1.
    ///
    /// For s from the corner to the ray's origin, and its direction d, Cramer's rule gives a·D = -v·(s × d) and
    /// b·D = u·(s × d) with D = (u × v)·d (Möller, Trumbore, *Fast, Minimum Storage Ray/Triangle Intersection*, 1997).
    /// A ray is inside if both are between 0 and D.
    ///
    /// The margin covers the rounding of these values and that of [`covers`](super::triangle::covers), so that both
    /// agree wherever the filter decides. No coordinate relative to the ray exceeds R = max|s| + max|u| + max|v|, and
    /// the sheared coordinates do not exceed 2R. With the unit roundoff r:
    /// - `covers` rounds sheared coordinates by at most 7rR: the difference from the origin by rR, the product with the
    ///   shear by 4rR, their difference by 2rR. Its products are at most 4R², so an edge function, times the longest
    ///   component of d, is wrong by less than (4·14 + 2·4 + 8)rR²·max|d| = 72rR²·max|d|.
    /// - Its corners are rounded sums, wrong by at most 2rC with C = max|corner| + max|u| + max|v|. Of the two ends of
    ///   an edge, one is the sum of only two terms. That changes an edge function by at most 24rRC·max|d|.
    /// - Here s × d is wrong by less than 8r·|s|·max|d| per component, and |s|·|v| ≤ R²/4. So a·D and b·D are wrong by less
    ///   than 36rR²·max|d|, and so is D.
    ///
    /// 256rR(R + C)·max|d| is more than the sum of all. It also keeps the ray inside the box that `covers` requires.
    /// Products that underflow are less than 2^-900. If the margin is less than 2^900, no product overflows: all are
    /// below 12R²·max|d|, and 256r > 2^-46. Otherwise the filter decides nothing.
    #[inline(always)]
    pub fn new(ray: &PreparedRay<F>, corner: DVec3, [u, v]: [DVec3; 2]) -> Self {
        let (from, direction) = (ray.ray.origin - Vec3::splat(corner), ray.ray.direction);
        let moment = from.cross(direction);
        let whole = Vec3::<F>::splat(u.cross(v)).dot(direction);
        let (a, b) = (Vec3::splat(-v).dot(moment), Vec3::splat(u).dot(moment));
        let back = whole.is_negative();
        let (a, b, whole) = (F::select(back, -a, a), F::select(back, -b, b), whole.abs());
        let margin = a.min(b).min(whole - a).min(whole - b);
        let size = u.abs().max_element() + v.abs().max_element();
        let reach = from.abs().max_element() + F::splat(size);
        let rounding = reach * (reach + F::splat(corner.abs().max_element() + size));
        let rounding = F::splat(256.0 * UNIT_ROUNDOFF) * ray.longest * rounding;
        let usable = rounding.lt(F::splat(LARGEST));
        let rounding = F::select(usable, rounding.max(F::splat(SMALLEST)), F::splat(f64::INFINITY));
        Self { inside: rounding.lt(margin), outside: margin.lt(-rounding) }
    }
}

/// 2^-900.
const SMALLEST: f64 = f64::from_bits((1023 - 900) << 52);
/// 2^900.
const LARGEST: f64 = f64::from_bits((1023 + 900) << 52);

#[cfg(test)]
mod tests {
    use super::super::triangle::covers;
    use super::*;
    use crate::base::math::Ray;
    use crate::geometry::bvh::TraversalRay;
    use crate::testing::Random;

    /// Rays at parallelograms of all sizes and at all distances, half of them through points at an edge.
    #[test]
    fn decisions_agree_with_the_edge_functions() {
        let mut random = Random(16);
        let (mut decided, mut all) = (0, 0);
        for round in 0..400_000 {
            let power = |random: &mut Random, range: f64| libm::pow(10.0, range * (random.unit() - 0.5));
            let (size, far) = (power(&mut random, 12.0), power(&mut random, 12.0));
            let (u, v) = (random.point(size), random.point(size));
            let corner = random.point(far);
            let [a, mut b] = [random.unit() * 3.0 - 1.0, random.unit() * 3.0 - 1.0];
            if round % 2 == 0 {
                b = [0.0, 1.0][round / 2 % 2] + (random.unit() - 0.5) * power(&mut random, 24.0).min(1.0);
            }
            let target = corner + u * a + v * b;
            let origin = target + random.direction() * size * power(&mut random, 6.0);
            let direction = (target - origin) * power(&mut random, 4.0);
            let ray = PreparedRay::<f64>::splat(&TraversalRay::new(Ray { origin, direction }));
            let sides = SideFilter::new(&ray, corner, [u, v]);
            let corners = [corner, corner + u, corner + u + v, corner + v];
            let covered = covers(&corners.map(|corner| ray.sheared(Vec3::from(corner))));
            assert!(!sides.inside || covered, "{corner} {u} {v}: {origin} {direction}");
            assert!(!sides.outside || !covered, "{corner} {u} {v}: {origin} {direction}");
            decided += usize::from(sides.inside || sides.outside);
            all += 1;
        }
        assert!(4 * decided > 3 * all, "{decided} of {all}");
    }

    /// A margin that is not finite, or that underflows, decides nothing.
    #[test]
    fn extremes_are_left_to_the_edge_functions() {
        for size in [1e-170, 1e160] {
            let (u, v) = (DVec3::X * size, DVec3::Y * size);
            let origin = DVec3::new(0.5, 0.5, 2.0) * size;
            let ray = Ray { origin, direction: DVec3::NEG_Z };
            let ray = PreparedRay::<f64>::splat(&TraversalRay::new(ray));
            let sides = SideFilter::new(&ray, DVec3::ZERO, [u, v]);
            assert!(!sides.inside && !sides.outside, "{size}");
        }
        // One product overflows, and only one.
        let (u, v) = (DVec3::X * 1e97, DVec3::new(1e105, 0.0, 1e105));
        let ray = Ray { origin: DVec3::new(-1e105, 1e100, -1e104), direction: DVec3::new(0.0, -1e100, 0.0) };
        let ray = PreparedRay::<f64>::splat(&TraversalRay::new(ray));
        let sides = SideFilter::new(&ray, DVec3::ZERO, [u, v]);
        assert!(!sides.inside && !sides.outside);
    }
}
