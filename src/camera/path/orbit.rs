//! Circles around a target.

use super::pose::{Aim, Pose};
use crate::base::math::{Angle, DVec2, DVec3};
use crate::base::time::Clock;
use crate::track::{Animated, Ease};

/// A turn around the target. Absent values come from the pose before the orbit. Without any field, the camera turns
/// once around its target at its own distance and height.
#[derive(Clone, Debug, PartialEq)]
pub struct Orbit {
    pub aim: Aim,
    /// The axis of the orbit, not zero. Elevation is measured from the plane perpendicular to it.
    pub axis: DVec3,
    /// Distance from the target.
    pub radius: Option<Animated<f64>>,
    /// Angle above the plane of the orbit. Beyond 90 degrees the camera has passed the pole and is upside down.
    pub elevation: Option<Animated<Angle>>,
    /// Angle about the axis, from +z towards +x for an axis of +y.
    pub azimuth: Option<Animated<Angle>>,
    /// Whole or partial turns over the sequence's duration, on top of the azimuth.
    pub turns: f64,
    /// The progress of the turns over the duration.
    pub ease: Ease,
}

impl Orbit {
    pub fn apply(&self, pose: Pose, clock: &Clock) -> Pose {
        let pose = self.aim.apply(pose, clock);
        let frame = OrbitFrame::about(self.axis);
        let start = frame.to_local(pose.position - pose.target);
        let offset = self.placed(start, clock);
        let turned = self.turned(offset, clock);
        let up = match (&self.aim.up, &self.elevation) {
            (Some(_), _) => pose.up,
            // Up is the direction along the meridian in which the elevation grows, so the camera does not flip at the
            // pole.
            (None, Some(elevation)) => frame.to_world(
                self.turned(meridian(elevation.at(clock.time), self.direction(start, clock)).1, clock),
            ),
            (None, None) => pose.up,
        };
        Pose { position: pose.target + frame.to_world(turned), up, ..pose }
    }

    /// The offset from the target before the turns, in the frame of the orbit.
    fn placed(&self, start: DVec3, clock: &Clock) -> DVec3 {
        // An easing that overshoots must not move the camera through its target to the other side.
        let radius = self.radius.as_ref().map(|radius| radius.at(clock.time).max(0.0));
        if let Some(elevation) = &self.elevation {
            let (out, _) = meridian(elevation.at(clock.time), self.direction(start, clock));
            return out * radius.unwrap_or_else(|| start.length());
        }
        let mut offset = start;
        if self.azimuth.is_some() {
            let across = self.direction(start, clock) * DVec2::new(start.x, start.z).length();
            offset = DVec3::new(across.x, start.y, across.y);
        }
        match radius {
            Some(radius) if start.length() > 0.0 => offset * (radius / start.length()),
            Some(radius) => DVec3::Z * radius,
            None => offset,
        }
    }

    /// The unit direction (x, z) in the plane of the orbit before the turns.
    fn direction(&self, start: DVec3, clock: &Clock) -> DVec2 {
        if let Some(azimuth) = &self.azimuth {
            let c = azimuth.at(clock.time).cos_sin();
            return DVec2::new(c.y, c.x);
        }
        DVec2::new(start.x, start.z).try_normalize().unwrap_or(DVec2::Y)
    }

    /// Rotates `v` about the axis by the turns up to now. Equal phases give equal bits.
    fn turned(&self, v: DVec3, clock: &Clock) -> DVec3 {
        if self.turns == 0.0 {
            return v;
        }
        let phase = match self.ease {
            Ease::Linear => Angle::turns(self.turns, clock.progress()),
            ease => Angle(360.0 * self.turns * ease.apply(clock.progress().value())),
        };
        let c = phase.cos_sin();
        DVec3::new(v.x * c.x + v.z * c.y, v.y, v.z * c.x - v.x * c.y)
    }
}

/// The outward direction at an elevation above the direction `(x, z)` in the plane, and its derivative, which is up.
fn meridian(elevation: Angle, direction: DVec2) -> (DVec3, DVec3) {
    let e = elevation.cos_sin();
    let at = |across: f64, along: f64| DVec3::new(direction.x * across, along, direction.y * across);
    (at(e.x, e.y), at(-e.y, e.x))
}

/// The frame of the orbit: y along its axis, z as close as possible to the z axis of the world.
struct OrbitFrame {
    x: DVec3,
    y: DVec3,
    z: DVec3,
}

