//! Camera paths: from tracks to a camera at each moment.
//!
//! A path starts from the keyed pose of the camera and applies its steps in order, each to the pose from the step
//! before. An orbit and then a zoom give an orbit that zooms.

mod carried;
mod dolly;
mod frame;
mod keys;
mod orbit;
mod pose;
mod poses;
mod shutter;
mod spline;
mod zoom;

pub use carried::CarriedPath;
pub use dolly::Dolly;
pub use frame::{Fit, Frame, Framed};
pub use keys::Keys;
pub use orbit::Orbit;
pub use pose::{Aim, Pose};
pub use poses::PosePath;
pub use shutter::moments;
pub use spline::SplinePath;
pub use zoom::{Zoom, ZoomBy};

use crate::base::math::{Angle, DVec3, look_at};
use crate::base::time::Clock;
use crate::camera::{Camera, Projection, ThinLens};
use crate::track::Animated;
use bevy_ecs::component::Component;

/// Everything about one camera over time.
#[derive(Clone, Component, Debug, PartialEq)]
#[warn(missing_docs)]
pub struct CameraPath {
    /// Where the camera is, before the steps of the path.
    pub position: Animated<DVec3>,
    /// The point at which it looks.
    pub target: Animated<DVec3>,
    /// The direction that is up in the picture.
    pub up: Animated<DVec3>,
    /// Turns the picture about the line of sight.
    pub roll: Animated<Angle>,
    /// The projection.
    pub lens: Lens,
    /// Diameter of the lens in world units; 0 is a pinhole.
    pub aperture: Animated<f64>,
    /// What is in focus, if the lens is open.
    pub focus: Focus,
    /// How long the shutter is open, as a share of the time between two frames.
    pub shutter: Animated<f64>,
    /// What fills the picture, if the camera is fitted to something. Then `position` and `target` give only the
    /// direction from which the camera looks.
    pub frame: Option<Frame>,
    /// Steps that move it, in their order.
    pub path: Vec<Step>,
}

/// The projection over time.
#[derive(Clone, Debug, PartialEq)]
pub enum Lens {
    /// Vertical field of view, above 0 and below 180 degrees.
    Perspective { fov: Animated<Angle> },
    /// Height of the picture in world units, above 0.
    Orthographic { height: Animated<f64> },
}

/// The distance that is in focus.
#[derive(Clone, Debug, PartialEq)]
pub enum Focus {
    /// The distance of the camera's target.
    Target,
    /// This distance along the line of sight.
    Distance(Animated<f64>),
    /// The distance of the centre of the object with this index.
    Object(usize),
}

/// One step of a path.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    Orbit(Orbit),
    Zoom(Zoom),
    Dolly(Dolly),
    Keys(Keys),
    Spline(SplinePath),
    Poses(PosePath),
    Carried(CarriedPath),
}

/// Why a moment has no camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoCamera {
    /// Position and target coincide.
    EyeOnTarget,
    /// A field of view outside 0..180 degrees or a picture without height.
    Lens,
    /// A coordinate is not finite.
    NotFinite,
}

impl std::fmt::Display for NoCamera {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::EyeOnTarget => "its position and its target are the same point",
            Self::Lens => "its field of view is not between 0 and 180 degrees, or its height is not above 0",
            Self::NotFinite => "its position or its target is not finite",
        })
    }
}

impl Lens {
    fn at(&self, clock: &Clock) -> Projection {
        match self {
            Self::Perspective { fov } => {
                Projection::Perspective { half_height: fov.at(clock.time).half_tangent() }
            }
            Self::Orthographic { height } => {
                Projection::Orthographic { half_height: height.at(clock.time) * 0.5 }
            }
        }
    }
}

impl Step {
    fn apply(&self, pose: Pose, clock: &Clock) -> Pose {
        match self {
            Self::Orbit(orbit) => orbit.apply(pose, clock),
            Self::Zoom(zoom) => zoom.apply(pose, clock),
            Self::Dolly(dolly) => dolly.apply(pose, clock),
            Self::Keys(keys) => keys.apply(pose, clock),
            Self::Spline(spline) => spline.apply(pose, clock),
            Self::Poses(poses) => poses.apply(pose, clock),
            Self::Carried(carried) => carried.apply(pose, clock),
        }
    }
}

