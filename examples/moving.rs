//! Measures what a frame costs before its first ray, while some of many objects move:
//!
//! ```text
//! cargo run --release --example moving [CASE...]
//! ```
//!
//! Each line is a sequence of 60 frames of 8 x 6 pixels: `OBJECTS/MOVING` is a number of spheres and how many of them
//! move, `mesh/TRIANGLES` a mesh that turns, `particles/COUNT` the particles of a table, all of which move, and
//! `series/TRIANGLES` a mesh of its own for every frame. `load` is the time to read the sequence from a file. The next columns are
//! medians over the frames after the first: evaluation of a frame by the plan, the stages before tracing, and tracing
//! with its set-up. Then follow the mean number of primitives that a frame rewrites, how often the tree was built and
//! refitted, and the memory of the process after the last frame (on Linux). Each case runs in a process of its own.

use kinora::base::math::DVec3;
use kinora::geometry::mesh::MeshData;
use kinora::import::ply;
use kinora::pipeline::plan;
use kinora::pipeline::schedule::{FilmCollector, FrameLoop, FrameStage, Stats};
use kinora::sequence::{Sequence, load};
use std::error::Error;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufWriter, Write as _, stdout};
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::time::Instant;
use std::{env, fs};

const FRAMES: u32 = 60;

const CASES: [&str; 13] = [
    "100/1",
    "10000/1",
    "10000/10000",
    "100000/0",
    "100000/1",
    "100000/100",
    "100000/100000",
    "1000000/0",
    "1000000/1",
    "mesh/1000000",
    "particles/100000",
    "particles/1000000",
    "series/200000",
];

fn main() -> Result<(), Box<dyn Error>> {
    let cases: Vec<String> = env::args().skip(1).collect();
    if let [case] = &cases[..] {
        return measure(case);
    }
    writeln!(
        stdout(),
        "case            load s   plan ms   animate   extract   accelerate   trace ms   packed   builds   refits   MiB"
    )?;
    let all: Vec<String> = CASES.iter().map(ToString::to_string).collect();
    for case in if cases.is_empty() { all } else { cases } {
        let status = Command::new(env::current_exe()?).arg(case).status()?;
        if !status.success() {
            return Err("a case failed".into());
        }
    }
    Ok(())
}

/// Prints the line of a case.
fn measure(case: &str) -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let (text, moving) =
        match case.split_once('/').ok_or("a case is OBJECTS/MOVING, or a kind and a number")? {
            ("mesh", triangles) => (mesh(folder.path(), triangles.parse()?)?, 1),
            ("particles", count) => (particles(folder.path(), count.parse()?)?, count.parse()?),
            ("series", triangles) => (series(folder.path(), triangles.parse()?)?, 1000),
            (objects, moving) => (spheres(objects.parse()?, moving.parse()?), moving.parse::<u32>()?),
        };
    let path = folder.path().join("moving.ron");
    fs::write(&path, &text)?;
    drop(text);
    let start = Instant::now();
    let sequence = load(&path).map_err(|faults| faults.to_string())?;
    let loaded = start.elapsed().as_secs_f64();
    let plan = planned(&sequence, (30_000 / (moving + 1)).clamp(1, 300))?;
    // As in a run, on a thread of the pool.
    let seen = rayon::ThreadPoolBuilder::new().build()?.install(|| rendered(&sequence))?;
    let [animate, extract, accelerate, trace] =
        [FrameStage::Animate, FrameStage::Extract, FrameStage::Accelerate, FrameStage::Trace]
            .map(|stage| median_ms(&seen, stage));
    let (first, last) = (&seen[0], &seen[seen.len() - 1]);
    let packed = (last.primitives_packed - first.primitives_packed) / u64::from(FRAMES - 1);
    let (builds, refits) = (last.bvh_builds, last.bvh_refits);
    writeln!(
        stdout(),
        "{case:14}  {loaded:6.3}  {plan:8.3}  {animate:8.3}  {extract:8.3}  {accelerate:11.3}  {trace:9.3}  \
         {packed:7}  {builds:7}  {refits:7}   {}",
        resident().map_or("-".to_owned(), |bytes| (bytes >> 20).to_string()),
    )?;
    Ok(())
}

/// The statistics after each frame.
fn rendered(sequence: &Sequence) -> Result<Vec<Stats>, String> {
    let mut frames = FrameLoop::new(sequence, FilmCollector::default(), Arc::default());
    let mut seen: Vec<Stats> = Vec::new();
    for frame in 0..FRAMES {
        frames.frame(frame).map_err(|error| format!("{error:?}"))?;
        seen.push(frames.stats().clone());
    }
    Ok(seen)
}

/// Milliseconds for the plan to evaluate a frame after the first, on one thread: the difference of runs of two lengths,
/// as the world is made first.
fn planned(sequence: &Sequence, rounds: u32) -> Result<f64, Box<dyn Error>> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let evaluated = |frames: &[u32]| {
        let start = Instant::now();
        pool.install(|| plan::evaluate(sequence, frames));
        start.elapsed().as_secs_f64() * 1e3
    };
    let all: Vec<u32> = (0..rounds).flat_map(|_| 0..FRAMES).collect();
    let took = |_| (evaluated(&all) - evaluated(&all[..1])) / (all.len() - 1) as f64;
    let mut times: Vec<f64> = (0..3).map(took).collect();
    times.sort_by(f64::total_cmp);
    Ok(times[1])
}