impl OrbitFrame {
    fn about(axis: DVec3) -> Self {
        let y = axis.normalize();
        let towards = if y.z.abs() < 1.0 { DVec3::Z } else { DVec3::X };
        let z = (towards - y * y.dot(towards)).normalize();
        Self { x: y.cross(z), y, z }
    }

    fn to_local(&self, v: DVec3) -> DVec3 {
        DVec3::new(self.x.dot(v), self.y.dot(v), self.z.dot(v))
    }

    fn to_world(&self, v: DVec3) -> DVec3 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::time::{Rate, Timeline};
    use crate::camera::Projection;
    use crate::camera::path::{CameraPath, Focus, Lens, Step};

    fn timeline(frames: u32) -> Timeline {
        Timeline::of_frames(frames, Rate::new(24, 1).expect("a rate"))
    }

    fn plain() -> Orbit {
        let aim = Aim::default();
        let ease = Ease::Linear;
        Orbit { aim, axis: DVec3::Y, radius: None, elevation: None, azimuth: None, turns: 0.0, ease }
    }

    fn camera(orbit: Orbit) -> CameraPath {
        CameraPath {
            position: DVec3::new(0.0, 100.0, 800.0).into(),
            target: DVec3::ZERO.into(),
            up: DVec3::Y.into(),
            roll: Angle(0.0).into(),
            lens: Lens::Perspective { fov: Angle(53.13).into() },
            aperture: 0.0.into(),
            focus: Focus::Target,
            shutter: 0.0.into(),
            frame: None,
            path: vec![Step::Orbit(orbit)],
        }
    }

    #[test]
    fn ca_01_a_turn_closes_bit_for_bit() {
        let path = camera(Orbit { turns: 3.0, ..plain() });
        let frames = timeline(360);
        for k in 0..=240 {
            assert_eq!(path.at(&frames.clock(k), None), path.at(&frames.clock(k + 120), None), "frame {k}");
        }
        let path = camera(Orbit { turns: -2.0, elevation: Some(Angle(20.0).into()), ..plain() });
        for k in 0..7 {
            assert_eq!(
                path.at(&timeline(14).clock(k), None),
                path.at(&timeline(14).clock(k + 7), None),
                "frame {k}"
            );
        }
    }

    #[test]
    fn a_turn_starts_where_the_camera_stands() {
        let path = camera(Orbit { turns: 1.0, ..plain() });
        let frames = timeline(72);
        assert_eq!(path.pose(&frames.clock(0)).position, DVec3::new(0.0, 100.0, 800.0));
        assert_eq!(path.pose(&frames.clock(18)).position, DVec3::new(800.0, 100.0, 0.0));
        assert_eq!(path.pose(&frames.clock(36)).position, DVec3::new(0.0, 100.0, -800.0));
    }

    #[test]
    fn ca_02_over_the_pole_without_a_flip() {
        let mut before: Option<DVec3> = None;
        for step in 0..=100 {
            let elevation = Angle(85.0 + 0.1 * f64::from(step));
            let radius = Some(10.0.into());
            let orbit = Orbit {
                radius,
                elevation: Some(elevation.into()),
                azimuth: Some(Angle(30.0).into()),
                ..plain()
            };
            let right = camera(orbit).at(&timeline(1).clock(0), None).expect("a camera").basis.right;
            if let Some(before) = before {
                assert!(before.angle_between(right).to_degrees() <= 1.0, "at {elevation:?}");
            }
            before = Some(right);
        }
    }

    #[test]
    fn elevation_and_azimuth_place_the_camera() {
        let orbit = Orbit {
            radius: Some(2.0.into()),
            elevation: Some(Angle(30.0).into()),
            azimuth: Some(Angle(90.0).into()),
            ..plain()
        };
        let pose = camera(orbit).pose(&timeline(1).clock(0));
        let expected = DVec3::new(2.0 * libm::cos(Angle(30.0).radians()), 1.0, 0.0);
        assert!((pose.position - expected).length() < 1e-14, "{pose:?}");
        assert!(matches!(pose.projection, Projection::Perspective { .. }));
    }

    #[test]
    fn about_another_axis() {
        let path = camera(Orbit { turns: 1.0, axis: DVec3::Z, ..plain() });
        let quarter = path.pose(&timeline(4).clock(1)).position;
        assert!((quarter - DVec3::new(-100.0, 0.0, 800.0)).length() < 1e-12, "{quarter}");
    }
}
