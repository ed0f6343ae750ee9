//! Frustums, which cylinders and cones share: a straight side around an axis and two flat ends across it.

use super::frame::{ShapeFrame, around, at_turn, away_from_axis, circle_support, even_scale, from_axis};
use super::taper::{BOTTOM, Interval, SIDE, TOP, Taper};
use super::{LaneHit, LaneSurface, RayInterval, exit};
use crate::base::digest::Content;
use crate::base::lanes::{Bits, Mask, Real, Row, Select, Vec3, out_of_line};
use crate::base::math::{Aabb, DAffine3, DVec2, DVec3, LaneRay, cos_sin_of_turns, gamma, max};
use std::f64::consts::PI;

/// A flat end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    Bottom,
    Top,
}

/// A surface around an axis. Its radius changes linearly from the bottom to the top.
#[derive(Clone, Debug, PartialEq, Content)]
pub struct Frustum {
    /// At the middle of the axis. Boxed, to keep lists of shapes small.
    frame: Box<ShapeFrame>,
    taper: Taper,
    /// Whether the ends are closed.
    capped: bool,
}

out_of_line! {
    fn intersect<'k, F>(frustum: &'k Frustum, ray: &'k LaneRay<F>, within: RayInterval<F>) -> LaneHit<F> {
        let ray = frustum.frame.local(ray);
        let near = frustum.taper.may_meet(&ray);
        if !near.any() {
            return LaneHit::none();
        }
        let Interval { enter, leave, enter_part, leave_part, meets } = frustum.taper.crossings(&ray);
        let (side, all) = (F::U32::splat(SIDE), F::Mask::splat(frustum.capped));
        let enters = within.min.lt(enter) & (all | enter_part.eq(side));
        let seen = near & meets & (enters | all | leave_part.eq(side));
        let hit = LaneHit::within(seen, F::select(enters, enter, exit(enter, leave, within)), within);
        LaneHit { part: F::U32::select(enters, enter_part, leave_part), ..hit }
    }
}

out_of_line! {
    fn surface<'k, F>(frustum: &'k Frustum, ray: &'k LaneRay<F>, at: LaneHit<F>, origin_error: f64) -> LaneSurface<F> {
        let ray = frustum.frame.local(ray);
        let near = ray.at(at.t);
        let clearance = frustum.clearance(origin_error);
        let on_side = at.part.eq(F::U32::splat(SIDE));
        let is_top = at.part.eq(F::U32::splat(TOP));
        if !on_side.any() {
            return frustum.end(near, is_top, clearance);
        }
        let side = frustum.side(near, frustum.turn(&ray, at.t, clearance), clearance);
        if !(!on_side).any() {
            return side;
        }
        LaneSurface::select(on_side, side, frustum.end(near, is_top, clearance))
    }
}

out_of_line! {
    fn sample_area<'k, F>(frustum: &'k Frustum, u: F, v: F) -> (LaneSurface<F>, F::U32) {
        let zero = F::splat(0.0);
        let [side, bottom, top] = frustum.areas();
        let rest = u * F::splat(frustum.area());
        // What rounding leaves over goes to the last part that exists.
        let on_side = rest.lt(F::splat(side)) | F::Mask::splat(bottom + top == 0.0);
        let rest = F::select(on_side, rest, rest - F::splat(side));
        let on_bottom = !on_side & (rest.lt(F::splat(bottom)) | F::Mask::splat(top == 0.0));
        let is_top = !on_side & !on_bottom;
        let rest = F::select(is_top, rest - F::splat(bottom), rest);
        let area = F::select(on_side, F::splat(side), F::select(is_top, F::splat(top), F::splat(bottom)));
        let share = (rest / area).max(zero).min(F::splat(1.0));
        let (cosine, sine) = cos_sin_of_turns(v);
        let (radius, y) = frustum.side_sample(share);
        let clearance = frustum.clearance(0.0);
        let of_side = frustum.side(Vec3::new(radius, y, zero), [cosine, sine], clearance);
        let widest =
            F::select(is_top, F::splat(frustum.taper.end_radius(TOP)), F::splat(frustum.taper.end_radius(BOTTOM)));
        let length = widest * share.sqrt();
        let of_end = frustum.end(Vec3::new(cosine * length, zero, sine * length), is_top, clearance);
        let end = F::U32::select(is_top, F::U32::splat(TOP), F::U32::splat(BOTTOM));
        (LaneSurface::select(on_side, of_side, of_end), F::U32::select(on_side, F::U32::splat(SIDE), end))
    }
}

