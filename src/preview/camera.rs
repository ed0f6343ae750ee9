//! The camera of a session: moved by the mouse, and written as RON.

use crate::base::math::{Angle, DVec2, DVec3, UpAxis, axis_angle, look_at};
use crate::base::time::Clock;
use crate::camera::path::{CameraPath, Focus, Lens, Pose};
use crate::camera::{Camera, Projection};
use crate::track::Animated;

/// A camera that stands still.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewCamera {
    pose: Pose,
    /// Diameter of the lens, and the distance in focus if it is not that of the target.
    aperture: f64,
    focus: Option<f64>,
}

/// The nearest that an orbit comes to the poles, in radians.
const POLE: f64 = 0.01;

impl ViewCamera {
    /// The camera of a path at a moment.
    pub fn of(path: &CameraPath, clock: &Clock) -> Self {
        let focus = match &path.focus {
            Focus::Distance(distance) => Some(distance.at(clock.time)),
            Focus::Target | Focus::Object(_) => None,
        };
        Self { pose: path.pose(clock), aperture: path.aperture.at(clock.time), focus }
    }

    /// The same camera as a path, for annotations.
    pub fn path(&self) -> CameraPath {
        let Pose { position, target, up, roll, projection } = self.pose;
        let lens = match projection {
            Projection::Perspective { .. } => Lens::Perspective { fov: self.fov().into() },
            Projection::Orthographic { half_height } => {
                Lens::Orthographic { height: (2.0 * half_height).into() }
            }
        };
        CameraPath {
            position: position.into(),
            target: target.into(),
            up: up.into(),
            roll: roll.into(),
            lens,
            aperture: self.aperture.into(),
            focus: self.focus.map_or(Focus::Target, |focus| Focus::Distance(focus.into())),
            shutter: 0.0.into(),
            frame: None,
            path: Vec::new(),
        }
    }

    /// The camera for the tracer. None if it has no direction.
    pub fn camera(&self, clock: &Clock) -> Option<Camera> {
        self.path().at(clock, None).ok()
    }

    /// Turns around the target, in radians: to the right, and up. It stops before the poles.
    pub fn orbit(&mut self, by: DVec2) {
        let (up, from) = (self.pose.up.normalize_or(DVec3::Y), self.pose.position - self.pose.target);
        let from = axis_angle(up, Angle(-by.x.to_degrees())) * from;
        let distance = from.length();
        let height = libm::asin((from.dot(up) / distance).clamp(-1.0, 1.0));
        let limit = std::f64::consts::FRAC_PI_2 - POLE;
        let next = (height + by.y).clamp(-limit.max(height.abs()), limit.max(height.abs()));
        let flat = (from - up * from.dot(up)).normalize_or_zero();
        if distance > 0.0 && flat != DVec3::ZERO {
            let from = (flat * libm::cos(next) + up * libm::sin(next)) * distance;
            self.pose.position = self.pose.target + from;
        }
    }

    /// Moves sideways and up with its target, in heights of the picture at the target.
    pub fn pan(&mut self, by: DVec2) {
        let Some(basis) = look_at(self.pose.position, self.pose.target, self.pose.up) else { return };
        let height = match self.pose.projection {
            Projection::Perspective { half_height } => 2.0 * half_height * self.distance(),
            Projection::Orthographic { half_height } => 2.0 * half_height,
        };
        let by = (basis.right * by.x + basis.up * by.y) * height;
        self.pose.position += by;
        self.pose.target += by;
    }

    /// Moves with its target, in distances to it: forward, right and up.
    pub fn step(&mut self, forward: f64, right: f64, up: f64) {
        let Some(basis) = look_at(self.pose.position, self.pose.target, self.pose.up) else { return };
        let by = (basis.forward * forward + basis.right * right + basis.up * up) * self.distance();
        self.pose.position += by;
        self.pose.target += by;
    }

