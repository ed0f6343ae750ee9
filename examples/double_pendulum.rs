//! Renders a double pendulum that this program moves, not keys in a file:
//!
//! ```text
//! cargo run --release --example double_pendulum [FOLDER]
//! ```
//!
//! The motion is a pure function of time, so everything works as with keys: the second run finds the frames of the first
//! and renders none. In the third, somebody stops the pendulum after two seconds; it renders the frames after that.

#[path = "assets/equations.rs"]
mod equations;

use equations::{State, step};
use kinora::{Output, Request, parse, render};
use std::error::Error;
use std::io::{Write, stdout};
use std::path::{Path, PathBuf};
use std::sync::Arc;

const SCENE: &str = r#"(
    timeline: (duration: 4, fps: 24),
    output: (size: (320, 240)),
    camera: (position: (0, -0.3, 7), target: (0, -0.3, 0)),
    lights: { "sun": Directional(direction: (-1, -2, -2)) },
    ambient: (0.2, 0.2, 0.25),
    materials: { "steel": (color: 0.4, mirror: 0.3), "red": (color: (0.8, 0.1, 0.05)) },
    objects: {
        "wall": (shape: Plane(point: (0, 0, -1), normal: (0, 0, 1)), material: (color: 0.7)),
        "upper": (shape: Group),
        "upper rod": (shape: Cylinder(from: (0, 0, 0), to: (0, -1, 0), radius: 0.04), material: "steel", parent: "upper"),
        "upper bob": (shape: Sphere(center: (0, -1, 0), radius: 0.15), material: "red", parent: "upper"),
        "lower": (shape: Group),
        "lower rod": (shape: Cylinder(from: (0, 0, 0), to: (0, -1, 0), radius: 0.04), material: "steel", parent: "lower"),
        "lower bob": (shape: Sphere(center: (0, -1, 0), radius: 0.15), material: "red", parent: "lower"),
    },
)"#;

/// Seconds of the animation.
const DURATION: f64 = 4.0;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1);
    let folder = folder.map_or_else(|| PathBuf::from("output/double-pendulum"), PathBuf::from);
    run("first run", &folder, f64::INFINITY)?;
    run("the same motion", &folder, f64::INFINITY)?;
    run("stopped after two seconds", &folder, 2.0)
}

/// Renders the pendulum, which is stopped at a time.
fn run(what: &str, folder: &Path, stopped: f64) -> Result<(), Box<dyn Error>> {
    let mut sequence = parse("double-pendulum.ron", SCENE)?;
    let trajectory = Arc::new(Trajectory::new([2.0, 2.6, 0.0, 0.0]));
    for arm in [0, 1] {
        let trajectory = Arc::clone(&trajectory);
        let motion = move |time: f64| places(trajectory.at(time.min(stopped)))[arm];
        sequence.drive(["upper", "lower"][arm], motion)?;
    }
    std::fs::create_dir_all(folder)?;
    let outputs = vec![Output::parse(folder.join("####.png"))?];
    let summary = render(&sequence, &Request::new(&sequence, outputs), &Arc::default())?;
    let (frames, kept) = (summary.frames, summary.kept);
    Ok(writeln!(
        stdout(),
        "{what}: {frames} frames, of which {kept} existed and {} share a film",
        summary.reused
    )?)
}

/// The maps of both rods, which hang down from the origin: images of the axes and of the origin.
fn places([a, b, ..]: State) -> [[[f64; 3]; 4]; 2] {
    let place = |angle: f64, origin: [f64; 3]| {
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0], origin]
    };
    [place(a, [0.0; 3]), place(b, [libm::sin(a), -libm::cos(a), 0.0])]
}

/// The states of a pendulum over time.
struct Trajectory(Vec<State>);

/// Steps per second.
const STEPS: f64 = 2000.0;

impl Trajectory {
    fn new(start: State) -> Self {
        let steps = (DURATION * STEPS) as usize;
        let next = |state: &State| Some(step(*state, 1.0 / STEPS));
        Self(std::iter::successors(Some(start), next).take(steps + 1).collect())
    }

    /// The state at a time: a shorter step from the last one before it. So it depends on the time alone.
    fn at(&self, time: f64) -> State {
        let steps = (time * STEPS).clamp(0.0, (self.0.len() - 1) as f64);
        step(self.0[steps as usize], steps.fract() / STEPS)
    }
}
