//! Cylinders.

use super::{
    Geometric, LaneHit, LaneSurface, Parameters, PreparedRay, RayInterval, cone::forward_to_frustum,
    frustum::Frustum,
};
use crate::base::digest::Content;
use crate::base::lanes::{Real, Vec3};
use crate::base::math::{Aabb, DAffine3, DVec3, LaneRay};

/// All points at a distance from a segment, with both ends closed or open.
#[derive(Clone, Debug, PartialEq, Content)]
pub struct Cylinder(Frustum);

impl Cylinder {
    /// `radius` must be above 0. None if `from` equals `to`.
    pub fn new(from: DVec3, to: DVec3, radius: f64, capped: bool) -> Option<Self> {
        Frustum::new((from, radius), (to, radius), capped).map(Self)
    }

    /// The solid, which cones and cylinders share.
    pub fn frustum(&self) -> &Frustum {
        &self.0
    }

    /// The centres and radii of both ends, and whether they are closed.
    pub fn ends(&self) -> ([(DVec3, f64); 2], bool) {
        self.0.ends()
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

    forward_to_frustum!();
}
