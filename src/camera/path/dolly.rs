//! Moves along the axes of the camera.

use super::pose::{Aim, Pose};
use crate::base::math::look_at;
use crate::base::time::Clock;
use crate::track::Animated;

/// The camera and its target move along the axes of the camera, so its direction stays the same. Distances are in
/// world units.
#[derive(Clone, Debug, PartialEq)]
pub struct Dolly {
    pub aim: Aim,
    pub forward: Animated<f64>,
    pub right: Animated<f64>,
    pub upward: Animated<f64>,
}

impl Dolly {
    pub fn apply(&self, pose: Pose, clock: &Clock) -> Pose {
        let pose = self.aim.apply(pose, clock);
        // Without a direction there are no axes. The camera reports this error later.
        let Some(basis) = look_at(pose.position, pose.target, pose.up) else { return pose };
        let by = basis.forward * self.forward.at(clock.time)
            + basis.right * self.right.at(clock.time)
            + basis.up * self.upward.at(clock.time);
        Pose { position: pose.position + by, target: pose.target + by, ..pose }
    }
}
