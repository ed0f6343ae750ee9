//! Spheres.

use super::frame::even_scale;
use super::surface::exit;
use super::{Crossing, Geometric, Parameters, Surface};
use crate::camera::Ray;
use crate::digest::content;
use crate::math::{Aabb, Angle, DAffine3, DVec2, DVec3, gamma};
use crate::sampling::{self, Frame};
use crate::tree::Probe;
use std::f64::consts::{PI, TAU};

/// Where maps of the sphere begin, in radians from -x towards -z: the mapping that planets have had in the
/// programs whose scenes Kinora took over, so that their pictures keep their places.
const SEAM: f64 = 0.5;

/// All points at distance `radius` (above 0) from `center`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    pub center: DVec3,
    pub radius: f64,
}

content!(struct Sphere { center, radius });

impl Geometric for Sphere {
    const NAME: &'static str = "Sphere";

    fn read(parameters: &mut impl Parameters) -> Option<Self> {
        let center = parameters.vector("center", Some(DVec3::ZERO));
        let radius = parameters.positive("radius", Some(1.0));
        Some(Self { center: center?, radius: radius? })
    }

    /// The quadratic without its cancellations. The discriminant is taken from the ray's point closest to
    /// the centre, r² - l² = (r - l)(r + l) (Haines et al., *Ray Tracing Gems*, chapter 7, factored), and
    /// the sign of c = (f - r)(f + r) says on which side of the surface the ray starts, which settles how
    /// many roots lie ahead before any is computed. From that point the closest one is found again, so that of the
    /// roundings of the way there only the last one is left.
    #[inline]
    fn hit_after(&self, probe: &Probe, after: f64, t_max: f64) -> Option<Crossing> {
        let d = probe.ray.direction;
        let from_center = probe.ray.origin - self.center;
        let distance = from_center.length();
        let outside = distance - self.radius;
        let (a, b) = (d.length_squared(), -from_center.dot(d));
        if outside >= 0.0 && b <= 0.0 {
            return None;
        }
        let inverse = 1.0 / a;
        let first = b * inverse;
        let near = from_center + d * first;
        let nearest = near.length();
        let square = (self.radius - nearest) * (self.radius + nearest);
        if square < 0.0 {
            return None;
        }
        let closest = first - near.dot(d) * inverse;
        let half_chord = (square * inverse).sqrt();
        let t = if outside >= 0.0 {
            let c = outside * (distance + self.radius) * inverse;
            let enter = self.entry(c, closest, half_chord, distance);
            if enter > 0.0 && enter <= after { exit(enter, closest + half_chord) } else { enter }
        } else if closest > 0.0 {
            closest + half_chord
        } else {
            -outside * (distance + self.radius) * inverse / (half_chord - closest)
        };
        (t > after && t < t_max).then_some(Crossing::at(t))
    }

    /// The direction from the centre is exact to a few roundings, and so is the point put at `radius` along
    /// it; the test of a ray from there rounds the distance from the centre once more.
    fn surface(&self, ray: &Ray, at: Crossing) -> Surface {
        self.surface_along((ray.at(at.t) - self.center).normalize_or(DVec3::Y))
    }

    fn bounds(&self) -> Option<Aabb> {
        let reach = DVec3::splat(self.radius);
        let rounding = (self.center.abs() + reach) * gamma(2);
        Some(Aabb { min: self.center - reach, max: self.center + reach }.padded(rounding))
    }

    /// A sphere stays one under rotation, mirroring and even scaling.
    fn transformed(&self, affine: &DAffine3) -> Option<Self> {
        let scale = even_scale(affine)?;
        Some(Self { center: affine.transform_point3(self.center), radius: self.radius * scale })
    }

    /// Longitude from west to east and latitude from -y (0) to +y (1). Both by atan2, whose error stays
    /// relative at the poles, where those of asin and acos do not. Maps begin `SEAM` off -x.
    fn uv(&self, point: DVec3, _: u32) -> DVec2 {
        let d = point - self.center;
        let longitude = (SEAM - libm::atan2(d.z, d.x) + PI) / TAU;
        let wrapped = longitude - longitude.floor();
        DVec2::new(if wrapped < 1.0 { wrapped } else { 0.0 }, libm::atan2(libm::hypot(d.x, d.z), -d.y) / PI)
    }

    fn uv_ends(&self, _: u32) -> [bool; 2] {
        [false, true]
    }

    fn area(&self) -> Option<f64> {
        Some(4.0 * PI * self.radius * self.radius)
    }

