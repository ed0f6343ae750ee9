//! Cylinders.

use super::{Crossing, Geometric, Parameters, Surface, frustum::Frustum};
use crate::camera::Ray;
use crate::math::{Aabb, DAffine3, DVec2, DVec3};
use crate::tree::Probe;

/// All points at a distance from the line between two points; with both ends closed, or open.
#[derive(Clone, Debug, PartialEq)]
pub struct Cylinder(Frustum);

impl Cylinder {
    /// `radius` is above 0; none if `from` is `to`.
    pub fn new(from: DVec3, to: DVec3, radius: f64, capped: bool) -> Option<Self> {
        Frustum::new((from, radius), (to, radius), capped).map(Self)
    }
}

impl Geometric for Cylinder {
    const NAME: &'static str = "Cylinder";

    fn read(parameters: &mut impl Parameters) -> Option<Self> {
        let from = parameters.vector("from", Some(DVec3::NEG_Y));
        let to = parameters.vector("to", Some(DVec3::Y));
        let radius = parameters.positive("radius", Some(1.0));
        let capped = parameters.switch("capped", Some(true));
        let cylinder = Self::new(from?, to?, radius?, capped?);
        if cylinder.is_none() {
            let label = "`from` and `to` are the same point".to_owned();
            parameters.refuse("to", "this cylinder has no length".to_owned(), label);
        }
        cylinder
    }

    fn hit(&self, probe: &Probe, t_max: f64) -> Option<Crossing> {
        self.0.hit(probe, t_max)
    }

    fn surface(&self, ray: &Ray, at: Crossing) -> Surface {
        self.0.surface(ray, at)
    }

    fn bounds(&self) -> Option<Aabb> {
        Some(self.0.bounds())
    }

    fn transformed(&self, affine: &DAffine3) -> Option<Self> {
        self.0.transformed(affine).map(Self)
    }

    /// On the side, u is the share of a turn, eastwards from the frame's -x and 0.5 at its +x, and v the share
    /// of the height above `from`. On an end, the square around it, whose middle is (0.5, 0.5) and which for
    /// an upright cylinder lies as on a disk that faces up or down.
    fn uv(&self, point: DVec3, part: u32) -> DVec2 {
        self.0.uv(point, part)
    }

    fn area(&self) -> Option<f64> {
        Some(self.0.area())
    }

    fn sample_area(&self, u: DVec2) -> Option<(Surface, u32)> {
        Some(self.0.sample_area(u))
    }
}
