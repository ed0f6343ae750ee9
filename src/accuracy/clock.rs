//! How long something takes: on the wall, and in time of processors, which others on the machine disturb less.

use crate::machine::processor_time;
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

/// Does something and tells how long it took.
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, Took) {
    let (start, before) = (Instant::now(), processor_time());
    let done = work();
    let wall = start.elapsed().as_secs_f64();
    let cpu = processor_time().zip(before).map(|(after, before)| after - before);
    (done, Took { wall, cpu })
}