impl Frustum {
    /// Each end is a centre and a radius. None if both centres are equal.
    pub fn new(bottom: (DVec3, f64), top: (DVec3, f64), capped: bool) -> Option<Self> {
        let span = top.0 - bottom.0;
        // Scaled first, so that the length does not underflow.
        let longest = span.abs().max_element();
        if longest == 0.0 {
            return None;
        }
        let axis = (span / longest).normalize();
        let taper = Taper {
            half: 0.5 * longest * (span / longest).length(),
            mean: 0.5 * bottom.1 + 0.5 * top.1,
            lean: 0.5 * top.1 - 0.5 * bottom.1,
        };
        let frame = Box::new(ShapeFrame::along(bottom.0 * 0.5 + top.0 * 0.5, axis));
        Some(Self { frame, taper, capped })
    }

    /// The centres and radii of both ends, and whether they are closed.
    pub fn ends(&self) -> ([(DVec3, f64); 2], bool) {
        let along = self.frame.axes.y_axis * self.taper.half;
        let end = |at: DVec3, part| (at, self.taper.end_radius(part));
        let (bottom, top) = (self.frame.origin - along, self.frame.origin + along);
        ([end(bottom, BOTTOM), end(top, TOP)], self.capped)
    }

    /// An open frustum has no hits at its ends.
    #[inline(always)]
    pub fn intersect<F: Real>(&self, ray: &LaneRay<F>, within: RayInterval<F>) -> LaneHit<F> {
        intersect(self, ray, within)
    }

    /// Points keep clear of the seams between side and ends, and of a cone's tip. The distance is the rounding of the
    /// ray that starts there plus `origin_error`. So a ray from the inside is inside all parts and leaves the solid
    /// once.
    #[inline(always)]
    pub fn surface<F: Real>(&self, ray: &LaneRay<F>, at: LaneHit<F>, origin_error: f64) -> LaneSurface<F> {
        surface(self, ray, at, origin_error)
    }

    /// The direction from the axis to the point where rays hit the side. Near a tip, the point may be closer to the
    /// axis than the rounding of its position. Then the direction of the ray decides, by whether the ray enters or
    /// leaves.
    #[inline(always)]
    fn turn<F: Real>(&self, ray: &LaneRay<F>, t: F, clearance: f64) -> [F; 2] {
        let off = ray.at(t);
        let way = ray.origin.length() + (ray.direction * t).length() + F::splat(self.taper.reach());
        // The point, the shift of Taper::crossings and the sum with it, two roundings each, and the root.
        let known = (way * F::splat(gamma(8))).max(F::splat(clearance)).lt(from_axis(off));
        let away = away_from_axis(off);
        if !(!known).any() {
            return away;
        }
        let crossings = self.taper.crossings(ray);
        let enters = crossings.meets & crossings.enter.eq(t);
        let [x, z] = away_from_axis(ray.direction);
        let (x, z) = (F::select(enters, -x, x), F::select(enters, -z, z));
        [F::select(known, away[0], x), F::select(known, away[1], z)]
    }

