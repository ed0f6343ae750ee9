//! The inside of cylinders and cones around the y axis.

use super::{Crossing, frame::across};
use crate::camera::Ray;
use crate::digest::content;
use crate::math::{DVec2, DVec3, difference_of_products};

/// The parts of cylinders and cones.
pub const SIDE: u32 = 0;
pub const BOTTOM: u32 = 1;
pub const TOP: u32 = 2;

/// A radius that changes evenly along the y axis: `mean` at 0, `mean` + `lean` at `half`. It is not below 0
/// from -`half` to `half`; beyond that, on a cone, it may be: there the mirrored nappe begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taper {
    pub half: f64,
    pub mean: f64,
    pub lean: f64,
}

content!(struct Taper { half, mean, lean });

impl Taper {
    /// From the narrower end on: exactly `mean` for a cylinder, however far away `y` is, and to within a few
    /// roundings of itself for a cone, however close it is to the tip.
    #[inline]
    pub fn radius(&self, y: f64) -> f64 {
        let from_narrow = self.half + y.copysign(y * self.lean);
        (self.mean - self.lean.abs()) + from_narrow / self.half * self.lean.abs()
    }

    pub fn end_radius(&self, part: u32) -> f64 {
        self.radius(if part == TOP { self.half } else { -self.half })
    }

    /// A bound of the distance of any point from the middle.
    pub fn reach(&self) -> f64 {
        self.half + self.mean + self.lean.abs()
    }

    /// The unit normal of the side in the plane of the axis: (away from the axis, along it).
    pub fn normal(&self) -> DVec2 {
        DVec2::new(self.half, -self.lean) / libm::hypot(self.half, self.lean)
    }

    /// Where the line of a ray enters and leaves the closed solid. That is convex, within its radius and
    /// between its ends, so the line is inside it from the last entry to the first exit: at the seam of side
    /// and end no line finds a gap, or one crossing only.
    ///
    /// From far away, where no ray starts on or in the solid, the crossings are found from the point closest
    /// to the middle, or to the tip. The coefficients of their quadratic cancel for lines that run as the side
    /// does, the more so the farther away they are taken; and past a tip, the crossings come in their order
    /// only if the line is taken from there.
    pub fn crossings(&self, ray: &Ray) -> Option<[Crossing; 2]> {
        if ray.origin.length() <= self.reach() {
            return self.crossings_near(ray);
        }
        let tip = if self.lean.abs() == self.mean { self.half.copysign(-self.lean) } else { 0.0 };
        let from = ray.origin - DVec3::Y * tip;
        let shift = -from.dot(ray.direction) / ray.direction.length_squared();
        let near = Ray { origin: ray.at(shift), ..*ray };
        let crossings = self.crossings_near(&near)?;
        Some(crossings.map(|at| Crossing { t: at.t + shift, ..at }))
    }

    fn crossings_near(&self, ray: &Ray) -> Option<[Crossing; 2]> {
        let (enter, leave) = self.ends(ray)?;
        let (from, to) = self.within(ray)?;
        let enter = if from > enter.t { Crossing::at(from) } else { enter };
        let leave = if to < leave.t { Crossing::at(to) } else { leave };
        (enter.t <= leave.t).then_some([enter, leave])
    }

    /// Where a ray enters and leaves the slab between the ends. Each side of an end is the sign of a
    /// difference of two coordinates, so it is exact.
    fn ends(&self, ray: &Ray) -> Option<(Crossing, Crossing)> {
        let (y, dy, half) = (ray.origin.y, ray.direction.y, self.half);
        if dy == 0.0 {
            let between = y.abs() <= half;
            return between.then_some((Crossing::at(f64::NEG_INFINITY), Crossing::at(f64::INFINITY)));
        }
        let end = |end: f64, part: u32| {
            // The tip of a cone belongs to its side.
            let part = if self.radius(end) > 0.0 { part } else { SIDE };
            Crossing::of_part((end - y) / dy, part)
        };
        let (bottom, top) = (end(-half, BOTTOM), end(half, TOP));
        Some(if dy > 0.0 { (bottom, top) } else { (top, bottom) })
    }

    /// From which t to which a line is within the radius where that is not below 0.
    ///
    /// With o and d across the axis, and the radius r + g t along the line, the line is within where
    /// a t² + 2 b t + c <= 0 for a = d² - g², b = o·d - r g, c = o² - r². Both differences of squares are
    /// factored, and so is the discriminant where b² - a c would cancel: it is |g o - r d|² - (o × d)², by
    /// the identity of Lagrange for a scalar product of signature (+, +, -).
    #[inline]
    fn within(&self, ray: &Ray) -> Option<(f64, f64)> {
        let (o, d) = (across(ray.origin), across(ray.direction));
        let r = self.radius(ray.origin.y);
        let g = ray.direction.y / self.half * self.lean;
        let (distance, speed) = (o.length(), d.length());
        let a = (speed - g.abs()) * (speed + g.abs());
        let c = (distance - r.abs()) * (distance + r.abs());
        let b = o.dot(d) - r * g;
        // Steeper than the side and inside: |o·d| < |r g|, also where rounding hides it.
        let b = if a < 0.0 && c < 0.0 { -b.abs() * r.signum() * g.signum() } else { b };
        let discriminant = if a * c > 0.0 {
            let (w, k) = ((o * g - d * r).length(), difference_of_products(o.x, d.y, o.y, d.x).abs());
            (w - k) * (w + k)
        } else {
            b * b - a * c
        };
        // Flatter lines meet one nappe, if any: that of the radius at -b / a, in the middle between both roots.
        if a > 0.0 && (discriminant < 0.0 || r * a < g * b) {
            return None;
        }
        // Steeper lines always meet both nappes, or their tip.
        let root = discriminant.max(0.0).sqrt();
        interval((a, c), -(b + root.copysign(b)), g)
    }
}

/// The t at which a t² + 2 b t + c <= 0, of which `q` is -(b ± √(b² - a c)) without cancellation; of two
/// half-lines, the one along which the radius grows with `g`.
fn interval((a, c): (f64, f64), q: f64, g: f64) -> Option<(f64, f64)> {
    const ALL: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
    let first = if q == 0.0 { 0.0 } else { c / q };
    if a > 0.0 {
        let second = q / a;
        return Some((first.min(second), first.max(second)));
    }
    if a == 0.0 && (g == 0.0 || q == 0.0) {
        // Along the axis of a cylinder, or along the side itself: as far from it everywhere as at the start.
        return (c <= 0.0).then_some(ALL);
    }
    // Parallel to the side, it is met once.
    let second = if a == 0.0 { first } else { q / a };
    Some(if g > 0.0 { (first.max(second), ALL.1) } else { (ALL.0, first.min(second)) })
}
