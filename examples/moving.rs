//! Measures what a frame costs before its first ray, while some of many objects move:
//!
//! ```text
//! cargo run --release --example moving
//! ```
//!
//! Each line is a sequence of 60 frames of 8 x 6 pixels: the number of spheres, and how many of them move. The columns
//! are medians over the frames after the first: evaluation of a frame by the plan, the stages before tracing, and tracing
//! with its set-up; then the mean number of primitives that a frame rewrites, and how often the tree was built and
//! refitted. `load` is the time to read the sequence from its text.

use kinora::pipeline::plan;
use kinora::pipeline::schedule::{FilmCollector, FrameLoop, FrameStage, Stats};
use kinora::sequence::parse;
use std::error::Error;
use std::fmt::Write as _;
use std::io::{Write as _, stdout};
use std::sync::Arc;
use std::time::Instant;

const FRAMES: u32 = 60;

/// The number of spheres, and how many of them move.
const CASES: [(u32, u32); 6] =
    [(100, 1), (10_000, 1), (10_000, 10_000), (100_000, 1), (100_000, 100), (100_000, 100_000)];

fn main() -> Result<(), Box<dyn Error>> {
    let mut out = stdout().lock();
    writeln!(
        out,
        "spheres   moving   load s   plan ms   animate   extract   accelerate   trace ms   packed   builds, refits"
    )?;
    for (count, moving) in CASES {
        let text = text(count, moving);
        let start = Instant::now();
        let sequence = parse("moving.ron", &text).map_err(|faults| faults.to_string())?;
        let load = start.elapsed().as_secs_f64();
        // Differences of medians of whole runs would include the first frame, so runs of two lengths are compared.
        let evaluated = |frames: u32| {
            let start = Instant::now();
            plan::evaluate(&sequence, &(0..frames).collect::<Vec<_>>());
            start.elapsed().as_secs_f64()
        };
        let plan = (evaluated(FRAMES) - evaluated(1)) / f64::from(FRAMES - 1);
        let mut frames = FrameLoop::new(&sequence, FilmCollector::default(), Arc::default());
        let mut seen: Vec<Stats> = Vec::new();
        for frame in 0..FRAMES {
            frames.frame(frame).map_err(|error| format!("{error:?}"))?;
            seen.push(frames.stats().clone());
        }
        let median = |stage: FrameStage| {
            let took = |pair: &[Stats]| {
                (pair[1].stages[stage as usize] - pair[0].stages[stage as usize]).as_secs_f64()
            };
            let mut times: Vec<f64> = seen.windows(2).map(took).collect();
            times.sort_by(f64::total_cmp);
            times[times.len() / 2] * 1e3
        };
        let [animate, extract, accelerate, trace] =
            [FrameStage::Animate, FrameStage::Extract, FrameStage::Accelerate, FrameStage::Trace].map(median);
        let (first, last) = (&seen[0], &seen[seen.len() - 1]);
        let packed = (last.primitives_packed - first.primitives_packed) / u64::from(FRAMES - 1);
        writeln!(
            out,
            "{count:7}  {moving:7}  {load:7.3}  {:8.3}  {animate:8.3}  {extract:8.3}  {accelerate:11.3}  {trace:9.3}  \
             {packed:7}   {}, {}",
            plan * 1e3,
            last.bvh_builds,
            last.bvh_refits
        )?;
    }
    Ok(())
}

/// A sequence of small spheres in a cube, the first of which move by up to a tenth of its size.
fn text(count: u32, moving: u32) -> String {
    let mut random = Random(1);
    let mut text = format!(
        "(timeline: (frames: {FRAMES}, keys: Frames), output: (size: (8, 6)), quality: (antialias: 1), \
         camera: (position: (0, 0, 60)), lights: {{ \"lamp\": Point(position: (3, 60, 50)) }}, \
         materials: {{ \"red\": (color: (0.8, 0.1, 0.1)), \"blue\": (color: (0.1, 0.2, 0.8)) }}, objects: {{\n"
    );
    for index in 0..count {
        let [x, y, z, radius] = [20.0, 20.0, 20.0, 0.05].map(|size| size * random.signed());
        let radius = 0.07 + radius;
        let keys = match index < moving {
            true => {
                let [a, b, c] = [2.0; 3].map(|size| size * random.signed());
                format!(", translation: [(0, (0, 0, 0)), ({FRAMES}, ({a:.3}, {b:.3}, {c:.3}))]")
            }
            false => String::new(),
        };
        let material = if index % 2 == 0 { "red" } else { "blue" };
        // Writing to a text cannot fail.
        let _ = writeln!(
            text,
            "\"s{index}\": (shape: Sphere(center: ({x:.3}, {y:.3}, {z:.3}), radius: {radius:.3}), \
             material: \"{material}\"{keys}),"
        );
    }
    text + "})"
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