/// The median time of a stage over all frames but the first.
fn median_ms(seen: &[Stats], stage: FrameStage) -> f64 {
    let took =
        |pair: &[Stats]| (pair[1].stages[stage as usize] - pair[0].stages[stage as usize]).as_secs_f64();
    let mut times: Vec<f64> = seen.windows(2).map(took).collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2] * 1e3
}

/// The resident memory of this process.
fn resident() -> Option<u64> {
    let text = fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    line.trim().strip_suffix(" kB")?.parse::<u64>().ok().map(|kib| kib << 10)
}

/// The parts that all sequences have.
fn head(far: f64) -> String {
    format!(
        "(timeline: (frames: {FRAMES}, keys: Frames), output: (size: (8, 6)), quality: (antialias: 1), \
         camera: (position: (0, 0, {far})), lights: {{ \"lamp\": Point(position: (3, 60, 50)) }}, "
    )
}

/// A sequence of small spheres in a cube, the first of which move by up to a tenth of its size.
fn spheres(count: u32, moving: u32) -> String {
    let mut random = Random(1);
    let mut text = head(300.0) + "objects: {\n";
    for index in 0..count {
        let [x, y, z, radius] = [99.0, 99.0, 99.0, 0.2].map(|size| size * random.signed());
        let radius = 0.4 + radius;
        let keys = match index < moving {
            true => {
                let [a, b, c] = [10.0; 3].map(|size| size * random.signed());
                format!(",translation:[(0,(0,0,0)),({FRAMES},({a:.1},{b:.1},{c:.1}))]")
            }
            false => String::new(),
        };
        // A million spheres fit into the largest file that is read. Writing to a text cannot fail.
        let _ = writeln!(
            text,
            "\"{index}\":(shape:Sphere(center:({x:.1},{y:.1},{z:.1}),radius:{radius:.1}){keys}),"
        );
    }
    text + "})"
}

/// A sequence of particles like [`spheres`], all of which move, and its table.
fn particles(folder: &Path, count: u32) -> Result<String, Box<dyn Error>> {
    let mut random = Random(1);
    let mut table = "t,id,x,y,z,r\n".to_owned();
    for index in 0..count {
        let start = [99.0; 3].map(|size| size * random.signed());
        let radius = 0.4 + 0.2 * random.signed();
        let end = start.map(|start| start + 10.0 * random.signed());
        for (time, [x, y, z]) in [(0, start), (FRAMES, end)] {
            let _ = writeln!(table, "{time},{index},{x:.1},{y:.1},{z:.1},{radius:.1}");
        }
    }
    fs::write(folder.join("particles.csv"), table)?;
    Ok(head(300.0) + "objects: { \"all\": (shape: Particles(\"particles.csv\")) })")
}

/// A sequence of a mesh per frame, and its files: hills of at least this many triangles that rise.
fn series(folder: &Path, triangles: u32) -> Result<String, Box<dyn Error>> {
    let side = (f64::from(triangles) / 2.0).sqrt().ceil() as u32;
    let corners = (0..=side).flat_map(|k| (0..=side).map(move |l| (k, l)));
    let at = |frame: u32| {
        let rise = f64::from(frame) / f64::from(FRAMES);
        corners.clone().map(move |(k, l)| DVec3::new(k.into(), rise * f64::from((k * l) % 7), l.into()))
    };
    let squares = (0..side).flat_map(|k| (0..side).map(move |l| k * (side + 1) + l));
    let triangles: Vec<[u32; 3]> =
        squares.flat_map(|a| [[a, a + 1, a + side + 1], [a + 1, a + side + 2, a + side + 1]]).collect();
    for frame in 0..FRAMES {
        let data =
            MeshData { positions: at(frame).collect(), triangles: triangles.clone(), ..MeshData::default() };
        ply::write(BufWriter::new(File::create(folder.join(format!("hills-{frame:02}.ply")))?), &data)?;
    }
    let middle = side / 2;
    Ok(head(f64::from(2 * side))
        + &format!(
            "objects: {{ \"hills\": (shape: Mesh(series: \"hills-##.ply\", at: (step: 1)), \
             translation: (-{middle}, 0, -{middle})) }})"
        ))
}

/// A sequence of a mesh that turns, and its file: hills of at least this many triangles.
fn mesh(folder: &Path, triangles: u32) -> Result<String, Box<dyn Error>> {
    let side = (f64::from(triangles) / 2.0).sqrt().ceil() as u32;
    let mut obj = String::new();
    for (k, l) in (0..=side).flat_map(|k| (0..=side).map(move |l| (k, l))) {
        let _ = writeln!(obj, "v {k} {} {l}", (k * l) % 7);
    }
    for (k, l) in (0..side).flat_map(|k| (0..side).map(move |l| (k, l))) {
        let a = k * (side + 1) + l + 1;
        let b = a + side + 1;
        let _ = writeln!(obj, "f {a} {} {b}\nf {} {} {b}", a + 1, a + 1, b + 1);
    }
    fs::write(folder.join("hills.obj"), obj)?;
    let middle = side / 2;
    Ok(head(f64::from(2 * side))
        + &format!(
            "objects: {{ \"hills\": (shape: Mesh(file: \"hills.obj\"), translation: (-{middle}, 0, -{middle}), \
             pivot: ({middle}, 0, {middle}), \
             rotation: AxisAngle(axis: (0, 1, 0), angle: [(0, 0), ({FRAMES}, 90)])) }})"
        ))
}

/// splitmix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    /// Evenly in -1..1.
    fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        2.0 * (((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64) - 1.0
    }
}
