//! How many samples fit into a time: a pilot tells what samples cost, and what error they leave.

use super::clock::Clock;
use crate::pipeline::plan::{Outlook, Patience, Plan, look_ahead};
use crate::pipeline::render::{RenderError, Request, extras, pool};
use crate::sequence::Sequence;
use crate::sequence::quality::{NoiseTarget, Quality};
use std::time::Duration;

/// Samples that fit, and what to expect of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// With as many samples as fit: random ones, or on a grid where nothing is random. If there is an error to reach, they
    /// are the most that a pixel may have.
    pub quality: Quality,
    /// Seconds that tracing all films should take.
    pub wall: f64,
    /// Of all processors together, where the system tells.
    pub cpu: Option<f64>,
    /// Expected of the worst frame, as a share of brightness; none where nothing is random.
    pub error: Option<f64>,
    /// Seconds that the pilot took.
    pub spent: f64,
    /// Whether it is the error that ends the run, and not the time.
    pub reached: bool,
}

/// Share of the time that may be spent on finding out.
const SHARE: f64 = 0.08;

/// The time of an error is known to about this share. What is longer than the limit without it ends at the limit.
const DOUBT: f64 = 0.15;

/// Finds how many samples fit into `limit` of tracing the frames of `request`, the pilot included. If the sequence has an
/// error to reach, these are the most that a pixel may have, unless the error is reached before the limit.
pub fn budget(
    sequence: &Sequence,
    request: &Request,
    limit: Duration,
    clock: Clock,
) -> Result<Budget, RenderError> {
    let limit = limit.as_secs_f64();
    let extras = extras(sequence, &request.outputs);
    let room = request.reuse.budget(sequence, extras);
    let patience = Patience { seconds: SHARE * limit, share: f64::INFINITY };
    let outlook = pool(request.threads)?.install(|| {
        let plan = Plan::new(sequence, &request.frames, extras, room);
        look_ahead(sequence, &plan, extras, patience, clock)
    });
    let spent = outlook.spent.wall;
    let (quality, reached) = settle(&outlook, &sequence.quality, limit - spent);
    let forecast = outlook.forecast(&quality);
    Ok(Budget {
        quality,
        wall: forecast.wall.mid,
        cpu: forecast.cpu.map(|cpu| cpu.mid),
        error: forecast.error.map(|error| error.mid),
        spent,
        reached,
    })
}

/// The samples for so many seconds, and whether the error is reached before.
fn settle(outlook: &Outlook, own: &Quality, seconds: f64) -> (Quality, bool) {
    let fitting = outlook.fitting(own, seconds);
    let Some(target) = own.noise.filter(|_| outlook.is_random()) else { return (fitting, false) };
    let free = outlook.forecast(own);
    let reached = free.missed == 0 && (1.0 + DOUBT) * free.wall.mid <= seconds;
    let most = if reached { target.most } else { fitting.samples.min(target.most) };
    // Files tell `samples`.
    (Quality { samples: most, noise: Some(NoiseTarget { most, ..target }), ..*own }, reached)
}