    /// Changes the distance to the target by a factor. Cameras without perspective change the height of the picture.
    pub fn dolly(&mut self, factor: f64) {
        match &mut self.pose.projection {
            Projection::Orthographic { half_height } => *half_height *= factor,
            Projection::Perspective { .. } => {
                let from = self.pose.position - self.pose.target;
                self.pose.position = self.pose.target + from * factor;
            }
        }
    }

    /// Changes the field of view: the height of the picture by a factor.
    pub fn zoom(&mut self, factor: f64) {
        match &mut self.pose.projection {
            Projection::Perspective { half_height } => *half_height = field_of_view(*half_height * factor),
            // A length in the world, which may have any size.
            Projection::Orthographic { half_height } => *half_height *= factor,
        }
    }

    /// Switches between perspective and parallel rays. The target keeps its size in the picture.
    pub fn switch_projection(&mut self) {
        let distance = self.distance();
        self.pose.projection = match self.pose.projection {
            Projection::Perspective { half_height } => {
                Projection::Orthographic { half_height: half_height * distance }
            }
            Projection::Orthographic { half_height } => {
                Projection::Perspective { half_height: field_of_view(half_height / distance) }
            }
        };
    }

    pub fn is_parallel(&self) -> bool {
        matches!(self.pose.projection, Projection::Orthographic { .. })
    }

    fn distance(&self) -> f64 {
        (self.pose.position - self.pose.target).length()
    }

    /// Vertical field of view.
    fn fov(&self) -> Angle {
        let (Projection::Perspective { half_height } | Projection::Orthographic { half_height }) =
            self.pose.projection;
        Angle((2.0 * libm::atan(half_height)).to_degrees())
    }

    /// The fields of the camera that say where it is and what it sees, by their names.
    pub fn fields(&self, axes: UpAxis) -> Vec<(&'static str, String)> {
        let Pose { position, target, up, roll, projection } = self.pose;
        let mut fields =
            vec![("position", vector(axes.from_y_up(position))), ("target", vector(axes.from_y_up(target)))];
        if up.normalize_or_zero() != DVec3::Y {
            fields.push(("up", vector(axes.from_y_up(up))));
        }
        if roll != Angle(0.0) {
            fields.push(("roll", number(roll.0)));
        }
        fields.push((
            "projection",
            match projection {
                Projection::Perspective { .. } => format!("Perspective(fov: {})", number(self.fov().0)),
                Projection::Orthographic { half_height } => {
                    format!("Orthographic(height: {})", number(2.0 * half_height))
                }
            },
        ));
        fields
    }

    /// `camera: (...)` as text of a sequence file.
    pub fn ron(&self, axes: UpAxis) -> String {
        let fields: Vec<String> =
            self.fields(axes).into_iter().map(|(name, value)| format!("{name}: {value}")).collect();
        format!("camera: ({}),", fields.join(", "))
    }

    /// A step of a camera path with keys at a time.
    pub fn key(&self, axes: UpAxis, time: &str) -> String {
        let Pose { position, target, .. } = self.pose;
        let [position, target] = [position, target].map(|point| vector(axes.from_y_up(point)));
        format!("position: [({time}, {position})], target: [({time}, {target})],")
    }

    /// Whether a path gives just its fields, so that writing them is enough.
    pub fn may_replace(path: &CameraPath) -> Result<(), &'static str> {
        let keyed = path.position.is_keyed() || path.target.is_keyed() || path.up.is_keyed();
        let lens = match &path.lens {
            Lens::Perspective { fov } => matches!(fov, Animated::Keyed(_)),
            Lens::Orthographic { height } => matches!(height, Animated::Keyed(_)),
        };
        match () {
            () if !path.path.is_empty() => {
                Err("the camera follows a path; copy the text and place it by hand")
            }
            () if path.frame.is_some() => Err("the camera is fitted to objects by `frame`"),
            () if keyed || lens || path.roll.is_keyed() => {
                Err("the camera has keys; copy a key and place it by hand")
            }
            () => Ok(()),
        }
    }
}

