//! The number of samples that fit into a time limit. A pilot measures what samples cost and what error they leave.

use crate::base::clock::TimeSource;
use crate::pipeline::plan::{Outlook, PilotTime, Plan, run_pilot};
use crate::pipeline::render::{RenderError, Request, pool, requested_aovs};
use crate::sequence::Sequence;
use crate::sequence::quality::{NoiseTarget, Quality};
use std::time::Duration;

/// The samples that fit into a time limit, and the predicted time and error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// The file's quality with as many samples as fit: random samples or, if nothing is random, a grid. With a noise
    /// target, this number is the limit per pixel.
    pub quality: Quality,
    /// Predicted wall time of tracing all films, in seconds.
    pub wall: f64,
    /// Predicted processor time of all threads, in seconds, if the system reports processor times.
    pub cpu: Option<f64>,
    /// Predicted error of the worst frame, as a share of its brightness; `None` if nothing is random.
    pub error: Option<f64>,
    /// Wall time of the pilot, in seconds.
    pub spent: f64,
    /// Whether the noise target ends the run, rather than the time limit.
    pub reached: bool,
}

/// Share of the time limit that the pilot may take.
const PILOT_SHARE: f64 = 0.08;

/// Relative uncertainty of the predicted time of a noise target. The target counts as reached in time only if the
/// prediction fits into the limit with this margin.
const TIME_UNCERTAINTY: f64 = 0.15;

/// Finds how many samples fit if tracing the frames of `request` may take `limit`, the pilot included. If the
/// sequence has a noise target that takes longer, this number becomes the limit per pixel.
pub fn budget(
    sequence: &Sequence,
    request: &Request,
    limit: Duration,
    clock: TimeSource,
) -> Result<Budget, RenderError> {
    let limit = limit.as_secs_f64();
    let aovs = requested_aovs(sequence, &request.outputs);
    let room = request.reuse.budget(sequence, aovs);
    let patience = PilotTime { seconds: PILOT_SHARE * limit, share: f64::INFINITY };
    let outlook = pool(request.threads)?.install(|| {
        let plan = Plan::new(sequence, &request.frames, aovs, room).without_shared_paths();
        run_pilot(sequence, &plan, aovs, patience, clock)
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

/// The quality that fits into `seconds`, and whether the noise target is reached before.
fn settle(outlook: &Outlook, own: &Quality, seconds: f64) -> (Quality, bool) {
    let fitting = outlook.fitting(own, seconds);
    let Some(target) = own.noise.filter(|_| outlook.is_random()) else { return (fitting, false) };
    let free = outlook.forecast(own);
    let reached = free.missed == 0 && (1.0 + TIME_UNCERTAINTY) * free.wall.mid <= seconds;
    let most = if reached { target.most } else { fitting.samples.min(target.most) };
    // Frame files record `samples`.
    (Quality { samples: most, noise: Some(NoiseTarget { most, ..target }), ..*own }, reached)
}
