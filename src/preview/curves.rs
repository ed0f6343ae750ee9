//! The animated values of a sequence as curves with keys, for the timeline.

use crate::appearance::light::LightKind;
use crate::base::color::Rgb;
use crate::base::math::{Angle, DVec3};
use crate::base::time::{Time, Timeline};
use crate::camera::path::{Lens, Step};
use crate::geometry::transform::Rotation;
use crate::sequence::Sequence;
use crate::track::{Animate, Animated};
use serde_json::{Value, json};

/// Most samples of a curve, most keys of a track, and most tracks.
const SAMPLES: u32 = 240;
const KEYS: usize = 500;
const TRACKS: usize = 400;

/// The numbers of a value that has a curve.
trait Plotted {
    fn numbers(&self) -> Vec<f64>;
}

impl Plotted for f64 {
    fn numbers(&self) -> Vec<f64> {
        vec![*self]
    }
}

impl Plotted for bool {
    fn numbers(&self) -> Vec<f64> {
        vec![f64::from(u8::from(*self))]
    }
}

impl Plotted for usize {
    fn numbers(&self) -> Vec<f64> {
        vec![*self as f64]
    }
}

impl Plotted for Angle {
    fn numbers(&self) -> Vec<f64> {
        vec![self.0]
    }
}

impl Plotted for DVec3 {
    fn numbers(&self) -> Vec<f64> {
        self.to_array().to_vec()
    }
}

impl Plotted for Rgb {
    fn numbers(&self) -> Vec<f64> {
        self.to_array().map(f64::from).to_vec()
    }
}

impl Plotted for glam::DQuat {
    fn numbers(&self) -> Vec<f64> {
        self.to_array().to_vec()
    }
}

/// Collects tracks.
struct Curves<'a> {
    timeline: &'a Timeline,
    tracks: Vec<Value>,
    /// Tracks beyond the limit.
    hidden: usize,
}

/// All keyed values: each with its name, the names that lead to it in the file, the times of its keys in seconds, and
/// its numbers over time.
pub fn curves(sequence: &Sequence) -> Value {
    let mut all = Curves { timeline: &sequence.timeline, tracks: Vec::new(), hidden: 0 };
    let several = sequence.cameras.len() > 1;
    all.add("active camera", &["camera"], &sequence.active_camera.active);
    for camera in &sequence.cameras {
        let name = camera.name.as_str();
        let label = if several { format!("camera {name}") } else { "camera".to_owned() };
        let names: &[&str] = if several { &["cameras", name] } else { &["camera"] };
        all.camera(&label, names, &camera.value);
    }
    for light in &sequence.lights {
        let (label, value) = (&light.name, &light.value);
        let names = |field: &'static str| ["lights", label.as_str(), field];
        value.on.parts().iter().for_each(|on| all.add(&format!("{label} · on"), &names("on"), on));
        all.add(&format!("{label} · intensity"), &names("intensity"), &value.intensity);
        all.add(&format!("{label} · color"), &names("color"), &value.color);
        match &value.kind {
            LightKind::Point { position, .. } | LightKind::Spot { position, .. } => {
                all.add(&format!("{label} · position"), &names("position"), position);
            }
            LightKind::Sphere { center, .. } => {
                all.add(&format!("{label} · center"), &names("center"), center);
            }
            LightKind::Directional { direction } => {
                all.add(&format!("{label} · direction"), &names("direction"), direction);
            }
            LightKind::Rectangle { .. } | LightKind::Carried { .. } => {}
        }
    }
    for object in &sequence.objects {
        let (label, value) = (&object.name, &object.value);
        let names = |field: &'static str| ["objects", label.as_str(), field];
        all.add(&format!("{label} · visible"), &names("visible"), &value.visible);
        all.add(&format!("{label} · translation"), &names("translation"), &value.transform.translation);
        for plane in &value.clip {
            all.add(&format!("{label} · clip point"), &names("clip"), &plane.point);
            all.add(&format!("{label} · clip normal"), &names("clip"), &plane.normal);
        }
        let rotation = format!("{label} · rotation");
        match &value.transform.rotation {
            Rotation::Quaternion(quaternion) => all.add(&rotation, &names("rotation"), quaternion),
            Rotation::AxisAngle { angle, .. } => all.add(&rotation, &names("rotation"), angle),
            Rotation::Euler { x, y, z } => {
                [x, y, z].into_iter().for_each(|angle| all.add(&rotation, &names("rotation"), angle));
            }
        }
        all.add(&format!("{label} · scale"), &names("scale"), &value.transform.scale);
    }
    all.add("ambient", &["ambient"], &sequence.ambient);
    all.add("exposure", &["output", "exposure"], &sequence.output.exposure);
    json!({ "tracks": all.tracks, "hidden": all.hidden })
}

