//! The price of every effect, one at a time on one scene: writes docs/effects.md and its pictures.
//!
//! ```text
//! cargo run --release --example effects
//! cargo run --release --example effects -- --counts      rays alone, in a moment
//! ```
//!
//! Instructions are counted by valgrind where there is one: the program runs itself under it, once for each effect.

use kinora::counters::Meter;
use kinora::encode::{Existing, Output};
use kinora::render::{Request, Reuse, Summary, render};
use kinora::sequence::{Sequence, parse};
use rustix::time::{ClockId, clock_gettime};
use std::error::Error;
use std::fmt::Write as _;
use std::io::{Write, stdout};
use std::num::NonZeroUsize;
use std::process::Command;
use std::sync::Arc;

/// Of the pictures, and of those that are traced under valgrind.
const SIZE: (u32, u32) = (240, 180);
const SMALL: (u32, u32) = (64, 48);

/// Runs of which the middle one's time is told.
const RUNS: usize = 5;

/// What an effect changes in the scene: fields of the sequence, of the ball's material, and the lamp.
struct Case {
    name: &'static str,
    about: &'static str,
    fields: &'static str,
    camera: &'static str,
    lamp: &'static str,
    ball: &'static str,
    /// Of the ball's object.
    object: &'static str,
}

const LAMP: &str = r#""lamp": Point(position: (4, 6, 5))"#;

const PLAIN: Case = Case {
    name: "plain",
    about: "a matt ball and floor, one point light",
    fields: "",
    camera: "",
    lamp: LAMP,
    ball: "(color: \"#c8503a\")",
    object: "",
};

const fn fields(name: &'static str, about: &'static str, fields: &'static str) -> Case {
    Case { name, about, fields, ..PLAIN }
}

const fn camera(name: &'static str, about: &'static str, camera: &'static str) -> Case {
    Case { name, about, camera, ..PLAIN }
}

const fn lamp(name: &'static str, about: &'static str, lamp: &'static str) -> Case {
    Case { name, about, lamp, ..PLAIN }
}

const fn ball(name: &'static str, about: &'static str, ball: &'static str) -> Case {
    Case { name, about, ball, ..PLAIN }
}

const CASES: &[Case] = &[
    PLAIN,
    lamp("no-light", "ambient light alone: no shadow rays", ""),
    lamp(
        "two-lights",
        "a second point light",
        r#""lamp": Point(position: (4, 6, 5)), "fill": Point(position: (-5, 4, 4), intensity: 0.4)"#,
    ),
    lamp(
        "attenuation",
        "light that fades with distance",
        r#""lamp": Point(position: (4, 6, 5), intensity: 6, attenuation: (constant: 1, quadratic: 0.08))"#,
    ),
    lamp(
        "spot",
        "a spot light with a soft edge",
        r#""lamp": Spot(position: (4, 6, 5), target: (0, 1, 0), angle: 40, inner_angle: 20)"#,
    ),
    lamp(
        "area-light",
        "a light with an area: random samples and soft shadows",
        r#""lamp": Sphere(center: (4, 6, 5), radius: 0.8, intensity: 110)"#,
    ),
    ball("highlight", "a highlight", "(color: \"#c8503a\", specular: 0.6, shininess: 40)"),
    ball("mirror", "a sharp mirror", "(color: \"#c8503a\", diffuse: 0.4, mirror: 0.5)"),
    ball("fuzzy-mirror", "a mirror that scatters", "Metal(color: (0.85, 0.6, 0.4), fuzz: 0.2)"),
    ball(
        "rough",
        "the metallic-roughness model",
        "MetallicRoughness(color: \"#c8503a\", metallic: 0.6, roughness: 0.4)",
    ),
    ball(
        "transparency",
        "light passes straight on, also in shadows",
        "(color: \"#c8503a\", diffuse: 0.4, transparency: 0.6)",
    ),
    ball("refraction", "glass, with Fresnel's reflection", "Dielectric()"),
    ball("absorption", "glass that absorbs", "Dielectric(absorption: (0.2, 0.9, 0.9))"),
    ball("emission", "a ball that shines by itself", "(color: \"#c8503a\", emission: 0.5)"),
    ball("pattern", "a checker", "(color: Checker(a: \"#c8503a\", b: \"#f0e0c0\", scale: 0.4))"),
    ball("noise", "marble of four octaves", "(color: Marble(a: \"#c8503a\", b: \"#f0e0c0\", scale: 0.5))"),
    ball("texture", "an image over u and v", "(color: Image(\"assets/textures/planet.png\"))"),
    fields("sky", "a gradient in place of a plain background", "background: Gradient(),"),
    fields("fog", "even fog", "fog: (density: 0.06, color: 0.7),"),
    fields(
        "fog-height",
        "fog that grows thinner with height",
        "fog: (density: 0.2, color: 0.7, falloff: (height: 0.8)),",
    ),
    camera("orthographic", "parallel rays of the camera", "projection: Orthographic(height: 5.2),"),
    camera("lens", "depth of field: random samples", "aperture: 0.4,"),
    Case {
        name: "motion-blur",
        about: "an open shutter while the ball moves: random samples and sixteen trees",
        camera: "shutter: 1,",
        object: "translation: [(0, (-0.5, 0, 0)), (0.04166, (0.5, 0, 0))],",
        ..PLAIN
    },
    fields(
        "paths",
        "path tracing with three bounces",
        "quality: (antialias: 4, samples: 16, bounces: 3, shutter_steps: 16, integrator: Path),",
    ),
];

