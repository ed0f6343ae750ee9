//! Zooms by equal factors in equal times, which look even.

use super::pose::{Aim, Pose};
use crate::base::math::DVec3;
use crate::base::time::Clock;
use crate::camera::Projection;
use crate::track::{Animated, LogScale};

/// A change of magnification or distance.
#[derive(Clone, Debug, PartialEq)]
pub struct Zoom {
    pub aim: Aim,
    pub by: ZoomBy,
}

/// What the zoom changes. All values are above zero and are interpolated by equal factors.
#[derive(Clone, Debug, PartialEq)]
pub enum ZoomBy {
    /// The tangent of half the vertical field of view. The camera becomes a perspective camera.
    HalfTangent(Animated<LogScale>),
    /// The magnification of the picture, in either projection.
    Factor(Animated<LogScale>),
    /// The distance from the target. The camera moves along the line to its target.
    Distance(Animated<LogScale>),
}

impl Zoom {
    pub fn apply(&self, pose: Pose, clock: &Clock) -> Pose {
        let mut pose = self.aim.apply(pose, clock);
        match &self.by {
            ZoomBy::HalfTangent(tangent) => {
                pose.projection = Projection::Perspective { half_height: tangent.at(clock.time).0 };
            }
            ZoomBy::Factor(factor) => match &mut pose.projection {
                Projection::Perspective { half_height } | Projection::Orthographic { half_height } => {
                    *half_height /= factor.at(clock.time).0;
                }
            },
            ZoomBy::Distance(distance) => {
                let away = (pose.position - pose.target).try_normalize().unwrap_or(DVec3::ZERO);
                pose.position = pose.target + away * distance.at(clock.time).0;
            }
        }
        pose
    }
}