impl Curves<'_> {
    fn camera(&mut self, label: &str, names: &[&str], camera: &crate::camera::path::CameraPath) {
        let path = |field: &'static str| [names, &[field]].concat();
        self.add(&format!("{label} · position"), &path("position"), &camera.position);
        self.add(&format!("{label} · target"), &path("target"), &camera.target);
        match &camera.lens {
            Lens::Perspective { fov } => self.add(&format!("{label} · fov"), &path("projection"), fov),
            Lens::Orthographic { height } => {
                self.add(&format!("{label} · height"), &path("projection"), height);
            }
        }
        self.add(&format!("{label} · aperture"), &path("aperture"), &camera.aperture);
        for step in &camera.path {
            match step {
                Step::Keys(keys) => {
                    if let Some(position) = &keys.position {
                        self.add(&format!("{label} · path position"), &path("path"), position);
                    }
                    if let Some(target) = &keys.aim.target {
                        self.add(&format!("{label} · path target"), &path("path"), target);
                    }
                }
                Step::Dolly(dolly) => {
                    self.add(&format!("{label} · forward"), &path("path"), &dolly.forward);
                    self.add(&format!("{label} · right"), &path("path"), &dolly.right);
                    self.add(&format!("{label} · upward"), &path("path"), &dolly.upward);
                }
                _ => {}
            }
        }
    }

    fn add<T: Animate + Plotted>(&mut self, label: &str, names: &[&str], value: &Animated<T>) {
        let Animated::Keyed(track) = value else { return };
        if self.tracks.len() >= TRACKS {
            self.hidden += 1;
            return;
        }
        let seconds = |time: Time| *time.numer() as f64 / *time.denom() as f64;
        let end = self.timeline.duration;
        let times: Vec<f64> =
            track.key_times([Time::from_integer(0), end], KEYS).into_iter().map(seconds).collect();
        let count = SAMPLES.min(self.timeline.frames.max(2));
        let at = |index: u32| end * Time::new(i128::from(index), i128::from(count));
        let samples: Vec<Vec<f64>> = (0..=count).map(|index| value.at(at(index)).numbers()).collect();
        let lines = samples.first().map_or(0, Vec::len);
        let line = |line: usize| -> Vec<f64> { samples.iter().map(|numbers| short(numbers[line])).collect() };
        let lines: Vec<Vec<f64>> = (0..lines).map(line).collect();
        self.tracks.push(json!({ "label": label, "names": names, "keys": times, "lines": lines }));
    }
}

/// A number with few digits, for plots.
fn short(value: f64) -> f64 {
    if value.is_finite() { f64::from(value as f32) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::parse;

    #[test]
    fn keyed_values_have_curves() {
        let text = r#"(
            timeline: (duration: 4, fps: 6),
            camera: (position: [(0, (0, 0, 5)), (4, (0, 0, 9))]),
            lights: { "a": Point(position: (1, 2, 3), on: [(0, true), (2, false)]) },
            objects: { "ball": (shape: Sphere(), translation: Track(keys: [(0, (0, 0, 0)), (1, (1, 0, 0))], repeat: Loop)) },
        )"#;
        let curves = curves(&parse("a.ron", text).expect("a sequence"));
        let tracks = curves["tracks"].as_array().expect("tracks");
        let labels: Vec<_> = tracks.iter().map(|track| track["label"].as_str().unwrap_or_default()).collect();
        assert_eq!(labels, ["camera · position", "a · on", "ball · translation"]);
        assert_eq!(tracks[1]["keys"], json!([0.0, 2.0]));
        assert_eq!(tracks[1]["names"], json!(["lights", "a", "on"]));
        assert_eq!(tracks[0]["lines"].as_array().map(Vec::len), Some(3));
        // Keys that repeat are repeated.
        assert_eq!(tracks[2]["keys"], json!([0.0, 1.0, 2.0, 3.0, 4.0]));
    }
}
