//! How long something takes: on the wall, and in time of processors, which others on the machine disturb less.

use crate::base::machine::processor_time;
use std::ops::{Add, Mul, Sub};
use std::time::Instant;

/// By what tracing is timed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Clock {
    /// The machine's clocks.
    #[default]
    Machine,
    /// As if every ray took so many seconds, and nothing else any: the same on all machines.
    Rays(f64),
}

/// Seconds that went by.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Took {
    pub wall: f64,
    /// Of all threads together; none where the system does not tell.
    pub cpu: Option<f64>,
}

impl Clock {
    /// What this clock says of work that took so long and so many rays.
    pub fn told(self, took: Took, rays: u64) -> Took {
        match self {
            Self::Machine => took,
            Self::Rays(each) => {
                let seconds = each * rays as f64;
                Took { wall: seconds, cpu: Some(seconds) }
            }
        }
    }
}

impl Took {
    /// No time at all, on a machine that tells the time of processors.
    pub const ZERO: Self = Self { wall: 0.0, cpu: Some(0.0) };

    /// What one thread alone is at work, however busy the machine is: the processors' time, unless several threads shared
    /// the work.
    pub fn alone(self) -> f64 {
        self.cpu.map_or(self.wall, |cpu| cpu.min(self.wall))
    }

    /// What so many threads are at work together.
    pub fn on(self, threads: usize) -> f64 {
        self.cpu.map_or(self.wall, |cpu| cpu / threads as f64)
    }
}

impl Add for Took {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { wall: self.wall + other.wall, cpu: self.cpu.zip(other.cpu).map(|(a, b)| a + b) }
    }
}

impl Mul<f64> for Took {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self { wall: factor * self.wall, cpu: self.cpu.map(|cpu| factor * cpu) }
    }
}

impl Sub for Took {
    type Output = Self;

    /// What is left without a part of it.
    fn sub(self, part: Self) -> Self {
        let cpu = self.cpu.zip(part.cpu).map(|(all, part)| (all - part).max(0.0));
        Self { wall: (self.wall - part.wall).max(0.0), cpu }
    }
}

/// Does something and tells how long it took.
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, Took) {
    let (start, before) = (Instant::now(), processor_time());
    let done = work();
    let wall = start.elapsed().as_secs_f64();
    let cpu = processor_time().zip(before).map(|(after, before)| after - before);
    (done, Took { wall, cpu })
}
