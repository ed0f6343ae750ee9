//! How many samples a run with a limit of time has: settled once, told by its frames, and kept by whoever goes on with it.

use super::budget::{Budget, budget};
use super::clock::Clock;
use crate::pipeline::render::{self, RenderError, Request};
use crate::sequence::Sequence;
use crate::sequence::quality::Quality;
use std::time::Duration;

/// How many samples a run has, and who says so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Settled {
    /// Frames that are there, of an earlier run with the same limit over as many frames.
    Before(Quality),
    /// A pilot.
    Now(Budget),
}

impl Settled {
    pub fn quality(&self) -> Quality {
        match self {
            Self::Before(quality) => *quality,
            Self::Now(budget) => budget.quality,
        }
    }
}

/// Settles how many samples the frames of `request` have that are to take `limit` together.
///
/// Frames that tell of an earlier choice hold to it, so that all have the same number and none is made twice, whatever the
/// machine would choose now.
pub fn settled(
    sequence: &Sequence,
    request: &Request,
    limit: Duration,
    clock: Clock,
) -> Result<Settled, RenderError> {
    let request = Request { time_limit: Some(limit), ..request.clone() };
    match render::settled(sequence, &request) {
        Some(quality) => Ok(Settled::Before(quality)),
        None => budget(sequence, &request, limit, clock).map(Settled::Now),
    }
}
