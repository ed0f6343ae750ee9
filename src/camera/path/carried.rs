//! A camera that an object carries.

use super::pose::Pose;
use crate::base::math::DAffine3;
use crate::base::time::{Clock, Time};
use std::fmt::{Debug, Formatter};
use std::sync::Arc;

/// The camera is at the origin of an object and looks along the object's -z, with the object's y up.
#[derive(Clone)]
pub struct CarriedPath {
    /// The index of the object.
    pub object: usize,
    /// The object's origin and its axes in the world: a rotation and a translation.
    place: Arc<dyn Fn(Time) -> DAffine3 + Send + Sync>,
}

impl CarriedPath {
    /// `place` gives a rotation and a translation.
    pub fn new(object: usize, place: impl Fn(Time) -> DAffine3 + Send + Sync + 'static) -> Self {
        Self { object, place: Arc::new(place) }
    }

    /// The target is at distance 1.
    pub fn apply(&self, pose: Pose, clock: &Clock) -> Pose {
        let place = (self.place)(clock.time);
        let position = place.translation;
        Pose { position, target: position - place.matrix3.z_axis, up: place.matrix3.y_axis, ..pose }
    }
}

/// Whether both are carried by the same function, not whether two functions have the same values.
impl PartialEq for CarriedPath {
    fn eq(&self, other: &Self) -> bool {
        self.object == other.object && Arc::ptr_eq(&self.place, &other.place)
    }
}

impl Debug for CarriedPath {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "CarriedPath({})", self.object)
    }
}
