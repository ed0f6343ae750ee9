//! Cameras: closed orbits, orbits over the pole, views almost along the up vector, and very small rotations.

use super::input_rng::InputRng;
use super::measure::{Case, Verdict, Workload, method};
use super::number::{Float, Vector3};
use crate::base::math::{Angle, DQuat, DVec3, look_at, slerp};
use crate::base::time::{Rate, Timeline};
use crate::camera::path::{Aim, CameraPath, Focus, Lens, Orbit, Step};
use crate::track::Ease;
use std::f64::consts::TAU;
use std::rc::Rc;

/// Frames per turn, and turns of the orbit.
const TURN: u32 = 120;
const TURNS: u32 = 100;

/// A camera on an orbit of radius 10 around the origin.
pub fn orbit(orbit: Orbit) -> CameraPath {
    CameraPath {
        position: DVec3::new(0.0, 0.0, 10.0).into(),
        target: DVec3::ZERO.into(),
        up: DVec3::Y.into(),
        roll: Angle(0.0).into(),
        lens: Lens::Perspective { fov: Angle(45.0).into() },
        aperture: 0.0.into(),
        focus: Focus::Target,
        shutter: 0.0.into(),
        frame: None,
        path: vec![Step::Orbit(orbit)],
    }
}

fn around(turns: f64, elevation: Option<f64>) -> Orbit {
    let elevation = elevation.map(|degrees| Angle(degrees).into());
    let azimuth = elevation.is_some().then(|| Angle(0.0).into());
    let (aim, ease) = (Aim::default(), Ease::Linear);
    Orbit { aim, axis: DVec3::Y, radius: Some(10.0.into()), elevation, azimuth, turns, ease }
}

fn closing() -> Case {
    type Frame = (u32, Rc<(CameraPath, Timeline)>);
    let path = orbit(around(TURNS.into(), None));
    let timeline = Timeline::of_frames(TURN * TURNS, Rate::default());
    let shared = Rc::new((path, timeline));
    // The last turn.
    let frames: Vec<Frame> = (TURN * (TURNS - 1)..TURN * TURNS).map(|k| (k, Rc::clone(&shared))).collect();
    fn place<R: Float>(k: u32) -> [f64; 2] {
        let angle = R::of(TAU) * R::of(k.into()) / R::of(TURN.into());
        [(R::of(10.0) * angle.sin()).wide(), (R::of(10.0) * angle.cos()).wide()]
    }
    fn textbook<R: Float>(frame: &Frame) -> [[f64; 2]; 2] {
        [place::<R>(frame.0), place::<R>(frame.0 % TURN)]
    }
    fn stable(frame: &Frame) -> [[f64; 2]; 2] {
        [place::<f32>(frame.0 % TURN), place::<f32>(frame.0 % TURN)]
    }
    fn ours((frame, shared): &Frame) -> [[f64; 2]; 2] {
        [*frame, frame % TURN].map(|k| {
            let position = shared.0.pose(&shared.1.clock(k)).position;
            [position.x, position.z]
        })
    }
    fn judge(_: &Frame, [late, early]: [[f64; 2]; 2]) -> Verdict {
        let off = libm::hypot(late[0] - early[0], late[1] - early[1]);
        Verdict { off: Some(off), wrong: late != early }
    }
    Case {
        id: "CA-01",
        what: "camera on an orbit of radius 10 and 120 frames, after 99 turns (two frames a call)",
        error: "largest distance from its place in the first turn",
        wrong: "frames that differ from those of the first turn",
        methods: [
            method(frames.clone(), textbook::<f32>, judge),
            method(frames.clone(), textbook::<f64>, judge),
            method(frames.clone(), stable, judge),
            method(frames, ours, judge),
        ],
    }
}

/// The elevations of two frames, and Kinora's cameras there.
#[derive(Clone)]
struct PoleStep {
    elevations: [f64; 2],
    ours: [Rc<CameraPath>; 2],
    timeline: Timeline,
}

/// The right vector of a camera at an elevation, with +y as up.
pub fn fixed_up<R: Float>(elevation: f64) -> Vector3<R> {
    let angle = R::of(elevation) * R::of(TAU / 360.0);
    let forward = Vector3([R::zero(), -angle.sin(), -angle.cos()]);
    forward.cross(Vector3([R::zero(), R::one(), R::zero()])).unit()
}

