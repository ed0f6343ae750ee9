//! Planes that cut objects open, over time.

use crate::base::math::{DAffine3, DVec3, inverse};
use crate::base::time::Time;
use crate::geometry::shape::{Geometric, Plane};
use crate::track::Animated;

/// A plane in the space of the object that it cuts. It takes away what is in front of it, on the side of its normal.
#[derive(Clone, Debug, PartialEq)]
#[warn(missing_docs)]
pub struct ClipPlane {
    /// A point of the plane.
    pub point: Animated<DVec3>,
    /// Perpendicular to the plane, of any length but 0.
    pub normal: Animated<DVec3>,
}

#[warn(missing_docs)]
impl ClipPlane {
    /// Whether the plane may move.
    pub fn is_keyed(&self) -> bool {
        self.point.is_keyed() || self.normal.is_keyed()
    }

    /// The plane at a time. A keyed normal may pass through zero on its way to the opposite direction: then the plane has
    /// no direction, and cuts nothing.
    pub fn at(&self, time: Time) -> Option<Plane> {
        Some(Plane { point: self.point.at(time), normal: self.normal.at(time).try_normalize()? })
    }
}

/// The planes of an object in the space of one below it. None if that one is flat.
pub fn moved_into(planes: &[Plane], of: &DAffine3, below: &DAffine3) -> Option<Vec<Plane>> {
    let map = inverse(below)? * *of;
    Some(planes.iter().filter_map(|plane| plane.transformed(&map)).collect())
}
