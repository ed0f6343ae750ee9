//! The interior of cylinders and cones around the y axis.

use crate::base::digest::Content;
use crate::base::lanes::{Mask, Real, Row, Select, Vec3};
use crate::base::math::{DVec2, DVec3, LaneRay, difference_of_products, gamma};

/// The parts of cylinders and cones.
pub const SIDE: u32 = 0;
pub const BOTTOM: u32 = 1;
pub const TOP: u32 = 2;

/// A radius that changes linearly along the y axis: `mean` at 0, `mean` + `lean` at `half`. It is at least 0 from
/// -`half` to `half`. Beyond, on a cone, it may be negative: that is the mirrored nappe.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
pub struct Taper {
    pub half: f64,
    pub mean: f64,
    pub lean: f64,
}

/// Where lines enter and leave a solid.
#[derive(Clone, Copy)]
pub struct Interval<F: Real> {
    pub enter: F,
    pub leave: F,
    /// The parts at entry and exit.
    pub enter_part: F::U32,
    pub leave_part: F::U32,
    /// Lines that hit the solid.
    pub meets: F::Mask,
}

impl Taper {
    /// The radius at `y`, computed from the narrower end. For a cylinder it is exactly `mean` at any distance. For a
    /// cone it is exact to a few of its own roundings, however close the tip is.
    #[inline(always)]
    pub fn radius<F: Real>(&self, y: F) -> F {
        let from_narrow = F::splat(self.half) + y.copysign(y * F::splat(self.lean));
        let growth = F::splat(self.lean.abs());
        F::splat(self.mean - self.lean.abs()) + from_narrow / F::splat(self.half) * growth
    }

    pub fn end_radius(&self, part: u32) -> f64 {
        self.radius(if part == TOP { self.half } else { -self.half })
    }

    /// A bound of the distance of any point from the centre.
    pub fn reach(&self) -> f64 {
        self.half + self.mean + self.lean.abs()
    }

    /// The unit normal of the side in the plane of the axis: (away from the axis, along it).
    pub fn normal(&self) -> DVec2 {
        DVec2::new(self.half, -self.lean) / libm::hypot(self.half, self.lean)
    }

    /// Lines that may hit the solid: a few products, which spare most others the crossings. The solid lies within an
    /// infinite cylinder and within a sphere. A line's distance from the axis, and from the centre, is that of its
    /// moment o × d over the direction's length across the axis, and over all of it.
    ///
    /// Each component of the moment is a difference of two products, so its error is at most gamma(2) (|o| |d|). The
    /// bounds are those of exact numbers, widened by that error and by the roundings of their own.
    #[inline(always)]
    pub fn may_meet<F: Real>(&self, ray: &LaneRay<F>) -> F::Mask {
        let LaneRay { origin: o, direction: d } = ray;
        let moment = o.cross(*d);
        let (across, along) = (d.x * d.x + d.z * d.z, d.y * d.y);
        let widest = self.mean + self.lean.abs();
        let longest = d.x.abs() + d.y.abs() + d.z.abs();
        let error = (o.x.abs() + o.y.abs() + o.z.abs()) * longest * F::splat(gamma(16));
        let off_axis = moment.y * moment.y;
        let off_center = off_axis + (moment.x * moment.x + moment.z * moment.z);
        let beside = exceeds(off_axis, widest * widest, across, longest, error);
        let around = self.half * self.half + widest * widest;
        !(beside | exceeds(off_center, around, across + along, longest, error))
    }

    /// Where lines enter and leave the closed solid. It is convex, within its radius and between its ends. So a line
    /// is inside from the last entry to the first exit. At the seam of side and end, a line finds no gap and never
    /// just one crossing.
    ///
    /// From far away, no ray starts on or in the solid. Then the crossings are computed from the point closest to the
    /// centre, or to the tip. For lines nearly parallel to the side, the quadratic's coefficients cancel, and more so
    /// from farther away. Past a tip, the crossings are in order only if they are computed from there.
    #[inline(always)]
    pub fn crossings<F: Real>(&self, ray: &LaneRay<F>) -> Interval<F> {
        let afar = F::splat(self.reach()).lt(ray.origin.length());
        if !afar.any() {
            return self.crossings_near(ray);
        }
        let tip = if self.lean.abs() == self.mean { self.half.copysign(-self.lean) } else { 0.0 };
        let from = ray.origin - Vec3::splat(DVec3::Y * tip);
        let shift = -from.dot(ray.direction) / ray.direction.length_squared();
        let shift = F::select(afar, shift, F::splat(0.0));
        let near = LaneRay { origin: Vec3::select(afar, ray.at(shift), ray.origin), ..*ray };
        let crossings = self.crossings_near(&near);
        Interval { enter: crossings.enter + shift, leave: crossings.leave + shift, ..crossings }
    }