    /// The surface of the side next to `near`, in the direction `turn` from the axis. The point's position along the
    /// side runs from 0 at the narrow end to 2 at the wide one. It gives the coordinates in the plane of the axis. So
    /// the radius is exact to a few of its own roundings, however close the tip is.
    #[inline(always)]
    fn side<F: Real>(&self, near: Vec3<F>, [x, z]: [F; 2], clearance: f64) -> LaneSurface<F> {
        let Taper { half, mean, lean } = self.taper;
        let (grows, narrowest) = (lean.abs(), mean - lean.abs());
        let up = F::splat(if lean > 0.0 { -1.0 } else { 1.0 });
        let (length, radius) = (F::splat(half), F::splat(narrowest));
        let along = (from_axis(near) - radius) * F::splat(grows) + (length - up * near.y) * length;
        let (low, high) = self.clear_shares(clearance);
        let share = (along / F::splat(grows * grows + half * half)).max(F::splat(low)).min(F::splat(high));
        let share = share.max(F::splat(0.0)).min(F::splat(2.0));
        let radius = radius + F::splat(grows) * share;
        let normal = self.taper.normal();
        let (across, along) = (F::splat(normal.x), F::splat(normal.y));
        self.frame.surface(
            Vec3::new(x * radius, up * (length - length * share), z * radius),
            Vec3::new(x * across, along, z * across),
            self.error(),
        )
    }

    /// The positions along the side, from 0 to 2, that are clear of the ends and of the other side of a tip. At the
    /// wide end, side and end form a sharp angle; its sine is that between the side and the axis. Clearance across the
    /// end is therefore a longer distance along the side. At the narrow end, and at a blunt tip, the angle is obtuse:
    /// an offset from one part also leaves the other.
    fn clear_shares(&self, clearance: f64) -> (f64, f64) {
        let Taper { half, mean, lean } = self.taper;
        let narrow = clearance / libm::hypot(half, lean);
        let tip = (clearance - (mean - lean.abs())) / lean.abs();
        (if lean == 0.0 { narrow } else { narrow.max(tip) }, 2.0 - clearance / half)
    }

    #[inline(always)]
    fn end<F: Real>(&self, near: Vec3<F>, is_top: F::Mask, clearance: f64) -> LaneSurface<F> {
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        let [top, bottom] = self.clear_radii(clearance);
        let longest = F::select(is_top, F::splat(top), F::splat(bottom));
        let length = from_axis(near);
        let shorter = F::select(longest.lt(length), longest / length, one);
        let sign = F::select(is_top, one, -one);
        let point = Vec3::new(near.x * shorter, sign * F::splat(self.taper.half), near.z * shorter);
        self.frame.surface(point, Vec3::new(zero, sign, zero), self.error())
    }

    /// The largest distances from the axis at which points of the top and of the bottom are clear of the side.
    fn clear_radii(&self, clearance: f64) -> [f64; 2] {
        [(TOP, 1.0), (BOTTOM, -1.0)].map(|(part, sign)| {
            let is_wide = self.taper.lean * sign >= 0.0;
            let clearance = if is_wide { clearance / self.taper.normal().x } else { clearance };
            let radius = self.taper.end_radius(part);
            (radius - clearance).max(0.5 * radius)
        })
    }

    /// How far points keep from the axis at a tip, and from seams. A shape thinner than its rounding has no clear
    /// points; its points stay near their position.
    fn clearance(&self, origin_error: f64) -> f64 {
        let Taper { half, mean, lean } = self.taper;
        let clearance = self.frame.clearance(self.taper.reach(), self.error()) + origin_error;
        clearance.min(0.5 * (mean + lean.abs())).min(half)
    }

    /// The rounding of the point in the frame and of the next ray's test: the distance from the axis, the radius at
    /// that height, and the discriminant.
    fn error(&self) -> f64 {
        (self.taper.mean + self.taper.lean.abs()) * gamma(10) + self.taper.half * gamma(2)
    }

    /// The bounds of both end circles.
    pub fn bounds(&self) -> Aabb {
        let circle = self.frame.circle_reach();
        let end = |part: u32, sign: f64| {
            let center = self.frame.origin + self.frame.axes.y_axis * (sign * self.taper.half);
            Aabb { min: center, max: center }.padded(circle * self.taper.end_radius(part))
        };
        let rounding = self.frame.origin.abs() * gamma(2) + DVec3::splat(self.taper.reach() * gamma(8));
        end(BOTTOM, -1.0).union(end(TOP, 1.0)).padded(rounding)
    }

