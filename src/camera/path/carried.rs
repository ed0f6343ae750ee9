//! A camera that an object carries.

use super::pose::Pose;
use crate::base::math::{DAffine3, DVec3};
use crate::base::time::{Clock, Time};
use std::fmt::{Debug, Formatter};
use std::sync::Arc;

/// The camera is at the origin of an object and looks along the object's -z, with the object's y up.
#[derive(Clone)]
pub struct CarriedPath {
    /// The index of the object.
    pub object: usize,
    /// The map from the object to the world.
    place: Arc<dyn Fn(Time) -> DAffine3 + Send + Sync>,
}

impl CarriedPath {
    pub fn new(object: usize, place: impl Fn(Time) -> DAffine3 + Send + Sync + 'static) -> Self {
        Self { object, place: Arc::new(place) }
    }

    /// The target is at distance 1. Scales of the object have no effect.
    pub fn apply(&self, pose: Pose, clock: &Clock) -> Pose {
        let place = (self.place)(clock.time);
        let direction = |v: DVec3| (place.matrix3 * v).normalize_or_zero();
        let position = place.translation;
        Pose { position, target: position + direction(DVec3::NEG_Z), up: direction(DVec3::Y), ..pose }
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
