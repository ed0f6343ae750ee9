//! Positions and orientations from a table.

use super::pose::Pose;
use crate::base::math::{DQuat, DVec3};
use crate::base::time::Clock;
use crate::track::Animated;

/// The camera's frame over time. The camera looks along its own -z, with its own y up, at a target at distance 1.
#[derive(Clone, Debug, PartialEq)]
pub struct PosePath {
    pub position: Animated<DVec3>,
    pub rotation: Animated<DQuat>,
}

impl PosePath {
    pub fn apply(&self, pose: Pose, clock: &Clock) -> Pose {
        let (position, rotation) = (self.position.at(clock.time), self.rotation.at(clock.time));
        Pose { position, target: position + rotation * DVec3::NEG_Z, up: rotation * DVec3::Y, ..pose }
    }
}
