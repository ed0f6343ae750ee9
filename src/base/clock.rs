//! Wall time and CPU time of work. Other processes on the machine disturb CPU time less.

use crate::base::machine::cpu_time;
use std::ops::{Add, Mul, Sub};
use std::time::Instant;

/// How tracing is timed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum TimeSource {
    /// By the clocks of the machine.
    #[default]
    Machine,
    /// By the rays alone: each takes this many seconds, and nothing else takes time. The same on all machines.
    Rays(f64),
}

/// A duration in seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ElapsedTime {
    pub wall: f64,
    /// CPU time of all threads; `None` if the system does not report it.
    pub cpu: Option<f64>,
}

impl TimeSource {
    /// The time of work that took `took` by the clocks of the machine and traced `rays` rays.
    pub fn elapsed(self, took: ElapsedTime, rays: u64) -> ElapsedTime {
        match self {
            Self::Machine => took,
            Self::Rays(each) => {
                let seconds = each * rays as f64;
                ElapsedTime { wall: seconds, cpu: Some(seconds) }
            }
        }
    }
}

impl ElapsedTime {
    /// No time, on a machine that reports CPU time.
    pub const ZERO: Self = Self { wall: 0.0, cpu: Some(0.0) };

    /// The time of the work on one thread of an idle machine: the CPU time, but no more than the wall time if several
    /// threads shared the work.
    pub fn on_one_thread(self) -> f64 {
        self.cpu.map_or(self.wall, |cpu| cpu.min(self.wall))
    }

    /// The time of the work if `threads` threads share it evenly.
    pub fn on_threads(self, threads: usize) -> f64 {
        self.cpu.map_or(self.wall, |cpu| cpu / threads as f64)
    }
}

impl Add for ElapsedTime {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { wall: self.wall + other.wall, cpu: self.cpu.zip(other.cpu).map(|(a, b)| a + b) }
    }
}

impl Mul<f64> for ElapsedTime {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self { wall: factor * self.wall, cpu: self.cpu.map(|cpu| factor * cpu) }
    }
}

impl Sub for ElapsedTime {
    type Output = Self;

    /// The time without a part of it, at least 0.
    fn sub(self, part: Self) -> Self {
        let cpu = self.cpu.zip(part.cpu).map(|(all, part)| (all - part).max(0.0));
        Self { wall: (self.wall - part.wall).max(0.0), cpu }
    }
}

/// Runs `work` and measures its time.
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, ElapsedTime) {
    let (start, before) = (Instant::now(), cpu_time());
    let done = work();
    let wall = start.elapsed().as_secs_f64();
    let cpu = cpu_time().zip(before).map(|(after, before)| after - before);
    (done, ElapsedTime { wall, cpu })
}
