//! Cameras that are fitted to objects: the distance that shows all of them is found, not given.

use super::pose::Pose;
use crate::base::math::DVec3;
use crate::camera::Projection;

/// What fills the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    pub objects: Framed,
    /// The share of the picture's shorter side that stays free on every side, from 0 to below 0.5.
    pub margin: f64,
    /// Where the camera stands. It depends on the whole timeline and the size of the picture, so it is found when a
    /// sequence is spawned.
    pub fit: Option<Fit>,
}

/// The objects that are framed.
#[derive(Clone, Debug, PartialEq)]
pub enum Framed {
    /// All objects with bounds.
    All,
    /// Objects by their indices, with their descendants.
    Listed(Vec<usize>),
}

/// The place of a camera, the same at all times, so that its picture does not grow and shrink.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The point in the centre of the picture.
    pub center: DVec3,
    /// The camera's distance from it, above 0.
    pub distance: f64,
    /// Half the height of the picture of an orthographic camera.
    pub half_height: Option<f64>,
}

impl Fit {
    /// Moves the camera along its direction. Without a direction it stays, and reports this later.
    pub fn apply(self, pose: Pose) -> Pose {
        let Some(away) = (pose.position - pose.target).try_normalize() else { return pose };
        let projection = match (pose.projection, self.half_height) {
            (Projection::Orthographic { .. }, Some(half_height)) => Projection::Orthographic { half_height },
            (projection, _) => projection,
        };
        Pose { position: self.center + away * self.distance, target: self.center, projection, ..pose }
    }
}
