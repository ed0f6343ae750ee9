//! Free keyframes.

use super::pose::{Aim, Pose};
use crate::base::math::DVec3;
use crate::base::time::Clock;
use crate::track::Animated;

/// Keys set the position and the aim of the camera. Absent values stay unchanged.
#[derive(Clone, Debug, PartialEq)]
pub struct Keys {
    pub aim: Aim,
    pub position: Option<Animated<DVec3>>,
}

impl Keys {
    pub fn apply(&self, pose: Pose, clock: &Clock) -> Pose {
        let pose = self.aim.apply(pose, clock);
        Pose { position: self.position.as_ref().map_or(pose.position, |p| p.at(clock.time)), ..pose }
    }
}