    #[inline(always)]
    fn crossings_near<F: Real>(&self, ray: &LaneRay<F>) -> Interval<F> {
        let ends = self.ends(ray);
        let (from, to, within) = self.within(ray);
        let (later, sooner) = (ends.enter.lt(from), to.lt(ends.leave));
        let side = F::U32::splat(SIDE);
        let enter = F::select(later, from, ends.enter);
        let leave = F::select(sooner, to, ends.leave);
        Interval {
            enter,
            leave,
            enter_part: F::U32::select(later, side, ends.enter_part),
            leave_part: F::U32::select(sooner, side, ends.leave_part),
            meets: ends.meets & within & enter.le(leave),
        }
    }

    /// Where rays enter and leave the slab between the ends. The side of an end is the sign of a difference of two
    /// coordinates, so it is exact.
    #[inline(always)]
    fn ends<F: Real>(&self, ray: &LaneRay<F>) -> Interval<F> {
        let (y, dy, half) = (ray.origin.y, ray.direction.y, F::splat(self.half));
        let zero = F::splat(0.0);
        let level = dy.eq(zero);
        let between = y.abs().le(half);
        let (bottom, top) = ((-half - y) / dy, (half - y) / dy);
        let upwards = zero.lt(dy);
        let (enter, leave) = (F::select(upwards, bottom, top), F::select(upwards, top, bottom));
        // The tip of a cone belongs to its side.
        let part = |part: u32| if self.end_radius(part) > 0.0 { part } else { SIDE };
        let (low, high) = (F::U32::splat(part(BOTTOM)), F::U32::splat(part(TOP)));
        Interval {
            enter: F::select(level, F::splat(f64::NEG_INFINITY), enter),
            leave: F::select(level, F::splat(f64::INFINITY), leave),
            enter_part: F::U32::select(upwards, low, high),
            leave_part: F::U32::select(upwards, high, low),
            meets: !level | between,
        }
    }

    /// The interval of t in which lines are within a radius of at least 0, and the lines that have one.
    ///
    /// With o and d across the axis, and the radius r + g t along the line, the line is within where a t² + 2 b t + c
    /// <= 0 for a = d² - g², b = o·d - r g, c = o² - r². Both differences of squares are factored. Where b² - a c
    /// would cancel, so is the discriminant: it is |g o - r d|² - (o × d)², by the identity of Lagrange for a scalar
    /// product of signature (+, +, -).
    #[inline(always)]
    fn within<F: Real>(&self, ray: &LaneRay<F>) -> (F, F, F::Mask) {
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        let (ox, oz, dx, dz) = (ray.origin.x, ray.origin.z, ray.direction.x, ray.direction.z);
        let r = self.radius(ray.origin.y);
        let g = ray.direction.y / F::splat(self.half) * F::splat(self.lean);
        let (distance, speed) = ((ox * ox + oz * oz).sqrt(), (dx * dx + dz * dz).sqrt());
        let a = (speed - g.abs()) * (speed + g.abs());
        let c = (distance - r.abs()) * (distance + r.abs());
        let b = (ox * dx + oz * dz) - r * g;
        // Steeper than the side and inside: |o·d| < |r g|, even if rounding hides it.
        let inwards = -b.abs() * one.copysign(r) * one.copysign(g);
        let b = F::select(a.lt(zero) & c.lt(zero), inwards, b);
        let (wx, wz) = (ox * g - dx * r, oz * g - dz * r);
        let w = (wx * wx + wz * wz).sqrt();
        let k = difference_of_products(ox, dz, oz, dx).abs();
        let discriminant = F::select(zero.lt(a * c), (w - k) * (w + k), b * b - a * c);
        // Flatter lines hit at most one nappe: that of the radius at -b / a, midway between both roots.
        let passes = zero.lt(a) & (discriminant.lt(zero) | (r * a).lt(g * b));
        // Steeper lines always hit both nappes, or the tip.
        let root = discriminant.max(zero).sqrt();
        let (from, to, meets) = interval((a, c), -(b + root.copysign(b)), g);
        (from, to, meets & !passes)
    }
}

