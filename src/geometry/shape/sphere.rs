//! Spheres.

use super::frame::even_scale;
use super::{Geometric, LaneHit, LaneSurface, Parameters, PreparedRay, RayInterval, exit};
use crate::base::digest::Content;
use crate::base::lanes::{Mask, Real, Row, Select, Vec3};
use crate::base::math::{Aabb, Angle, DAffine3, DVec2, DVec3, LaneRay, atan2, gamma};
use crate::sampling::{self, FrameAxes, uniform_sphere};
use std::f64::consts::{PI, TAU};

/// Where texture maps of the sphere begin, in radians from -x towards -z. This keeps the images of scenes from earlier
/// programs in place.
const SEAM: f64 = 0.5;

/// All points at distance `radius` (above 0) from `center`.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
#[warn(missing_docs)]
pub struct Sphere {
    /// The centre.
    pub center: DVec3,
    /// The distance of the surface from the centre.
    pub radius: f64,
}

#[warn(missing_docs)]
impl Sphere {
    /// The point and the normal at texture coordinates: the inverse of [`Geometric::uv`].
    pub fn at_uv(&self, uv: DVec2) -> (DVec3, DVec3) {
        let (east, up) =
            (Angle((SEAM + PI - uv.x * TAU).to_degrees()).cos_sin(), Angle(180.0 * uv.y).cos_sin());
        let normal = DVec3::new(east.x * up.y, -up.x, east.y * up.y);
        (self.center + normal * self.radius, normal)
    }
}

impl Geometric for Sphere {
    const NAME: &'static str = "Sphere";

    fn read(parameters: &mut impl Parameters) -> Option<Self> {
        let center = parameters.vector("center", Some(DVec3::ZERO));
        let radius = parameters.positive("radius", Some(1.0));
        Some(Self { center: center?, radius: radius? })
    }

    /// The quadratic without cancellation. The discriminant r² - l² = (r - l)(r + l) is computed from the ray's point
    /// closest to the centre (Haines et al., *Ray Tracing Gems*, chapter 7, factored). The sign of c = (f - r)(f + r)
    /// gives the side on which the ray starts, and so the number of roots ahead. From the closest point, the closest
    /// point is computed again, so that only the last rounding of the distance remains.
    #[inline(always)]
    fn intersect<F: Real>(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> LaneHit<F> {
        SphereLanes::splat(self).intersect(ray, within)
    }

    #[inline(always)]
    fn surface<F: Real>(&self, ray: &LaneRay<F>, at: LaneHit<F>, _: f64) -> LaneSurface<F> {
        SphereLanes::splat(self).surface(ray, at.t)
    }

    #[inline]
    fn bounds(&self) -> Option<Aabb> {
        let reach = DVec3::splat(self.radius);
        let rounding = (self.center.abs() + reach) * gamma(2);
        Some(Aabb { min: self.center - reach, max: self.center + reach }.padded(rounding))
    }

    fn support(&self, direction: DVec3) -> Option<f64> {
        Some(self.center.dot(direction) + self.radius * direction.length())
    }

    /// A sphere stays one under rotation, mirroring and uniform scaling.
    fn transformed(&self, affine: &DAffine3) -> Option<Self> {
        let scale = even_scale(affine)?;
        Some(Self { center: affine.transform_point3(self.center), radius: self.radius * scale })
    }

    #[inline(always)]
    fn uv<F: Real>(&self, point: Vec3<F>, _: F::U32) -> [F; 2] {
        SphereLanes::splat(self).uv(point)
    }

    fn uv_ends(&self, _: u32) -> [bool; 2] {
        [false, true]
    }

    fn area(&self) -> Option<f64> {
        Some(4.0 * PI * self.radius * self.radius)
    }

    #[inline(always)]
    fn sample_area<F: Real>(&self, u: F, v: F) -> (LaneSurface<F>, F::U32) {
        (SphereLanes::splat(self).surface_along(uniform_sphere(u, v)), F::U32::splat(0))
    }

    #[inline(always)]
    fn sample_from<F: Real>(
        &self,
        from: Vec3<F>,
        eye: &FrameAxes<F>,
        u: F,
        v: F,
    ) -> (LaneSurface<F>, F::U32, F) {
        let (surface, pdf) = SphereLanes::splat(self).sample_from(from, eye, u, v);
        (surface, F::U32::splat(0), pdf)
    }

    #[inline(always)]
    fn pdf_from<F: Real>(&self, from: Vec3<F>, at: &LaneSurface<F>) -> F {
        SphereLanes::splat(self).pdf_from(from, at)
    }
}

/// A sphere in each lane.
#[derive(Clone, Copy, Debug)]
pub struct SphereLanes<F> {
    pub center: Vec3<F>,
    pub radius: F,
}

impl<F: Real> SphereLanes<F> {
    /// The same in all lanes.
    #[inline(always)]
    pub fn splat(sphere: &Sphere) -> Self {
        Self { center: Vec3::splat(sphere.center), radius: F::splat(sphere.radius) }
    }

