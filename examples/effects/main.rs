//! The price of every effect, one at a time on one scene: writes docs/effects.md and its pictures.
//!
//! ```text
//! cargo run --release --example effects
//! cargo run --release --example effects -- --counts      rays alone, in a moment
//! ```
//!
//! Instructions are counted by valgrind where there is one: the program runs itself under it, once for each effect.

mod cases;
mod page;

use cases::{CASES, Case, IDLE};
use kinora::base::stats::ProgressMeter;
use kinora::encode::{Existing, Output};
use kinora::pipeline::render::{Request, Reuse, Summary, render};
use kinora::sequence::Sequence;
use page::{Found, page};
use rustix::time::{ClockId, Timespec, clock_gettime};
use std::error::Error;
use std::io::{Write, stdout};
use std::num::NonZeroUsize;
use std::process::Command;
use std::sync::Arc;

/// Of the pictures, and of those that are traced under valgrind.
const SIZE: (u32, u32) = (240, 180);
const SMALL: (u32, u32) = (120, 90);

/// Rounds; the median of their times is printed. Each traces every effect once, so that a slow spell of the machine
/// meets all of them.
const ROUNDS: usize = 5;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let first = arguments.next();
    let counts_only = first.as_deref() == Some("--counts");
    if let (Some("--one"), Some(name)) = (first.as_deref(), arguments.next()) {
        let case =
            CASES.iter().chain(IDLE).find(|case| case.name == name).ok_or("there is no such effect")?;
        shot(&case.sequence(SMALL)?, &std::env::temp_dir().join("effect.ppm").to_string_lossy())?;
        return Ok(());
    }
    let mut found = CASES.iter().map(priced).collect::<Result<Vec<_>, _>>()?;
    let mut idle = Vec::new();
    if !counts_only {
        time(&mut found)?;
        found.iter_mut().for_each(|found| found.instructions = instructions(found.case.name));
        let idle_instructions = |case: &'static Case| (case, instructions(case.name));
        idle.extend(IDLE.iter().map(idle_instructions));
    }
    std::fs::write("docs/effects.md", page(&found, &idle))?;
    Ok(())
}

/// Takes the picture, and counts its rays.
fn priced(case: &'static Case) -> Result<Found, Box<dyn Error>> {
    let file = format!("docs/images/effects/{}.png", case.name);
    let rays = shot(&case.sequence(SIZE)?, &file)?.counts.rays.total();
    writeln!(stdout(), "{}: {rays} rays", case.name)?;
    Ok(Found { case, rays, seconds: None, instructions: None })
}

/// Measures the processor's time, in rounds.
fn time(found: &mut [Found]) -> Result<(), Box<dyn Error>> {
    let mut times = vec![Vec::new(); found.len()];
    let file = std::env::temp_dir().join("effect.ppm");
    for round in 1..=ROUNDS {
        for (found, times) in found.iter().zip(&mut times) {
            let sequence = found.case.sequence(SIZE)?;
            let start = clock_gettime(ClockId::ProcessCPUTime);
            shot(&sequence, &file.to_string_lossy())?;
            times.push(seconds(clock_gettime(ClockId::ProcessCPUTime)) - seconds(start));
        }
        writeln!(stdout(), "round {round} of {ROUNDS}")?;
    }
    for (found, times) in found.iter_mut().zip(&mut times) {
        times.sort_by(f64::total_cmp);
        found.seconds = Some(times[ROUNDS / 2]);
    }
    Ok(())
}

fn seconds(time: Timespec) -> f64 {
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

fn shot(sequence: &Sequence, file: &str) -> Result<Summary, Box<dyn Error>> {
    let outputs = vec![Output::parse(file)?];
    let request = Request {
        frames: vec![0],
        outputs,
        confined: false,
        existing: Existing::Replace,
        threads: NonZeroUsize::new(1),
        reuse: Reuse::Off,
        time_limit: None,
    };
    Ok(render(sequence, &request, &Arc::new(ProgressMeter::default()))?)
}

/// Instructions of a small picture, as valgrind counts them; none without it.
fn instructions(name: &str) -> Option<u64> {
    let program = std::env::current_exe().ok()?;
    let valgrind = ["--tool=callgrind", "--callgrind-out-file=/dev/null"];
    let out = Command::new("valgrind").args(valgrind).arg(program).args(["--one", name]).output().ok()?;
    let printed = String::from_utf8_lossy(&out.stderr).into_owned();
    let line = printed.lines().find_map(|line| line.split_once("Collected : "))?;
    line.1.trim().parse().ok()
}
