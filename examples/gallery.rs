//! Renders the pictures of the README's gallery into docs/images/gallery/:
//!
//! ```text
//! cargo run --release --example assets       first: what the sequences show
//! cargo run --release --example gallery      then: all of them; or with names, those
//! ```

use kinora::base::stats::ProgressMeter;
use kinora::encode::{Existing, Output};
use kinora::pipeline::render::{Request, Reuse, render};
use kinora::sequence::load;
use std::error::Error;
use std::io::{Write, stdout};
use std::path::Path;
use std::sync::Arc;

/// Width of the pictures in pixels.
const WIDTH: u32 = 400;

/// Sequences with the frames that are shown of them, and how many samples these take where they are random.
const PICTURES: &[(&str, &[u32], u32)] = &[
    ("glazed-orbit", &[6], 1),
    ("classic-shadow", &[10], 1),
    ("classic-refraction", &[40], 1),
    ("classic-cube-map", &[40], 1),
    ("classic-mirrors", &[10], 1),
    ("classic-turntable", &[10], 1),
    ("room", &[5], 1),
    ("room-effects", &[8, 44], 64),
    ("flight", &[70], 1),
    ("cradle", &[7], 256),
    ("pendulum", &[0, 20, 41], 1),
    ("whitted", &[0], 1),
    ("pressure", &[36], 1),
    ("fountain", &[36], 1),
    ("forest", &[20], 1),
    ("waves", &[5], 1),
    ("annotated-crank", &[9], 1),
    ("annotated-waves", &[9], 1),
    ("annotated-pendulum", &[33], 1),
    ("titles", &[40], 1),
    ("exported-crank", &[12], 1),
    ("pump", &[84, 180], 1),
    ("rotunda", &[12], 16),
    ("field-orbit", &[8], 256),
    ("field-metal", &[8], 256),
    ("field-dielectric", &[8], 256),
];

fn main() -> Result<(), Box<dyn Error>> {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    for &(name, frames, samples) in PICTURES {
        if wanted.is_empty() || wanted.iter().any(|wanted| wanted == name) {
            picture(name, frames, samples)?;
        }
    }
    Ok(())
}

fn picture(name: &str, frames: &[u32], samples: u32) -> Result<(), Box<dyn Error>> {
    let mut sequence = load(Path::new(&format!("sequences/{name}.ron")))?;
    let (width, height) = sequence.output.size;
    sequence.output.size = (WIDTH, (WIDTH * height).div_ceil(width));
    sequence.quality.samples = samples;
    sequence.quality.antialias = 4;
    for &frame in frames {
        let output = format!("docs/images/gallery/{name}-{frame}.png");
        let outputs = vec![Output::parse(&output)?];
        let request = Request {
            frames: vec![frame],
            outputs,
            confined: false,
            existing: Existing::Replace,
            threads: None,
            reuse: Reuse::Share,
            time_limit: None,
        };
        let summary = render(&sequence, &request, &Arc::new(ProgressMeter::default()))?;
        writeln!(stdout(), "{output}: {:.1} s", summary.elapsed.as_secs_f64())?;
    }
    Ok(())
}