/// Whether the square of a moment surely exceeds that of a distance times a direction: `moment` > (r |d| + `error`)² for
/// r² = `distance` and |d|² = `square`, where `longest` is at least |d|. NaN does not exceed.
#[inline(always)]
fn exceeds<F: Real>(moment: F, distance: f64, square: F, longest: F, error: F) -> F::Mask {
    let exact = F::splat(distance * (1.0 + gamma(16))) * square;
    let twice = F::splat(2.0 * distance.sqrt() * (1.0 + gamma(16)));
    (exact + error * (twice * longest + error)).lt(moment)
}

/// The t at which a t² + 2 b t + c <= 0, where `q` is -(b ± √(b² - a c)) without cancellation. Of two half-lines, the
/// one along which the radius grows with `g`.
#[inline(always)]
fn interval<F: Real>((a, c): (F, F), q: F, g: F) -> (F, F, F::Mask) {
    let (zero, infinite) = (F::splat(0.0), F::splat(f64::INFINITY));
    let first = F::select(q.eq(zero), zero, c / q);
    let flat = zero.lt(a);
    let level = a.eq(zero);
    // Parallel to the side: one crossing.
    let second = F::select(level, first, q / a);
    let (low, high) = (first.min(second), first.max(second));
    let grows = zero.lt(g);
    let from = F::select(flat, low, F::select(grows, high, -infinite));
    let to = F::select(flat, high, F::select(grows, infinite, low));
    // Along the axis of a cylinder, or along the side itself: the distance from the side is constant.
    let along = level & (g.eq(zero) | q.eq(zero));
    let from = F::select(along, -infinite, from);
    (from, F::select(along, infinite, to), !along | c.le(zero))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    /// Points of solids, in thin and flat ones too, and lines through them from near and far, of any length.
    #[test]
    fn lines_through_the_solid_may_meet_it() {
        let mut random = Random(5);
        let mut turn = |low: f64, high: f64| low + (high - low) * random.unit();
        for _ in 0..200_000 {
            let (half, mean) = (libm::exp2(turn(-20.0, 20.0)), libm::exp2(turn(-20.0, 20.0)));
            let taper = Taper { half, mean, lean: mean * turn(-1.0, 1.0) };
            // Half of the points are on the side or at an end.
            let y = half * turn(-1.5, 1.5).clamp(-1.0, 1.0);
            let (sin, cos) = libm::sincos(turn(0.0, std::f64::consts::TAU));
            let away = taper.radius(y) * turn(0.0, 2.0).min(1.0);
            let hit = DVec3::new(away * sin, y, away * cos);
            let direction = DVec3::new(turn(-1.0, 1.0), turn(-1.0, 1.0), turn(-1.0, 1.0));
            let direction = direction * libm::exp2(turn(-30.0, 30.0));
            let origin = hit - direction * libm::exp2(turn(-30.0, 60.0));
            // What rounding leaves of the line may pass the point by the size of the origin's own rounding.
            let miss = (hit - origin).cross(direction).length() / direction.length();
            let ray = LaneRay { origin: Vec3::from(origin), direction: Vec3::from(direction) };
            assert!(miss <= 4.0 * f64::EPSILON * (origin.length() + hit.length()));
            assert!(taper.may_meet(&ray), "{taper:?} {ray:?} through {hit}");
        }
    }

    /// Lines that pass beside the cylinder or around the sphere by a millionth of the radius.
    #[test]
    fn lines_beside_the_solid_are_spared() {
        let mut random = Random(6);
        let mut turn = |low: f64, high: f64| low + (high - low) * random.unit();
        let taper = Taper { half: 2.0, mean: 0.75, lean: -0.25 };
        let (widest, farthest) = (1.0, f64::sqrt(5.0));
        for _ in 0..10_000 {
            let (sin, cos) = libm::sincos(turn(0.0, std::f64::consts::TAU));
            let along = DVec3::new(-cos, turn(-1.0, 1.0), sin).normalize();
            let beside = DVec3::new(sin, 0.0, cos) * widest * (1.0 + 1e-6) + DVec3::Y * turn(-1.0, 1.0);
            let above = along.any_orthonormal_vector() * farthest * (1.0 + 1e-6);
            for point in [beside, above] {
                let origin = point - along * turn(-100.0, 100.0);
                let ray = LaneRay { origin: Vec3::from(origin), direction: Vec3::from(along) };
                assert!(!taper.may_meet(&ray), "{ray:?}");
            }
        }
    }
}
