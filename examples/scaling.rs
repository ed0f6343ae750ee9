//! Draws how much sooner many workers are done than one, for three sequences, and prints the same as a table for
//! docs/farm-scaling.md:
//!
//! ```text
//! cargo run --release --example scaling      docs/images/farm-scaling.svg
//! ```
//!
//! A few frames are rendered to find out what things take on this machine; what is drawn are ratios of these times.

use kinora::accuracy::plot::{DataPoint, Legend, Plot, Scale, Series};
use kinora::base::clock::timed;
use kinora::base::units::count;
use kinora::farm::{JobForecast, Scaling};
use kinora::sequence::load;
use std::error::Error;
use std::io::{Write, stdout};
use std::num::NonZeroUsize;
use std::path::Path;

const PICTURE: &str = "docs/images/farm-scaling.svg";
const SEQUENCES: [&str; 3] = ["hello", "room-effects", "light-show"];
/// Numbers of workers in the table; the curves have those of each decade.
const TABLE: [usize; 9] = [1, 2, 5, 10, 20, 50, 100, 1000, 10_000];
const DECADE: [usize; 7] = [10, 15, 20, 30, 40, 50, 70];

fn main() -> Result<(), Box<dyn Error>> {
    let forecasts = SEQUENCES.map(forecast).into_iter().collect::<Result<Vec<_>, _>>()?;
    let curves: Vec<Series> = forecasts.iter().zip(SEQUENCES).enumerate().map(curve).collect();
    let best = curves.iter().flat_map(|curve| &curve.points).fold(1.0, |best: f64, spot| best.max(spot.y));
    let plot = Plot {
        title: "How many times sooner workers are done than one process".to_owned(),
        x: Scale { name: "workers", label: |value| count(value.round() as u64) },
        y: Scale { name: "speed-up", label: |value| format!("{value}") },
        series: curves,
        behind: vec![(1.0, 1.0), (best, best)],
        ring: None,
        legend: Legend::UpperLeft,
    };
    std::fs::write(PICTURE, plot.svg()?)?;
    let mut out = stdout().lock();
    for workers in TABLE.into_iter().filter_map(NonZeroUsize::new) {
        write!(out, "| {} |", count(workers.get() as u64).replace(',', " "))?;
        for forecast in &forecasts {
            let Scaling { speedup, efficiency, .. } = forecast.scaling(workers);
            write!(out, " {speedup:.2} | {:.1} % |", 100.0 * efficiency)?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// A sequence with one task for each film, for workers of one thread.
fn forecast(name: &str) -> Result<JobForecast, Box<dyn Error>> {
    let (sequence, load) = timed(|| load(Path::new(&format!("sequences/{name}.ron"))));
    let sequence = sequence?;
    let frames: Vec<u32> = (0..sequence.timeline.frames).collect();
    let most = NonZeroUsize::new(10_000);
    Ok(JobForecast::of(&sequence, &frames, most, Some(NonZeroUsize::MIN), load)?)
}

fn curve((color, (forecast, name)): (usize, (&JobForecast, &str))) -> Series {
    let few = 1..10;
    let more = [1, 10, 100].into_iter().flat_map(|ten| DECADE.map(|workers| workers * ten));
    let workers = few.chain(more).chain([10_000]).filter_map(NonZeroUsize::new);
    let spot = |workers: NonZeroUsize| {
        let y = forecast.scaling(workers).speedup;
        DataPoint { x: workers.get() as f64, y, low: y, high: y, label: String::new() }
    };
    let tasks = forecast.tasks.len();
    let name = format!("{name}: {tasks} task{}", if tasks == 1 { "" } else { "s" });
    Series { name, color, points: workers.map(spot).collect() }
}