/// The right vector with the derivative of the position by the elevation as up.
fn growing_up(elevation: f64) -> Vector3<f32> {
    let angle = (elevation * (TAU / 360.0)) as f32;
    let (sine, cosine) = (libm::sinf(angle), libm::cosf(angle));
    Vector3([0.0, -sine, -cosine]).cross(Vector3([0.0, cosine, -sine])).unit()
}

/// The right vector of Kinora's camera; NaN if there is no camera.
pub fn our_right(path: &CameraPath, timeline: &Timeline) -> DVec3 {
    path.at(&timeline.clock(0), None).map_or(DVec3::NAN, |camera| camera.basis.right)
}

/// Kinora's camera on an orbit at an elevation, in degrees.
pub fn at_elevation(elevation: f64) -> CameraPath {
    orbit(around(0.0, Some(elevation)))
}

fn pole() -> Case {
    let timeline = Timeline::of_frames(1, Rate::default());
    let paths: Vec<_> =
        (0..=100).map(|k| 85.0 + 0.1 * f64::from(k)).map(|e| (e, Rc::new(at_elevation(e)))).collect();
    let inputs: Vec<_> = paths
        .windows(2)
        .map(|pair| PoleStep {
            elevations: [pair[0].0, pair[1].0],
            ours: [Rc::clone(&pair[0].1), Rc::clone(&pair[1].1)],
            timeline,
        })
        .collect();
    fn textbook<R: Float>(at: &PoleStep) -> [Vector3<R>; 2] {
        at.elevations.map(fixed_up)
    }
    fn judge<R: Float>(_: &PoleStep, [a, b]: [Vector3<R>; 2]) -> Verdict {
        let turn = a.wide().angle_between(b.wide()).to_degrees();
        let verdict = Verdict::off(turn);
        Verdict { wrong: verdict.wrong || turn > 1.0, ..verdict }
    }
    Case {
        id: "CA-02",
        what: "camera that goes over the pole, 85 to 95 degrees by 0.1 (two frames a call)",
        error: "largest turn of right between two frames, in degrees",
        wrong: "steps that jump by more than 1 degree, or have no camera",
        methods: [
            method(inputs.clone(), textbook::<f32>, judge),
            method(inputs.clone(), textbook::<f64>, judge),
            method(inputs.clone(), |at| at.elevations.map(growing_up), judge),
            method(
                inputs,
                |at| at.ours.each_ref().map(|path| Vector3::of(our_right(path, &at.timeline))),
                judge::<f64>,
            ),
        ],
    }
}

/// A camera that looks at the origin, with an up vector close to its line of sight.
#[derive(Clone, Copy)]
struct Steep<R> {
    eye: Vector3<R>,
    up: Vector3<R>,
}

fn steep<R: Float>(workload: Workload) -> Vec<Steep<R>> {
    let mut rng = InputRng::new(3);
    let one = |_| {
        let up = rng.direction();
        let eye = (up + rng.ring(up, 1.0, 1.0) * rng.log_uniform(1e-9, 1e-1)) * 10.0;
        Steep { eye: Vector3::of(eye), up: Vector3::of(up) }
    };
    (0..workload.inputs).map(one).collect()
}

/// Right, up and forward.
type Axes<R> = [Vector3<R>; 3];

fn crossed<R: Float>(at: &Steep<R>) -> Axes<R> {
    let forward = (at.eye * -R::one()).unit();
    let right = forward.cross(at.up).unit();
    [right, right.cross(forward), forward]
}

/// With the cross product in f64, and a second orthogonalization of the right vector.
fn crossed_stable(at: &Steep<f32>) -> Axes<f32> {
    let forward = (at.eye * -1.0).unit();
    let right = forward.to::<f64>().cross(at.up.to()).to::<f32>();
    let right = if right.length() > 0.0 { right.unit() } else { Vector3([1.0, 0.0, 0.0]) };
    let right = (right - forward * right.dot(forward)).unit();
    [right, right.cross(forward).unit(), forward]
}