    /// Longitude from west to east and latitude from -y (0) to +y (1). Both use atan2, whose error stays relative at
    /// the poles, unlike asin and acos. Maps begin at `SEAM` from -x.
    #[inline(always)]
    pub fn uv(&self, point: Vec3<F>) -> [F; 2] {
        let d = point - self.center;
        let longitude = (F::splat(SEAM) - atan2(d.z, d.x) + F::splat(PI)) / F::splat(TAU);
        let wrapped = longitude - longitude.floor();
        let level = (d.x * d.x + d.z * d.z).sqrt();
        let u = F::select(wrapped.lt(F::splat(1.0)), wrapped, F::splat(0.0));
        [u, atan2(level, -d.y) / F::splat(PI)]
    }

    /// [`Geometric::intersect`].
    #[inline(always)]
    pub fn intersect(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> LaneHit<F> {
        let (zero, radius) = (F::splat(0.0), self.radius);
        let PreparedRay { ray: LaneRay { origin, direction: d }, per_square, .. } = *ray;
        let from_center = origin - self.center;
        let b = -from_center.dot(d);
        let first = b * per_square;
        let near = from_center + d * first;
        // Most rays miss by far, which needs no root. This rejects no hit. If the root below is at most the radius,
        // its rounding leaves the square at most 2 u above the radius squared. The two products here lose another 2 u
        // (u is half of EPSILON); 4 EPSILON are twice their sum.
        let square = near.length_squared();
        if !square.le(radius * radius * F::splat(1.0 + 4.0 * f64::EPSILON)).any() {
            return LaneHit::none();
        }
        let distance = from_center.length();
        let outside = distance - radius;
        let is_outside = zero.le(outside);
        let nearest = square.sqrt();
        let square = (radius - nearest) * (radius + nearest);
        let is_hit = !((is_outside & b.le(zero)) | square.lt(zero));
        if !is_hit.any() {
            return LaneHit::none();
        }
        let closest = first - near.dot(d) * per_square;
        let half_chord = (square * per_square).sqrt();
        // The nearer root for an origin outside. Far away, closest approach minus half chord has the smaller absolute
        // error. Near the surface, the quotient has the smaller relative error.
        let c = outside * (distance + radius) * per_square;
        let afar = (F::splat(2.0) * radius).lt(distance);
        let entry = F::select(afar, closest - half_chord, c / (closest + half_chord));
        let beyond = exit(entry, closest + half_chord, within);
        let leave = F::select(zero.lt(closest), beyond, -c / (half_chord - closest));
        let enters = is_outside & within.min.lt(entry);
        LaneHit::within(is_hit, F::select(enters, entry, leave), within)
    }

    /// The direction from the centre is exact to a few roundings, and so is the point at `radius` along it. The test
    /// of a ray from there rounds the distance from the centre once more.
    #[inline(always)]
    pub fn surface(&self, ray: &LaneRay<F>, t: F) -> LaneSurface<F> {
        self.surface_along((ray.at(t) - self.center).normalize_or(Vec3::splat(DVec3::Y)))
    }

    /// The surface in the direction `normal` (a unit vector) from the centre. The point is exact to a few roundings.
    /// The test of a ray from there rounds the distance from the centre once more.
    #[inline(always)]
    pub fn surface_along(&self, normal: Vec3<F>) -> LaneSurface<F> {
        let point = self.center + normal * self.radius;
        let rounding = self.radius * F::splat(gamma(6));
        let error = point.abs() * F::splat(gamma(2))
            + self.center.abs() * F::splat(gamma(1))
            + Vec3::new(rounding, rounding, rounding);
        LaneSurface::new(point, error, normal)
    }

    /// From outside, uniform over the cone of directions to the sphere, so every sampled point is visible (Pharr,
    /// Jakob, Humphreys, *Physically Based Rendering*, 6.2.4). From inside, uniform over the area.
    #[inline(always)]
    pub fn sample_from(&self, from: Vec3<F>, eye: &FrameAxes<F>, u: F, v: F) -> (LaneSurface<F>, F) {
        let zero = F::splat(0.0);
        let (cone, is_outside) = self.cone_from(from);
        let to_center = self.center - from;
        let distance = to_center.length();
        let frame = eye.rotated_to(to_center / distance);
        let direction = sampling::cone(cone, u, v);
        // The angle at the centre, by the law of sines: its sine is that of the angle at `from` times the near leg
        // over the radius.
        let across = (direction.x * direction.x + direction.y * direction.y).sqrt();
        let rest = (self.radius - distance * across).max(zero) * (self.radius + distance * across);
        let near = distance * direction.z - rest.sqrt();
        let (sine, along) = (near * across / self.radius, (distance - near * direction.z) / self.radius);
        let per_across = F::select(zero.lt(across), sine / across, zero);
        let normal = Vec3::new(direction.x * per_across, direction.y * per_across, -along);
        let normal = frame.to_world(normal).normalize_or(-frame.z);
        let seen = (self.surface_along(normal), sampling::cone_pdf(cone));
        if !(!is_outside).any() {
            return seen;
        }
        let anywhere = self.surface_along(uniform_sphere(u, v));
        let pdf = anywhere.pdf_from(from, self.per_area());
        (LaneSurface::select(is_outside, seen.0, anywhere), F::select(is_outside, seen.1, pdf))
    }

    /// From outside, points of the far side have density 0, because the sphere itself hides them.
    #[inline(always)]
    pub fn pdf_from(&self, from: Vec3<F>, at: &LaneSurface<F>) -> F {
        let zero = F::splat(0.0);
        let (cone, is_outside) = self.cone_from(from);
        // Not by the surface's normal, which may have been flipped towards an eye inside.
        let is_near = zero.le((at.point - self.center).dot(from - at.point));
        let from_outside = F::select(is_near, sampling::cone_pdf(cone), zero);
        F::select(is_outside, from_outside, at.pdf_from(from, self.per_area()))
    }

    #[inline(always)]
    fn per_area(&self) -> F {
        F::splat(1.0) / (F::splat(4.0 * PI) * self.radius * self.radius)
    }

    /// 1 - cosine of half the angle that the sphere subtends, and whether `from` is certainly outside, despite
    /// rounding.
    #[inline(always)]
    fn cone_from(&self, from: Vec3<F>) -> (F, F::Mask) {
        let one = F::splat(1.0);
        let distance = (self.center - from).length();
        let rounding = (from.length() + self.center.length() + self.radius) * F::splat(gamma(16));
        let sine = self.radius / distance;
        let cosine = ((one - sine) * (one + sine)).max(F::splat(0.0)).sqrt();
        (sine * sine / (one + cosine), rounding.lt(distance - self.radius))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::{DVec2, UNIT_ROUNDOFF};
    use crate::geometry::shape::OneRay;

    const UNIT: Sphere = Sphere { center: DVec3::ZERO, radius: 1.0 };

    #[test]
    fn coordinates_run_eastwards_and_upwards() {
        let off = SEAM / TAU;
        for (point, uv) in [
            (DVec3::NEG_X, (off, 0.5)),
            (DVec3::Z, (0.25 + off, 0.5)),
            (DVec3::X, (0.5 + off, 0.5)),
            (DVec3::NEG_Z, (0.75 + off, 0.5)),
        ] {
            assert!((UNIT.uv_at(point, 0) - DVec2::from(uv)).length() <= UNIT_ROUNDOFF, "{point}");
        }
        assert_eq!((UNIT.uv_at(DVec3::Y, 0).y, UNIT.uv_at(DVec3::NEG_Y, 0).y), (1.0, 0.0));
    }

    #[test]
    fn sh_13_the_seam_and_the_poles() {
        for (height, radius) in [(0.0, 1.0), (3.0, 0.7), (100.0, 0.3)] {
            let sphere = Sphere { center: DVec3::Y * height, radius };
            for exponent in 2..=6 {
                let theta = libm::pow(10.0, f64::from(-exponent));
                let surface = |azimuth: f64| {
                    let (s, c) = (libm::sin(theta), libm::cos(theta));
                    let normal = DVec3::new(s * libm::cos(azimuth), -c, s * libm::sin(azimuth));
                    SphereLanes::<f64>::splat(&sphere).surface_along(normal.into())
                };
                let [a, b] = [1e-7, -1e-7].map(|off| sphere.uv_at(surface(SEAM - PI + off).point.into(), 0));
                // Coordinates that rounding of the point has lost, far from the origin, have no accuracy.
                let lost = 4.0 * UNIT_ROUNDOFF * (height + radius) / (radius * theta);
                assert!((a.y * PI / theta - 1.0).abs() <= 8.0 * UNIT_ROUNDOFF + lost);
                let jump = (b.x - a.x).abs();
                assert!((jump.min(1.0 - jump) - 1e-7 / PI).abs() <= 1e-12 + lost, "{jump:e}");
                assert!(a.x < 1.0 && b.x < 1.0);
            }
        }
    }

    #[test]
    fn moves_and_scales_but_not_to_ellipsoids() {
        let affine = DAffine3::from_axis_angle(DVec3::new(0.0, 0.6, 0.8), 1.0)
            * DAffine3::from_scale(DVec3::new(-2.0, 2.0, 2.0))
            * DAffine3::from_translation(DVec3::X);
        let moved = UNIT.transformed(&affine).expect("a sphere");
        assert!((moved.radius - 2.0).abs() < 1e-15);
        assert_eq!(UNIT.transformed(&DAffine3::from_scale(DVec3::new(1.0, 1.0, 1.001))), None);
    }
}
