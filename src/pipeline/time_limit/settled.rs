//! The number of samples of a run with a time limit. A pilot settles it once, the frames record it, and later runs
//! with the same limit reuse it.

use super::budget::{Budget, budget};
use crate::base::clock::TimeSource;
use crate::pipeline::render::{self, RenderError, Request};
use crate::sequence::Sequence;
use crate::sequence::quality::Quality;
use std::time::Duration;

/// The quality that a run with a time limit renders with, by its origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Settled {
    /// Read from existing frames of an earlier run with the same limit and as many frames.
    Before(Quality),
    /// Found by a pilot.
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

/// Settles the number of samples with which all frames of `request` together take about `limit`.
///
/// If existing frames record an earlier choice, that choice is reused, even if this machine would choose another one:
/// so all frames have the same number of samples, and none is rendered twice.
pub fn settled(
    sequence: &Sequence,
    request: &Request,
    limit: Duration,
    clock: TimeSource,
) -> Result<Settled, RenderError> {
    let request = Request { time_limit: Some(limit), ..request.clone() };
    match render::existing_quality(sequence, &request) {
        Some(quality) => Ok(Settled::Before(quality)),
        None => budget(sequence, &request, limit, clock).map(Settled::Now),
    }
}
