//! Tori.

use super::frame::{ShapeFrame, around, at_turn, away_from_axis, circle_support, even_scale, from_axis};
use super::torus_interval::{TorusInterval, TorusRadii};
use super::{Geometric, LaneHit, LaneSurface, Parameters, PreparedRay, RayInterval};
use crate::base::digest::Content;
use crate::base::lanes::{Mask, Real, Row, Vec3, out_of_line};
use crate::base::math::{
    Aabb, Angle, DAffine3, DVec2, DVec3, Function, LaneRay, UNIT_ROUNDOFF, atan2, cos_sin_of_turns, gamma,
    root_between,
};
use std::f64::consts::TAU;

/// All points at distance `minor` from a circle of radius `major`; 0 < `minor` < `major`.
#[derive(Clone, Debug, PartialEq, Content)]
pub struct Torus {
    /// At the centre, y along the axis. Boxed, to keep lists of shapes small.
    frame: Box<ShapeFrame>,
    radii: TorusRadii,
}

out_of_line! {
    fn intersect<'k, F>(torus: &'k Torus, ray: &'k PreparedRay<F>, within: RayInterval<F>) -> LaneHit<F> {
        let ray = torus.frame.local(&ray.ray);
        let (t, crosses) = TorusInterval::new(torus.radii, &ray).first(&ray, within.min);
        LaneHit::within(crosses, t, within)
    }
}

out_of_line! {
    fn surface<'k, F>(torus: &'k Torus, ray: &'k LaneRay<F>, at: LaneHit<F>) -> LaneSurface<F> {
        let p = torus.frame.local(ray).at(at.t);
        let [x, z] = away_from_axis(p);
        let tube = Vec3::new(from_axis(p) - F::splat(torus.radii.major), F::splat(0.0), p.y);
        torus.surface_at([x, z], away_from_axis(tube))
    }
}

out_of_line! {
    fn sample_area<'k, F>(torus: &'k Torus, u: F, v: F) -> (LaneSurface<F>, F::U32) {
        let area = TubeArea { share: v, slim: torus.radii.minor / torus.radii.major };
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

    /// See `TorusInterval`. Rays have roots only inside the bounding sphere of the torus and between the planes that
    /// touch it above and below.
    #[inline(always)]
    fn intersect<F: Real>(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> LaneHit<F> {
        intersect(self, ray, within)
    }

    #[inline(always)]
    fn surface<F: Real>(&self, ray: &LaneRay<F>, at: LaneHit<F>, _: f64) -> LaneSurface<F> {
        surface(self, ray, at)
    }

    /// The sum of the circle's and the tube's extents along each axis.
    fn bounds(&self) -> Option<Aabb> {
        let reach = self.frame.circle_reach() * self.radii.major + DVec3::splat(self.radii.minor);
        let rounding = self.frame.origin.abs() * gamma(2) + reach * gamma(8);
        let center = self.frame.origin;
        Some(Aabb { min: center, max: center }.padded(reach + rounding))
    }

    fn support(&self, direction: DVec3) -> Option<f64> {
        let circle = circle_support(self.frame.axes.y_axis, direction);
        let tube = self.radii.major * circle + self.radii.minor * direction.length();
        Some(self.frame.origin.dot(direction) + tube)
    }

    /// A torus stays one under rotation, mirroring and uniform scaling.
    fn transformed(&self, affine: &DAffine3) -> Option<Self> {
        let scale = even_scale(affine)?;
        let frame = Box::new(self.frame.moved(affine));
        let radii = TorusRadii { major: self.radii.major * scale, minor: self.radii.minor * scale };
        Some(Self { frame, radii })
    }

    /// The fraction of a turn around the axis, eastwards from the frame's -x, with 0.5 at its +x. The fraction of a
    /// turn around the tube, from the inner equator past the bottom to the outer one at 0.5, and back past the top.
    #[inline(always)]
    fn uv<F: Real>(&self, point: Vec3<F>, _: F::U32) -> [F; 2] {
        let p = self.frame.local_point(point);
        let tube = atan2(p.y, from_axis(p) - F::splat(self.radii.major));
        [around(p), F::splat(0.5) + tube / F::splat(TAU)]
    }

    fn uv_ends(&self, _: u32) -> [bool; 2] {
        [false; 2]
    }

    fn area(&self) -> Option<f64> {
        Some(TAU * self.radii.major * TAU * self.radii.minor)
    }

    /// Uniform around the axis. Around the tube, the area grows with the distance from the axis. So its integral φ +
    /// (minor/major)·sin φ is inverted, in turns.
    #[inline(always)]
    fn sample_area<F: Real>(&self, u: F, v: F) -> (LaneSurface<F>, F::U32) {
        sample_area(self, u, v)
    }
}

/// The area of the tube from the inner equator past the bottom, minus the given share, as a function of turns.
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
    /// The torus around `center`. Its circle is perpendicular to the unit vector `axis`; 0 < `minor` < `major`.
    pub fn new(center: DVec3, axis: DVec3, major: f64, minor: f64) -> Self {
        Self { frame: Box::new(ShapeFrame::along(center, axis)), radii: TorusRadii { major, minor } }
    }

    /// The centre and the unit vector along the axis.
    pub fn center_and_axis(&self) -> (DVec3, DVec3) {
        (self.frame.origin, self.frame.axes.y_axis)
    }

    /// The point and the normal at texture coordinates: the inverse of [`Geometric::uv`].
    pub fn at_uv(&self, uv: DVec2) -> (DVec3, DVec3) {
        let (turn, tube) = (at_turn(uv.x), Angle(360.0 * uv.y - 180.0).cos_sin());
        let normal = DVec3::new(turn.x * tube.x, tube.y, turn.y * tube.x);
        let circle = DVec3::new(turn.x, 0.0, turn.y) * self.radii.major;
        self.frame.placed(circle + normal * self.radii.minor, normal)
    }

    /// The radii of the circle and of the tube.
    pub fn radii(&self) -> (f64, f64) {
        (self.radii.major, self.radii.minor)
    }

    /// The surface in the direction `turn` around the axis and `tube` around the tube, both unit vectors. The point is
    /// exact to a few roundings of the outer radius, and so is [`TorusRadii::distance`] there.
    #[inline(always)]
    fn surface_at<F: Real>(&self, [x, z]: [F; 2], [out, up]: [F; 2]) -> LaneSurface<F> {
        let (major, minor) = (F::splat(self.radii.major), F::splat(self.radii.minor));
        let radius = major + minor * out;
        let point = Vec3::new(x * radius, minor * up, z * radius);
        let normal = Vec3::new(x * out, up, z * out);
        self.frame.surface(point, normal, (self.radii.major + self.radii.minor) * gamma(8))
    }
}