    pub fn support(&self, direction: DVec3) -> f64 {
        let (axis, circle) = (self.frame.axes.y_axis, circle_support(self.frame.axes.y_axis, direction));
        let end = |part: u32, sign: f64| {
            sign * self.taper.half * axis.dot(direction) + self.taper.end_radius(part) * circle
        };
        self.frame.origin.dot(direction) + max(end(BOTTOM, -1.0), end(TOP, 1.0))
    }

    /// A frustum stays one under rotation, mirroring and uniform scaling.
    pub fn transformed(&self, affine: &DAffine3) -> Option<Self> {
        let scale = even_scale(affine)?;
        let Taper { half, mean, lean } = self.taper;
        let taper = Taper { half: half * scale, mean: mean * scale, lean: lean * scale };
        Some(Self { frame: Box::new(self.frame.moved(affine)), taper, capped: self.capped })
    }

    /// On the side, the fractions of a turn and of the height. On an end, coordinates in its bounding square.
    #[inline(always)]
    pub fn uv<F: Real>(&self, point: Vec3<F>, part: F::U32) -> [F; 2] {
        let half = F::splat(0.5);
        let p = self.frame.local_point(point);
        let on_side = part.eq(F::U32::splat(SIDE));
        let is_top = part.eq(F::U32::splat(TOP));
        let along = half + half * p.y / F::splat(self.taper.half);
        let up = F::select(is_top, -p.z, p.z);
        let width = |part: u32| 2.0 * self.taper.end_radius(part);
        let width = F::select(is_top, F::splat(width(TOP)), F::splat(width(BOTTOM)));
        [F::select(on_side, around(p), half + p.x / width), F::select(on_side, along, half + up / width)]
    }

    /// The point and the normal of the side at texture coordinates: the inverse of [`Frustum::uv`].
    pub fn side_at_uv(&self, uv: DVec2) -> (DVec3, DVec3) {
        let (turn, normal) = (at_turn(uv.x), self.taper.normal());
        let end = |part| self.taper.end_radius(part);
        let radius = end(BOTTOM) * (1.0 - uv.y) + end(TOP) * uv.y;
        let point = DVec3::new(turn.x * radius, self.taper.half * (2.0 * uv.y - 1.0), turn.y * radius);
        self.frame.placed(point, DVec3::new(turn.x * normal.x, normal.y, turn.y * normal.x))
    }

    /// The unit vectors along u and v on an end, and its normal.
    pub fn end_axes(&self, end: End) -> ([DVec3; 2], DVec3) {
        let axes = self.frame.axes;
        match end {
            End::Bottom => ([axes.x_axis, axes.z_axis], -axes.y_axis),
            End::Top => ([axes.x_axis, -axes.z_axis], axes.y_axis),
        }
    }

    /// The side closes around the axis.
    pub fn uv_ends(&self, part: u32) -> [bool; 2] {
        [part != SIDE, true]
    }

    /// The areas of side, bottom and top.
    fn areas(&self) -> [f64; 3] {
        let side = 4.0 * PI * self.taper.mean * libm::hypot(self.taper.half, self.taper.lean);
        let end = |part| {
            let radius = self.taper.end_radius(part);
            if self.capped { PI * radius * radius } else { 0.0 }
        };
        [side, end(BOTTOM), end(TOP)]
    }

    pub fn area(&self) -> f64 {
        self.areas().iter().sum()
    }

    /// Selects a part by area, then a point of it.
    #[inline(always)]
    pub fn sample_area<F: Real>(&self, u: F, v: F) -> (LaneSurface<F>, F::U32) {
        sample_area(self, u, v)
    }

    /// The radius and height at a given fraction of the side's area. From the bottom, the area grows as the integral
    /// of the radius: a quadratic, solved without cancellation.
    #[inline(always)]
    fn side_sample<F: Real>(&self, share: F) -> (F, F) {
        let one = F::splat(1.0);
        let Taper { half, mean, lean } = self.taper;
        let (bottom, top) = (F::splat(mean - lean), F::splat(mean + lean));
        let radius = (bottom * bottom * (one - share) + top * top * share).sqrt();
        let height = F::splat(half) * (F::splat(4.0 * mean) * share / (bottom + radius) - one);
        (radius, height)
    }
}
