//! Tori.

use super::chord::Chord;
use super::frame::{Frame, around, away_from_axis, even_scale, from_axis};
use super::{Geometric, LaneHit, LaneSurface, Parameters, PreparedRay, Span};
use crate::base::digest::content;
use crate::base::lanes::{Mask, Real, Row, Vec3, out_of_line};
use crate::base::math::{
    Aabb, DAffine3, DVec3, Function, LaneRay, UNIT_ROUNDOFF, atan2, cos_sin_of_turns, gamma, root_between,
};
use std::f64::consts::TAU;

/// All points at distance `minor` from a circle of radius `major`; 0 < `minor` < `major`.
#[derive(Clone, Debug, PartialEq)]
pub struct Torus {
    /// At the centre, y along the axis. Boxed, so that a list of shapes is no larger for it.
    frame: Box<Frame>,
    pub(super) major: f64,
    pub(super) minor: f64,
}

content!(struct Torus { frame, major, minor });

out_of_line! {
    fn intersect<'k, F>(torus: &'k Torus, ray: &'k PreparedRay<F>, within: Span<F>) -> LaneHit<F> {
        let ray = torus.frame.local(&ray.ray);
        let (t, crosses) = Chord::new(torus, &ray).first(&ray, within.min);
        LaneHit::within(crosses, t, within)
    }
}

out_of_line! {
    fn surface<'k, F>(torus: &'k Torus, ray: &'k LaneRay<F>, at: LaneHit<F>) -> LaneSurface<F> {
        let p = torus.frame.local(ray).at(at.t);
        let [x, z] = away_from_axis(p);
        let tube = Vec3::new(from_axis(p) - F::splat(torus.major), F::splat(0.0), p.y);
        torus.surface_at([x, z], away_from_axis(tube))
    }
}

out_of_line! {
    fn sample_area<'k, F>(torus: &'k Torus, u: F, v: F) -> (LaneSurface<F>, F::U32) {
        let area = TubeArea { share: v, slim: torus.minor / torus.major };
        let (zero, one, all) = (F::splat(0.0), F::splat(1.0), F::Mask::splat(true));
        let turns = root_between((zero, one), all, F::splat(0.5 * UNIT_ROUNDOFF), all, &area);
        // The inner equator is half a turn from where the sine begins.
        let (cosine, sine) = cos_sin_of_turns(turns);
        let (x, z) = cos_sin_of_turns(u);
        (torus.surface_at([x, z], [-cosine, -sine]), F::U32::splat(0))
    }
}

impl Geometric for Torus {
    const NAME: &'static str = "Torus";

    fn read(parameters: &mut impl Parameters) -> Option<Self> {
        let center = parameters.vector("center", Some(DVec3::ZERO));
        let axis = parameters.unit_vector("axis", Some(DVec3::Y));
        let major = parameters.positive("major", Some(1.0));
        let minor = parameters.positive("minor", Some(0.25));
        let (major, minor) = (major?, minor?);
        if minor >= major {
            let title = "the tube of this torus fills its hole".to_owned();
            parameters.refuse("minor", title, format!("not below `major`, which is {major}"));
            return None;
        }
        Some(Self::new(center?, axis?, major, minor))
    }

    /// See `Chord`. Only where a ray is within the torus' bounding sphere and between the planes that
    /// touch it above and below are there any roots.
    #[inline(always)]
    fn intersect<F: Real>(&self, ray: &PreparedRay<F>, within: Span<F>) -> LaneHit<F> {
        intersect(self, ray, within)
    }

    #[inline(always)]
    fn surface<F: Real>(&self, ray: &LaneRay<F>, at: LaneHit<F>, _: f64) -> LaneSurface<F> {
        surface(self, ray, at)
    }

    /// Along each axis, the circle's own reach and the tube's.
    fn bounds(&self) -> Option<Aabb> {
        let reach = self.frame.circle_reach() * self.major + DVec3::splat(self.minor);
        let rounding = self.frame.origin.abs() * gamma(2) + reach * gamma(8);
        let center = self.frame.origin;
        Some(Aabb { min: center, max: center }.padded(reach + rounding))
    }