    fn sample_area(&self, u: DVec2) -> Option<(Surface, u32)> {
        let height = 1.0 - 2.0 * u.x;
        let turn = Angle(360.0 * u.y).cos_sin() * ((1.0 - height) * (1.0 + height)).max(0.0).sqrt();
        Some((self.surface_along(DVec3::new(turn.x, turn.y, height)), 0))
    }

    /// From outside, uniform over the cone that holds the sphere: every point drawn is seen (Pharr, Jakob,
    /// Humphreys, *Physically Based Rendering*, 6.2.4). From inside, uniform over the area.
    fn sample_from(&self, from: DVec3, frame: &Frame, u: DVec2) -> Option<(Surface, u32, f64)> {
        let Some(cone) = self.cone_from(from) else {
            let (surface, part) = self.sample_area(u)?;
            return Some((surface, part, surface.density_from(from, 1.0 / self.area()?)?));
        };
        let to_center = self.center - from;
        let distance = to_center.length();
        let frame = Frame::carried(frame.x, frame.z, to_center / distance);
        let direction = sampling::cone(cone, u);
        // The angle at the centre of the point that the direction meets, by the law of sines: its sine is
        // that of the angle at `from` times the near leg over the radius.
        let across = DVec2::new(direction.x, direction.y).length();
        let rest = (self.radius - distance * across).max(0.0) * (self.radius + distance * across);
        let near = distance * direction.z - rest.sqrt();
        let (sine, along) = (near * across / self.radius, (distance - near * direction.z) / self.radius);
        let turn = DVec2::new(direction.x, direction.y).normalize_or_zero() * sine;
        let normal = frame.to_world([turn.x, turn.y, -along]).normalize_or(-frame.z);
        Some((self.surface_along(normal), 0, sampling::cone_density(cone)))
    }

    /// Points of the far side, which the sphere itself hides, are never drawn from outside.
    fn density_from(&self, from: DVec3, at: &Surface) -> Option<f64> {
        match self.cone_from(from) {
            Some(cone) => {
                // The surface's own normal may have been turned to an eye inside.
                let near = (at.point - self.center).dot(from - at.point) >= 0.0;
                near.then(|| sampling::cone_density(cone))
            }
            None => at.density_from(from, 1.0 / self.area()?),
        }
    }
}

impl Sphere {
    /// 1 - the cosine of half the angle under which the sphere is seen; none from inside, or from so near that
    /// rounding decides on which side.
    fn cone_from(&self, from: DVec3) -> Option<f64> {
        let distance = (self.center - from).length();
        let rounding = (from.length() + self.center.length() + self.radius) * gamma(16);
        let sine = self.radius / distance;
        let outside = distance - self.radius > rounding;
        outside.then(|| sine * sine / (1.0 + ((1.0 - sine) * (1.0 + sine)).sqrt()))
    }

    /// The nearer root for an origin outside. Far away the difference of closest approach and half chord
    /// has the smaller absolute error; close to the surface, the quotient keeps the relative one.
    fn entry(&self, c: f64, closest: f64, half_chord: f64, distance: f64) -> f64 {
        if distance > 2.0 * self.radius { closest - half_chord } else { c / (closest + half_chord) }
    }

    /// The surface in the direction `normal` (a unit vector) from the centre. The point is exact to a few
    /// roundings; the test of a ray from there rounds the distance from the centre once more.
    pub fn surface_along(&self, normal: DVec3) -> Surface {
        let point = self.center + normal * self.radius;
        let error =
            point.abs() * gamma(2) + self.center.abs() * gamma(1) + DVec3::splat(self.radius * gamma(6));
        Surface::new(point, error, normal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::UNIT_ROUNDOFF;

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
            assert!((UNIT.uv(point, 0) - DVec2::from(uv)).length() <= UNIT_ROUNDOFF, "{point}");
        }
        assert_eq!((UNIT.uv(DVec3::Y, 0).y, UNIT.uv(DVec3::NEG_Y, 0).y), (1.0, 0.0));
    }

    #[test]
    fn sh_13_the_seam_and_the_poles() {
        for (height, radius) in [(0.0, 1.0), (3.0, 0.7), (100.0, 0.3)] {
            let sphere = Sphere { center: DVec3::Y * height, radius };
            for exponent in 2..=6 {
                let theta = libm::pow(10.0, f64::from(-exponent));
                let surface = |azimuth: f64| {
                    let (s, c) = (libm::sin(theta), libm::cos(theta));
                    sphere.surface_along(DVec3::new(s * libm::cos(azimuth), -c, s * libm::sin(azimuth)))
                };
                let [a, b] = [1e-7, -1e-7].map(|off| sphere.uv(surface(SEAM - PI + off).point, 0));
                // Of coordinates that the point has lost to its distance from the origin, nothing can be known.
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