impl Case {
    fn sequence(&self, size: (u32, u32)) -> Result<Sequence, String> {
        let Self { fields, camera, lamp, ball, object, .. } = self;
        let default = "quality: (antialias: 4, samples: 16, bounces: 3, shutter_steps: 16),";
        let quality = if fields.contains("quality:") { "" } else { default };
        let background = if fields.contains("background:") { "" } else { "background: (0.35, 0.5, 0.7)," };
        let text = format!(
            "(timeline: (frames: 1), output: (size: ({}, {})), {quality} {background} {fields}
            camera: (position: (0, 2.2, 7), target: (0, 0.9, 0), {camera}), lights: {{ {lamp} }},
            default_material: (ambient: 0.2),
            objects: {{
                \"floor\": (shape: Plane(), material: (color: 0.6)),
                \"ball\": (shape: Sphere(center: (0, 1, 0)), material: {ball}, {object}),
            }})",
            size.0, size.1
        );
        parse("effects.ron", &text).map_err(|faults| format!("{}: {faults}", self.name))
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let first = arguments.next();
    let timed = first.as_deref() != Some("--counts");
    if let (Some("--one"), Some(name)) = (first.as_deref(), arguments.next()) {
        let case = CASES.iter().find(|case| case.name == name).ok_or("there is no such effect")?;
        shot(&case.sequence(SMALL)?, &std::env::temp_dir().join("effect.ppm").to_string_lossy())?;
        return Ok(());
    }
    let mut table = String::new();
    let mut plain = None;
    for case in CASES {
        let found = Found::of(case, timed)?;
        writeln!(stdout(), "{}: {} rays", case.name, found.rays)?;
        table += &found.row(case, plain.get_or_insert_with(|| found.clone()));
    }
    std::fs::write("docs/effects.md", page(&table))?;
    Ok(())
}

/// What an effect takes.
#[derive(Clone, Debug)]
struct Found {
    /// Of one processor, if it was measured.
    seconds: Option<f64>,
    rays: u64,
    instructions: Option<u64>,
}

impl Found {
    fn of(case: &Case, timed: bool) -> Result<Self, Box<dyn Error>> {
        let sequence = case.sequence(SIZE)?;
        let file = format!("docs/images/effects/{}.png", case.name);
        let mut times = Vec::new();
        let mut rays = 0;
        for _ in 0..if timed { RUNS } else { 1 } {
            let start = clock_gettime(ClockId::ProcessCPUTime);
            rays = shot(&sequence, &file)?.counts.rays.total();
            let end = clock_gettime(ClockId::ProcessCPUTime);
            times.push((end.tv_sec - start.tv_sec) as f64 + (end.tv_nsec - start.tv_nsec) as f64 * 1e-9);
        }
        times.sort_by(f64::total_cmp);
        let seconds = timed.then(|| times[RUNS / 2]);
        Ok(Self { seconds, rays, instructions: timed.then(|| instructions(case.name)).flatten() })
    }

    fn row(&self, case: &Case, plain: &Self) -> String {
        let ratio = |ours: u64, theirs: u64| format!("{:.2}", ours as f64 / theirs as f64);
        let instructions =
            self.instructions.zip(plain.instructions).map_or("".to_owned(), |(a, b)| ratio(a, b));
        let mut row = String::new();
        let name = case.name;
        // Writing to a string cannot fail.
        _ = writeln!(
            row,
            "| ![{name}](images/effects/{name}.png) | {} | {} | {} | {} | {} |",
            case.about,
            self.seconds.zip(plain.seconds).map_or(String::new(), |(a, b)| format!("{:.2}", a / b)),
            ratio(self.rays, plain.rays),
            self.rays,
            instructions,
        );
        row
    }
}

fn shot(sequence: &Sequence, file: &str) -> Result<Summary, Box<dyn Error>> {
    let outputs = vec![Output::parse(file)?];
    let request = Request {
        frames: vec![0],
        outputs,
        existing: Existing::Replace,
        threads: NonZeroUsize::new(1),
        reuse: Reuse::Off,
        time_limit: None,
    };
    Ok(render(sequence, &request, &Arc::new(Meter::default()))?)
}

/// Instructions of a small picture, as valgrind counts them; none without it.
fn instructions(name: &str) -> Option<u64> {
    let program = std::env::current_exe().ok()?;
    let valgrind = ["--tool=callgrind", "--callgrind-out-file=/dev/null"];
    let out = Command::new("valgrind").args(valgrind).arg(program).args(["--one", name]).output().ok()?;
    let told = String::from_utf8_lossy(&out.stderr).into_owned();
    let line = told.lines().find_map(|line| line.split_once("Collected : "))?;
    line.1.trim().parse().ok()
}

fn page(table: &str) -> String {
    format!(
        "# What effects cost\n\n\
        What a scene does not call for takes no work: an effect of zero strength gives the bytes, and takes the rays, of a\n\
        scene without it. What it does call for is priced here, one effect at a time on one scene: a ball on a floor, {} by {}\n\
        pixels with 16 samples each, on one thread. The numbers are ratios to the plain scene in the first row: time of the\n\
        processor, the middle of {RUNS} runs; rays of all kinds, and how many that are; and instructions of a picture of {} by {}\n\
        pixels, which count reading the sequence and writing the file as well. With `-- --counts`, only rays are told.\n\n\
        `kinora plan FILE` tells which effects a sequence calls for, and who does.\n\n\
        ```sh\ncargo run --release --example effects      # this page and its pictures\n```\n\n\
        | | effect | time | rays | | instructions |\n|---|---|---|---|---|---|\n{table}",
        SIZE.0, SIZE.1, SMALL.0, SMALL.1,
    )
}
