//! What cylinders and cones have in common: a straight side around an axis, and two flat ends across it.

use super::frame::{Frame, across, around, even_scale};
use super::surface::exit;
use super::taper::{BOTTOM, SIDE, TOP, Taper};
use super::{Crossing, Surface};
use crate::camera::Ray;
use crate::digest::content;
use crate::math::{Aabb, Angle, DAffine3, DVec2, DVec3, gamma};
use crate::tree::Probe;
use std::f64::consts::PI;

/// The surface around an axis whose radius changes evenly from the bottom to the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Frustum {
    /// At the middle of the axis. Boxed, so that a list of shapes is no larger for it.
    frame: Box<Frame>,
    taper: Taper,
    /// Whether the ends are closed.
    capped: bool,
}

content!(struct Frustum { frame, taper, capped });

impl Frustum {
    /// From `bottom` to `top`, each a centre and a radius; none if the axis between them has no length.
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
        let frame = Box::new(Frame::along(bottom.0 * 0.5 + top.0 * 0.5, axis));
        Some(Self { frame, taper, capped })
    }

    /// Of an open one, the crossings of its ends are not seen.
    pub fn hit_after(&self, probe: &Probe, after: f64, t_max: f64) -> Option<Crossing> {
        let [enter, leave] = self.taper.crossings(&self.frame.local(&probe.ray))?;
        let leave = Crossing { t: exit(enter.t, leave.t), ..leave };
        let seen = |at: &Crossing| at.t > after && at.t < t_max && (self.capped || at.part == SIDE);
        [enter, leave].into_iter().find(seen)
    }

    /// Points stay clear of the seams between side and ends, and of a cone's tip, by as much as rounding may
    /// move the ray that starts there, and by `apart`: from within, it is within all parts, so it leaves the solid
    /// once.
    pub fn surface(&self, ray: &Ray, at: Crossing, apart: f64) -> Surface {
        let ray = self.frame.local(ray);
        let near = ray.at(at.t);
        let clearance = self.clearance(apart);
        match at.part {
            SIDE => self.side(near, self.turn(&ray, at.t, clearance), clearance),
            part => self.end(near, part, clearance),
        }
    }

    /// The direction away from the axis in which a ray meets the side. At a tip, the point may be closer to the
    /// axis than points of the side may be, or than the rounding of the way there; then that the ray enters or
    /// leaves there tells the direction.
    fn turn(&self, ray: &Ray, t: f64, clearance: f64) -> DVec2 {
        let off = across(ray.at(t));
        let way = ray.origin.length() + (ray.direction * t).length() + self.taper.reach();
        // The point, the shift of Taper::crossings and the sum with it, two roundings each, and the root.
        if off.length() > (way * gamma(8)).max(clearance) {
            return off.normalize();
        }
        let enters = self.taper.crossings(ray).is_some_and(|[enter, _]| enter.t == t);
        let along = across(ray.direction).normalize_or(DVec2::X);
        if enters { -along } else { along }
    }

    /// The surface of the side next to `near`, in the direction `turn` from the axis. The point's share of the way from the
    /// narrow end of the side to the wide one, which is 2, gives its coordinates in the plane of the axis: the radius to a
    /// few roundings of itself, however close to a tip it is.
    fn side(&self, near: DVec3, turn: DVec2, clearance: f64) -> Surface {
        let Taper { half, mean, lean } = self.taper;
        let (grows, narrowest) = (lean.abs(), mean - lean.abs());
        let up = if lean > 0.0 { -1.0 } else { 1.0 };
        let along = (across(near).length() - narrowest) * grows + (half - up * near.y) * half;
        let (low, high) = self.clear_shares(clearance);
        let share = (along / (grows * grows + half * half)).max(low).min(high).clamp(0.0, 2.0);
        let radial = turn * (narrowest + grows * share);
        let normal = self.taper.normal();
        self.frame.surface(
            DVec3::new(radial.x, up * (half - half * share), radial.y),
            DVec3::new(turn.x * normal.x, normal.y, turn.y * normal.x),
            self.error(),
        )
    }

    /// Between which shares of the way from the narrow end to the wide one points of the side are clear of the ends, and of
    /// a tip's other side. At the wide end, the side and the end enclose a sharp angle, whose sine is that of the side to
    /// the axis: clear across the end is farther along the side. At the narrow end, and at a tip that is less steep, the
    /// angle is a wide one, and what moves a ray off one part moves it off the other as well.
    fn clear_shares(&self, clearance: f64) -> (f64, f64) {
        let Taper { half, mean, lean } = self.taper;
        let narrow = clearance / libm::hypot(half, lean);
        let tip = (clearance - (mean - lean.abs())) / lean.abs();
        (if lean == 0.0 { narrow } else { narrow.max(tip) }, 2.0 - clearance / half)
    }

    fn end(&self, near: DVec3, part: u32, clearance: f64) -> Surface {
        let sign = if part == TOP { 1.0 } else { -1.0 };
        let is_wide = self.taper.lean * sign >= 0.0;
        let clearance = if is_wide { clearance / self.taper.normal().x } else { clearance };
        let radius = self.taper.end_radius(part);
        let radial = across(near).clamp_length_max((radius - clearance).max(0.5 * radius));
        let point = DVec3::new(radial.x, sign * self.taper.half, radial.y);
        self.frame.surface(point, DVec3::Y * sign, self.error())
    }

    /// How far points stay from the axis at a tip, and from seams across the parts that meet there. Shapes flatter than
    /// their rounding have no such points; theirs stay near where they are.
    fn clearance(&self, apart: f64) -> f64 {
        let Taper { half, mean, lean } = self.taper;
        let clearance = self.frame.clearance(self.taper.reach(), self.error()) + apart;
        clearance.min(0.5 * (mean + lean.abs())).min(half)
    }

    /// The rounding of the point within the frame and of the test of a ray from there: its distance from the
    /// axis, the radius at its height, and the discriminant.
    fn error(&self) -> f64 {
        (self.taper.mean + self.taper.lean.abs()) * gamma(10) + self.taper.half * gamma(2)
    }

    /// Both ends' circles.
    pub fn bounds(&self) -> Aabb {
        let circle = self.frame.circle_reach();
        let end = |part: u32, sign: f64| {
            let center = self.frame.origin + self.frame.axes.y_axis * (sign * self.taper.half);
            Aabb { min: center, max: center }.padded(circle * self.taper.end_radius(part))
        };
        let rounding = self.frame.origin.abs() * gamma(2) + DVec3::splat(self.taper.reach() * gamma(8));
        end(BOTTOM, -1.0).union(end(TOP, 1.0)).padded(rounding)
    }

    /// Stays what it is under rotation, mirroring and even scaling.
    pub fn transformed(&self, affine: &DAffine3) -> Option<Self> {
        let scale = even_scale(affine)?;
        let Taper { half, mean, lean } = self.taper;
        let taper = Taper { half: half * scale, mean: mean * scale, lean: lean * scale };
        Some(Self { frame: Box::new(self.frame.moved(affine)), taper, capped: self.capped })
    }

    /// On the side, the share of a turn and of the height; on an end, the square around it.
    pub fn uv(&self, point: DVec3, part: u32) -> DVec2 {
        let p = self.frame.local_point(point);
        if part == SIDE {
            return DVec2::new(around(p), 0.5 + 0.5 * p.y / self.taper.half);
        }
        let up = if part == TOP { -p.z } else { p.z };
        DVec2::splat(0.5) + DVec2::new(p.x, up) / (2.0 * self.taper.end_radius(part))
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

    /// A part by its area, then a point of it.
    pub fn sample_area(&self, u: DVec2) -> (Surface, u32) {
        let mut rest = u.x * self.area();
        let areas = self.areas();
        let mut part = SIDE;
        while part < TOP && rest >= areas[part as usize] && areas[part as usize + 1] > 0.0 {
            rest -= areas[part as usize];
            part += 1;
        }
        let share = (rest / areas[part as usize]).min(1.0);
        let turn = Angle(360.0 * u.y).cos_sin();
        if part == SIDE {
            let (radius, y) = self.side_sample(share);
            return (self.side(DVec3::new(radius, y, 0.0), turn, self.clearance(0.0)), part);
        }
        let radial = turn * (self.taper.end_radius(part) * share.sqrt());
        (self.end(DVec3::new(radial.x, 0.0, radial.y), part, self.clearance(0.0)), part)
    }

    /// The radius and height above which lies a given share of the side's area. From the bottom it grows as
    /// the integral of the radius: a quadratic, solved without cancellation.
    fn side_sample(&self, share: f64) -> (f64, f64) {
        let Taper { half, mean, lean } = self.taper;
        let (bottom, top) = (mean - lean, mean + lean);
        let radius = (bottom * bottom * (1.0 - share) + top * top * share).sqrt();
        (radius, half * (4.0 * mean * share / (bottom + radius) - 1.0))
    }
}
