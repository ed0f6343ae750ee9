//! The pose that steps of a path change.

use crate::base::math::{Angle, DVec3};
use crate::base::time::Clock;
use crate::camera::Projection;
use crate::track::Animated;

/// The target and orientation that a step sets. Absent values stay unchanged.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Aim {
    pub target: Option<Animated<DVec3>>,
    pub up: Option<Animated<DVec3>>,
    pub roll: Option<Animated<Angle>>,
}

/// The camera while the steps of its path are applied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    pub position: DVec3,
    pub target: DVec3,
    pub up: DVec3,
    pub roll: Angle,
    pub projection: Projection,
}

impl Aim {
    pub fn apply(&self, pose: Pose, clock: &Clock) -> Pose {
        Pose {
            target: self.target.as_ref().map_or(pose.target, |target| target.at(clock.time)),
            up: self.up.as_ref().map_or(pose.up, |up| up.at(clock.time)),
            roll: self.roll.as_ref().map_or(pose.roll, |roll| roll.at(clock.time)),
            ..pose
        }
    }
}