    /// A torus stays one under rotation, mirroring and even scaling.
    fn transformed(&self, affine: &DAffine3) -> Option<Self> {
        let scale = even_scale(affine)?;
        let frame = Box::new(self.frame.moved(affine));
        Some(Self { frame, major: self.major * scale, minor: self.minor * scale })
    }

    /// The share of a turn around the axis, eastwards from the frame's -x and 0.5 at its +x; and the one
    /// around the tube, from the inner equator by the bottom to the outer one at 0.5, and back by the top.
    #[inline(always)]
    fn uv<F: Real>(&self, point: Vec3<F>, _: F::U32) -> [F; 2] {
        let p = self.frame.local_point(point);
        let tube = atan2(p.y, from_axis(p) - F::splat(self.major));
        [around(p), F::splat(0.5) + tube / F::splat(TAU)]
    }

    fn uv_ends(&self, _: u32) -> [bool; 2] {
        [false; 2]
    }

    fn area(&self) -> Option<f64> {
        Some(TAU * self.major * TAU * self.minor)
    }

    /// Evenly around the axis. Around the tube the area grows with the distance from the axis, so its
    /// integral φ + (minor/major)·sin φ is inverted, in turns.
    #[inline(always)]
    fn sample_area<F: Real>(&self, u: F, v: F) -> (LaneSurface<F>, F::U32) {
        sample_area(self, u, v)
    }
}

/// The area of the tube from the inner equator by the bottom on, less a share of it, over turns.
struct TubeArea<F> {
    share: F,
    slim: f64,
}

impl<F: Real> Function<F> for TubeArea<F> {
    #[inline(always)]
    fn at(&self, turns: F) -> (F, F) {
        let (cosine, sine) = cos_sin_of_turns(turns);
        let slim = F::splat(self.slim);
        (turns - slim * sine / F::splat(TAU) - self.share, F::splat(1.0) - slim * cosine)
    }
}

impl Torus {
    /// The torus around `center` whose circle lies across the unit vector `axis`; 0 < `minor` < `major`.
    pub fn new(center: DVec3, axis: DVec3, major: f64, minor: f64) -> Self {
        Self { frame: Box::new(Frame::along(center, axis)), major, minor }
    }

    /// Its centre and the unit vector along its axis.
    pub fn center_and_axis(&self) -> (DVec3, DVec3) {
        (self.frame.origin, self.frame.axes.y_axis)
    }

    /// Radii of its circle and of its tube.
    pub fn radii(&self) -> (f64, f64) {
        (self.major, self.minor)
    }

    /// The surface in the direction `turn` around the axis and `tube` around the tube, both unit vectors. The
    /// point is exact to a few roundings of the outer radius, and so is [`Torus::distance`] from there.
    #[inline(always)]
    fn surface_at<F: Real>(&self, [x, z]: [F; 2], [out, up]: [F; 2]) -> LaneSurface<F> {
        let (major, minor) = (F::splat(self.major), F::splat(self.minor));
        let radius = major + minor * out;
        let point = Vec3::new(x * radius, minor * up, z * radius);
        let normal = Vec3::new(x * out, up, z * out);
        self.frame.surface(point, normal, (self.major + self.minor) * gamma(8))
    }

    /// The distance of points of the frame from the surface, below 0 within the tube. Its error is a few
    /// roundings of the point's coordinates and of the radii.
    #[inline(always)]
    pub(super) fn distance<F: Real>(&self, p: Vec3<F>) -> F {
        let off = from_axis(p) - F::splat(self.major);
        (off * off + p.y * p.y).sqrt() - F::splat(self.minor)
    }

    /// [`Torus::distance`], and its slope in the direction `d`.
    #[inline(always)]
    pub(super) fn distance_along<F: Real>(&self, p: Vec3<F>, d: Vec3<F>) -> (F, F) {
        let axis = from_axis(p);
        let off = axis - F::splat(self.major);
        let length = (off * off + p.y * p.y).sqrt();
        let outwards = (p.x * d.x + p.z * d.z) / axis;
        (length - F::splat(self.minor), (off * outwards + p.y * d.y) / length)
    }
}
