//! Tori.

use super::frame::{Frame, across, around, even_scale};
use super::{Crossing, Geometric, Parameters, Surface, chord::Chord};
use crate::camera::Ray;
use crate::digest::content;
use crate::math::{Aabb, DAffine3, DVec2, DVec3, UNIT_ROUNDOFF, gamma, root_between};
use crate::tree::Probe;
use std::f64::consts::{PI, TAU};

/// All points at distance `minor` from a circle of radius `major`; 0 < `minor` < `major`.
#[derive(Clone, Debug, PartialEq)]
pub struct Torus {
    /// At the centre, y along the axis. Boxed, so that a list of shapes is no larger for it.
    frame: Box<Frame>,
    pub(super) major: f64,
    pub(super) minor: f64,
}

content!(struct Torus { frame, major, minor });

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

    /// See `Chord`. Only where the ray is within the torus' bounding sphere and between the planes that
    /// touch it above and below are there any roots.
    fn hit_after(&self, probe: &Probe, after: f64, t_max: f64) -> Option<Crossing> {
        let ray = self.frame.local(&probe.ray);
        let t = Chord::new(self, &ray)?.first(&ray, after)?;
        (t > after && t < t_max).then_some(Crossing::at(t))
    }

    fn surface(&self, ray: &Ray, at: Crossing) -> Surface {
        let p = self.frame.local(ray).at(at.t);
        let turn = across(p).normalize_or(DVec2::X);
        let tube = DVec2::new(across(p).length() - self.major, p.y).normalize_or(DVec2::X);
        self.surface_at(turn, tube)
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
    fn uv(&self, point: DVec3, _: u32) -> DVec2 {
        let p = self.frame.local_point(point);
        let tube = libm::atan2(p.y, across(p).length() - self.major);
        DVec2::new(around(p), 0.5 + tube / TAU)
    }

    fn uv_ends(&self, _: u32) -> [bool; 2] {
        [false; 2]
    }

    fn area(&self) -> Option<f64> {
        Some(TAU * self.major * TAU * self.minor)
    }

    /// Evenly around the axis. Around the tube the area grows with the distance from the axis, so its
    /// integral φ + (minor/major)·sin φ is inverted.
    fn sample_area(&self, u: DVec2) -> Option<(Surface, u32)> {
        let (share, slim) = (TAU * (u.y - 0.5), self.minor / self.major);
        let area = |phi: f64| (phi + slim * libm::sin(phi) - share, 1.0 + slim * libm::cos(phi));
        let phi = root_between((-PI, PI), true, PI * UNIT_ROUNDOFF, area);
        let turn = |angle: f64| DVec2::new(libm::cos(angle), libm::sin(angle));
        Some((self.surface_at(turn(TAU * u.x), turn(phi)), 0))
    }
}

impl Torus {
    /// The torus around `center` whose circle lies across the unit vector `axis`; 0 < `minor` < `major`.
    pub fn new(center: DVec3, axis: DVec3, major: f64, minor: f64) -> Self {
        Self { frame: Box::new(Frame::along(center, axis)), major, minor }
    }

    /// The surface in the direction `turn` around the axis and `tube` around the tube, both unit vectors. The
    /// point is exact to a few roundings of the outer radius, and so is [`Torus::distance`] from there.
    fn surface_at(&self, turn: DVec2, tube: DVec2) -> Surface {
        let radius = self.major + self.minor * tube.x;
        let point = DVec3::new(turn.x * radius, self.minor * tube.y, turn.y * radius);
        let normal = DVec3::new(turn.x * tube.x, tube.y, turn.y * tube.x);
        self.frame.surface(point, normal, (self.major + self.minor) * gamma(8))
    }

    /// The distance of a point of the frame from the surface, below 0 within the tube. Its error is a few
    /// roundings of the point's coordinates and of the radii.
    pub(super) fn distance(&self, p: DVec3) -> f64 {
        DVec2::new(across(p).length() - self.major, p.y).length() - self.minor
    }

    /// [`Torus::distance`], and its slope in the direction `d`.
    pub(super) fn distance_along(&self, p: DVec3, d: DVec3) -> (f64, f64) {
        let from_axis = across(p).length();
        let tube = DVec2::new(from_axis - self.major, p.y);
        let length = tube.length();
        let outwards = across(p).dot(across(d)) / from_axis;
        (length - self.minor, tube.dot(DVec2::new(outwards, d.y)) / length)
    }
}
