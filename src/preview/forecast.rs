//! Predicts the time and the error of the whole sequence for other numbers of samples, by the plan's pilot.

use crate::base::clock::TimeSource;
use crate::film::AovSet;
use crate::pipeline::plan::{PilotTime, Plan, run_pilot};
use crate::pipeline::render::Reuse;
use crate::sequence::Sequence;
use crate::sequence::quality::Quality;
use serde_json::{Value, json};

/// Numbers of random samples per pixel, and sizes of grids, of which the page offers those around the file's.
const SAMPLES: [u32; 14] = [1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192];
const GRIDS: [u32; 8] = [1, 2, 3, 4, 5, 6, 8, 10];

/// A table of numbers of samples with the seconds and the error that they cost for all frames.
pub fn forecast(sequence: &Sequence) -> Value {
    let frames: Vec<u32> = (0..sequence.timeline.frames).collect();
    let aovs = AovSet::of_picture(sequence.output.transparent);
    let plan = Plan::new(sequence, &frames, aovs, Reuse::Share.budget(sequence, aovs));
    let outlook = run_pilot(sequence, &plan, aovs, PilotTime::PLAN, TimeSource::Machine);
    let quality = Quality { noise: None, ..sequence.quality };
    let random = outlook.is_random();
    let row = |count: u32| {
        let quality = match random {
            true => Quality { samples: count, ..quality },
            false => Quality { antialias: count, ..quality },
        };
        let found = outlook.forecast(&quality);
        json!({
            "count": count,
            "seconds": [found.wall.low, found.wall.mid, found.wall.high],
            "error": found.error.map(|error| error.mid),
        })
    };
    let rows: Vec<Value> = if random { SAMPLES.map(row).to_vec() } else { GRIDS.map(row).to_vec() };
    json!({ "random": random, "rows": rows, "films": plan.films.len() })
}