/// The half height of a perspective picture at distance 1, between fields of view of 0.01 and 175 degrees.
fn field_of_view(half_height: f64) -> f64 {
    half_height.clamp(1e-4, 22.9)
}

fn vector(v: DVec3) -> String {
    format!("({}, {}, {})", number(v.x), number(v.y), number(v.z))
}

/// A number with six digits, without trailing zeros.
pub fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return "0".to_owned();
    }
    let exponent = libm::floor(libm::log10(value.abs())) as i32;
    if !(-9..=15).contains(&exponent) {
        return format!("{value:e}");
    }
    let decimals = (5 - exponent).clamp(0, 15) as usize;
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::parse;

    fn camera(text: &str) -> (ViewCamera, Clock) {
        let sequence = parse("a.ron", &format!("(camera: ({text}))")).expect("a sequence");
        let clock = sequence.timeline.clock(0);
        (ViewCamera::of(&sequence.cameras[0].value, &clock), clock)
    }

    #[test]
    fn numbers_are_short() {
        let all = [0.0, 1.0, -2.5, 0.1, 1234.5678, 1e-7, 45.000_000_000_1, 12_345_678.0, -1e-20];
        let texts = ["0", "1", "-2.5", "0.1", "1234.57", "0.0000001", "45", "12345678", "-1e-20"];
        assert_eq!(all.map(number), texts);
    }

    #[test]
    fn the_text_of_a_camera_is_read_back() {
        let (mut view, clock) = camera("position: (0, 2.4, 6), target: (0.2, 0.7, 0)");
        view.orbit(DVec2::new(0.3, -0.1));
        view.pan(DVec2::new(0.1, 0.2));
        view.dolly(0.8);
        view.zoom(1.1);
        for _ in 0..2 {
            let text = view.ron(UpAxis::Y);
            let sequence = parse("a.ron", &format!("({text})")).expect("a camera");
            let (read, given) = (sequence.cameras[0].value.at(&clock, None), view.camera(&clock));
            let (read, given) = (read.expect("a camera"), given.expect("a camera"));
            assert!((read.position - given.position).length() < 1e-4, "{text}");
            assert!((read.basis.forward - given.basis.forward).length() < 1e-4, "{text}");
            view.switch_projection();
        }
    }

    #[test]
    fn orbits_keep_the_distance_and_stop_at_the_poles() {
        let (mut view, clock) = camera("position: (0, 0, 5)");
        for _ in 0..100 {
            view.orbit(DVec2::new(0.1, 0.1));
            assert!((view.distance() - 5.0).abs() < 1e-9);
            assert!(view.camera(&clock).is_some());
        }
        // A quarter turn to the right and back.
        let (mut view, _) = camera("position: (0, 0, 5)");
        view.orbit(DVec2::new(std::f64::consts::FRAC_PI_2, 0.0));
        assert!(
            (view.pose.position - DVec3::new(-5.0, 0.0, 0.0)).length() < 1e-9,
            "{:?}",
            view.pose.position
        );
    }

    #[test]
    fn parallel_pictures_zoom_at_any_size() {
        let (mut view, _) = camera("position: (0, 0, 900), projection: Orthographic(height: 800)");
        view.zoom(1.5);
        assert!(view.fields(UpAxis::Y).contains(&("projection", "Orthographic(height: 1200)".to_owned())));
        view.switch_projection();
        view.zoom(1e9);
        assert!(view.is_parallel() || view.fov().0 < 175.1, "{:?}", view.fov());
    }

    #[test]
    fn projections_keep_the_size_of_the_target() {
        let (mut view, clock) = camera("position: (0, 0, 5), target: (0, 0, 0)");
        let size = |view: &ViewCamera| {
            let camera = view.camera(&clock).expect("a camera");
            camera.project(DVec3::Y).screen().expect("in front").y
        };
        let before = size(&view);
        view.switch_projection();
        assert!(view.is_parallel() && (size(&view) - before).abs() < 1e-12);
        view.switch_projection();
        assert!((size(&view) - before).abs() < 1e-12);
    }
}