fn axes(workload: Workload) -> Case {
    fn ours(at: &Steep<f64>) -> Axes<f64> {
        let basis = look_at(at.eye.wide(), DVec3::ZERO, at.up.wide());
        basis.map_or([Vector3::of(DVec3::NAN); 3], |basis| {
            [basis.right, basis.up, basis.forward].map(Vector3::of)
        })
    }
    fn judge<R: Float>(_: &Steep<R>, axes: Axes<R>) -> Verdict {
        let [right, up, forward] = axes.map(Vector3::wide);
        let lengths = [right, up, forward].map(|axis| (axis.length() - 1.0).abs());
        let angles = [right.dot(up), up.dot(forward), forward.dot(right)].map(f64::abs);
        // Unlike f64::max, this keeps NaN.
        Verdict::off(lengths.into_iter().chain(angles).fold(0.0, |a, b| if a > b { a } else { b }))
    }
    Case {
        id: "CA-03",
        what: "camera whose up is 10^-9 to 0.1 radians off its line of sight",
        error: "largest defect of the frame's lengths and right angles",
        wrong: "no frame",
        methods: [
            method(steep::<f32>(workload), crossed, judge),
            method(steep::<f64>(workload), crossed, judge),
            method(steep::<f32>(workload), crossed_stable, judge),
            method(steep::<f64>(workload), ours, judge),
        ],
    }
}

type Quaternion<R> = [R; 4];

/// Two rotations, and a fraction of the way from the first to the second.
#[derive(Clone, Copy)]
struct RotationPair<R> {
    from: Quaternion<R>,
    to: Quaternion<R>,
    share: R,
}

fn turns<R: Float>(workload: Workload) -> Vec<RotationPair<R>> {
    let mut rng = InputRng::new(4);
    let one = |_| {
        let from = DQuat::from_axis_angle(rng.direction(), TAU * rng.unit());
        let to = DQuat::from_axis_angle(rng.direction(), rng.log_uniform(1e-8, 1.0)) * from;
        let [from, to] = [from, to].map(|q| q.to_array().map(R::of));
        RotationPair { from, to, share: R::of(rng.unit()) }
    };
    (0..workload.inputs).map(one).collect()
}

fn mixed<R: Float>(a: Quaternion<R>, wa: R, b: Quaternion<R>, wb: R) -> Quaternion<R> {
    std::array::from_fn(|i| a[i] * wa + b[i] * wb)
}

fn length<R: Float>(q: Quaternion<R>) -> R {
    q.map(|part| part * part).into_iter().fold(R::zero(), |sum, part| sum + part).sqrt()
}

/// Slerp by Shoemake (1985): the angle is the arc cosine of the dot product.
fn shoemake<R: Float>(at: &RotationPair<R>) -> Quaternion<R> {
    let cosine = (0..4).fold(R::zero(), |sum, i| sum + at.from[i] * at.to[i]);
    let angle = cosine.acos();
    let weight = |share: R| (share * angle).sin() / angle.sin();
    mixed(at.from, weight(R::one() - at.share), at.to, weight(at.share))
}

/// Slerp with the angle from the arc tangent of the lengths of the chords.
fn chords(at: &RotationPair<f32>) -> Quaternion<f32> {
    let (apart, along) = (mixed(at.to, 1.0, at.from, -1.0), mixed(at.to, 1.0, at.from, 1.0));
    let angle = 2.0 * libm::atan2f(length(apart), length(along));
    let sine = libm::sinf(angle);
    if sine == 0.0 {
        return at.from;
    }
    let weight = |share: f32| libm::sinf(share * angle) / sine;
    let q = mixed(at.from, weight(1.0 - at.share), at.to, weight(at.share));
    q.map(|part| part / length(q))
}

fn between(workload: Workload) -> Case {
    fn ours(at: &RotationPair<f64>) -> Quaternion<f64> {
        slerp(DQuat::from_array(at.from), DQuat::from_array(at.to), at.share).to_array()
    }
    /// The error of the angle between start and answer. Angles are computed from chords in f64, so they are only
    /// affected by the rounding of coordinates.
    fn judge<R: Float>(at: &RotationPair<R>, found: Quaternion<R>) -> Verdict {
        let angle = |a: Quaternion<R>, b: Quaternion<R>| {
            let [a, b] = [a, b].map(|q| DQuat::from_array(q.map(R::wide)));
            4.0 * libm::atan2((b - a).length(), (b + a).length())
        };
        let whole = angle(at.from, at.to);
        Verdict::off((angle(at.from, found) - at.share.wide() * whole).abs())
    }
    Case {
        id: "CA-04",
        what: "between two rotations 10^-8 to 1 radian apart",
        error: "largest error of the angle, in radians",
        wrong: "no number",
        methods: [
            method(turns::<f32>(workload), shoemake, judge),
            method(turns::<f64>(workload), shoemake, judge),
            method(turns::<f32>(workload), chords, judge),
            method(turns::<f64>(workload), ours, judge),
        ],
    }
}

pub fn cases(workload: Workload) -> Vec<Case> {
    vec![closing(), pole(), axes(workload), between(workload)]
}