#[warn(missing_docs)]
impl CameraPath {
    /// The pose before the path.
    fn start(&self, clock: &Clock) -> Pose {
        Pose {
            position: self.position.at(clock.time),
            target: self.target.at(clock.time),
            up: self.up.at(clock.time),
            roll: self.roll.at(clock.time),
            projection: self.lens.at(clock),
        }
    }

    /// The pose after every step of the path.
    pub fn pose(&self, clock: &Clock) -> Pose {
        let start = self.start(clock);
        let start = self.frame.as_ref().and_then(|frame| frame.fit).map_or(start, |fit| fit.apply(start));
        self.path.iter().fold(start, |pose, step| step.apply(pose, clock))
    }

    /// The direction, orientation and projection for which the camera is fitted: before steps of the path zoom or move
    /// away.
    pub fn framed_pose(&self, clock: &Clock) -> Pose {
        self.path.iter().fold(self.start(clock), |pose, step| match step {
            Step::Orbit(orbit) => orbit.apply(pose, clock),
            Step::Zoom(Zoom { aim, .. }) | Step::Dolly(Dolly { aim, .. }) => aim.apply(pose, clock),
            Step::Keys(keys) => keys.apply(pose, clock),
            Step::Spline(spline) => spline.apply(pose, clock),
            Step::Poses(poses) => poses.apply(pose, clock),
            Step::Carried(carried) => carried.apply(pose, clock),
        })
    }

    /// Whether all moments are equal.
    pub fn is_still(&self) -> bool {
        let Self { position, target, up, roll, lens, path, .. } = self;
        let lens = match lens {
            Lens::Perspective { fov } => fov.is_keyed(),
            Lens::Orthographic { height } => height.is_keyed(),
        };
        let keyed = position.is_keyed() || target.is_keyed() || up.is_keyed() || roll.is_keyed() || lens;
        !keyed && path.is_empty()
    }

    /// The index of the object in focus, if the camera focuses on one.
    pub fn focus_object(&self) -> Option<usize> {
        if let Focus::Object(index) = self.focus { Some(index) } else { None }
    }

    /// The camera at a moment. `sharp` is the centre of [`CameraPath::focus_object`].
    pub fn at(&self, clock: &Clock, sharp: Option<DVec3>) -> Result<Camera, NoCamera> {
        let pose = self.pose(clock);
        let half_height = match pose.projection {
            Projection::Perspective { half_height } | Projection::Orthographic { half_height } => half_height,
        };
        if !(half_height > 0.0 && half_height.is_finite()) {
            return Err(NoCamera::Lens);
        }
        if !(pose.position.is_finite() && pose.target.is_finite()) {
            return Err(NoCamera::NotFinite);
        }
        let basis = look_at(pose.position, pose.target, pose.up).ok_or(NoCamera::EyeOnTarget)?;
        // A roll of zero must not change any bit.
        let basis = if pose.roll == Angle(0.0) { basis } else { basis.rolled(pose.roll.cos_sin()) };
        let lens = self.thin_lens(&pose, basis.forward, clock, sharp);
        Ok(Camera { position: pose.position, basis, projection: pose.projection, lens })
    }

    /// The lens, unless it is a pinhole. If the focus is not in front of the camera, the target is in focus.
    fn thin_lens(
        &self,
        pose: &Pose,
        forward: DVec3,
        clock: &Clock,
        sharp: Option<DVec3>,
    ) -> Option<ThinLens> {
        let radius = 0.5 * self.aperture.at(clock.time);
        let focus = match &self.focus {
            Focus::Target => None,
            Focus::Distance(distance) => Some(distance.at(clock.time)),
            Focus::Object(_) => sharp.map(|point| (point - pose.position).dot(forward)),
        };
        let to_target = (pose.target - pose.position).length();
        let focus = focus.filter(|distance| *distance > 0.0).unwrap_or(to_target);
        (radius > 0.0).then_some(ThinLens { radius, focus })
    }
}
