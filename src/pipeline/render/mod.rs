//! The library's main entry point: renders a sequence into files.

mod error;
mod job;
mod request;
mod summary;

pub use error::{MemoryUse, RenderError};
pub use job::existing_quality;
pub(crate) use job::{job, requested_aovs};
pub use request::{Request, Reuse};
pub(crate) use summary::summary;
pub use summary::{Forecast, Summary};

use crate::base::cancel::Stop;
use crate::base::clock::TimeSource;
use crate::base::machine;
use crate::base::stats::ProgressMeter;
use crate::encode::{EncodeError, Encoder, Existing, Report};
use crate::film::Film;
use crate::pipeline::memory;
use crate::pipeline::plan::{
    self, CostEstimate, FrameStates, Outlook, PilotBudget, PilotTime, Plan, RayEstimate, SharedRun,
    evaluate_until, run_pilot, run_shared,
};
use crate::pipeline::schedule::{FilmSink, FrameError, FrameLoop};
use crate::sequence::Sequence;
use rayon::ThreadPool;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::time::Instant;
use tracing::info_span;

/// Events before the first frame of a run.
#[derive(Clone, Copy, Debug)]
pub enum Notice<'a> {
    /// A pilot begins, because the run may take long.
    Pilot { plan: &'a Plan },
    /// The pilot has finished.
    Outlook { plan: &'a Plan, outlook: &'a Outlook },
}

/// A callback for notices.
pub type Listener<'a> = &'a (dyn Fn(Notice) + Sync);

impl FilmSink for Encoder {
    fn push(&mut self, frame: u32, film: Film) -> Result<(), EncodeError> {
        Self::push(self, frame, film)
    }
}

/// Renders the requested frames. Another thread may watch `meter` meanwhile.
#[warn(missing_docs)]
pub fn render(
    sequence: &Sequence,
    request: &Request,
    meter: &Arc<ProgressMeter>,
) -> Result<Summary, RenderError> {
    render_until(sequence, request, meter, &Stop::default())
}

/// [`render`], which stops when `stop` is set: after the current frame, or with the current samples if a target error
/// is set. There is no pilot, so the summary has no predicted time. Written stills remain. Unfinished animations, and
/// frames that miss their target error, are closed under a name beside the final one.
pub fn render_until(
    sequence: &Sequence,
    request: &Request,
    meter: &Arc<ProgressMeter>,
    stop: &Stop,
) -> Result<Summary, RenderError> {
    render_with_notices(sequence, request, meter, stop, None)
}

/// [`render_until`], which also calls `notify` with a forecast if the run is long enough for a pilot. Without a listener
/// there is no pilot.
pub fn render_with_notices(
    sequence: &Sequence,
    request: &Request,
    meter: &Arc<ProgressMeter>,
    stop: &Stop,
    notify: Option<Listener>,
) -> Result<Summary, RenderError> {
    render_frames(sequence, request, meter, (stop, notify)).map_err(|error| match error {
        RenderError::Encode(EncodeError::Interrupted { signal, done }) => {
            let rest = request.frames.get(done..).unwrap_or_default().to_vec();
            let keeps = job(sequence, request, &FrameStates::default()).can_keep_frames();
            RenderError::Stopped { signal, done, files: Vec::new(), rest, keeps }
        }
        error => error,
    })
}

fn render_frames(
    sequence: &Sequence,
    request: &Request,
    meter: &Arc<ProgressMeter>,
    (stop, notify): (&Stop, Option<Listener>),
) -> Result<Summary, RenderError> {
    let start = Instant::now();
    let _ = meter.stop.set(stop.clone());
    let aovs = requested_aovs(sequence, &request.outputs);
    MemoryUse::Picture.check(memory::needed(sequence, aovs))?;
    let pool = Arc::new(pool(request.threads)?);
    let states =
        info_span!("evaluate").in_scope(|| pool.install(|| evaluate_until(sequence, &request.frames, stop)));
    let job = pool.install(|| job(sequence, request, &states));
    let keeps = job.can_keep_frames();
    if let Some(signal) = stop.signal().filter(|_| states.frames.len() < request.frames.len()) {
        let rest = request.frames.clone();
        return Err(RenderError::Stopped { signal, done: 0, files: Vec::new(), rest, keeps });
    }
    let encoder = info_span!("prepare outputs").in_scope(|| Encoder::start(job, Arc::clone(&pool), stop))?;
    let missing = encoder.missing();
    meter.frames.fetch_add((request.frames.len() - missing.len()) as u32, Relaxed);
    let mut frames = FrameLoop::with_aovs(sequence, aovs, encoder, Arc::clone(meter));
    frames.report_frames();
    let before = machine::cpu_time();
    let states = states.only(&missing);
    let neighbors = states.neighbors_note();
    let (done, expected) = pool.install(|| match request.existing {
        Existing::Share => render_shared(sequence, request, &states, &mut frames, (meter, stop)),
        _ => render_planned(sequence, request, states, &mut frames, (meter, stop, notify)),
    })?;
    let after = machine::cpu_time();
    if let Some(signal) = stop.signal().filter(|_| done < missing.len()) {
        let report = frames.into_sink().map_or_else(|| Ok(Report::default()), Encoder::stop)?;
        let rest = missing[done..].to_vec();
        return Err(RenderError::Stopped { signal, done, files: report.files, rest, keeps });
    }
    let stats = frames.stats().clone();
    let encoder = frames.into_sink();
    let encoding = encoder.as_ref().and_then(Encoder::cpu);
    let cpu = after.zip(before).zip(encoding).map(|((after, before), encoding)| after - before - encoding);
    let report = info_span!("wait for files")
        .in_scope(|| encoder.map_or_else(|| Ok(Report::default()), Encoder::finish))?;
    let mut summary = summary(&stats, report, request.frames.len() as u32, start.elapsed());
    summary.cpu = cpu.map(|cpu| cpu - expected.map_or(0.0, |expected| expected.pilot));
    summary.expected = expected;
    summary.notes.splice(..0, sequence.notes().into_iter().chain(neighbors));
    Ok(summary)
}

/// Minimum camera samples of a run for which a pilot pays off. The second limit is for runs with a target error, whose
/// lower bound may be far below the real number.
const WORTH_A_PILOT: u64 = 1 << 23;
const WORTH_WITH_ERROR: u64 = 1 << 17;

/// Renders the missing frames by a plan, or separately. Returns the number of frames that it began.
fn render_planned<S: FilmSink>(
    sequence: &Sequence,
    request: &Request,
    missing: FrameStates,
    frames: &mut FrameLoop<S>,
    (meter, stop, notify): (&ProgressMeter, &Stop, Option<Listener>),
) -> Result<(usize, Option<Forecast>), FrameError> {
    let on = || stop.signal().is_none();
    let kept = request.frames.len() - missing.frames.len();
    if request.reuse == Reuse::Off {
        meter.begin(kept, Vec::new());
        let mut done = 0;
        missing.frames.iter().take_while(|_| on()).try_for_each(|state| {
            let _span = info_span!("frame", frame = state.frame).entered();
            let has_film = frames.trace_alone(state)?;
            done += usize::from(has_film && !meter.unfinished.load(Relaxed));
            Ok::<_, FrameError>(())
        })?;
        return Ok((done, None));
    }
    let aovs = requested_aovs(sequence, &request.outputs);
    let budget = request.reuse.budget(sequence, aovs);
    let mut plan = info_span!("plan").in_scope(|| Plan::from_states(missing, sequence, aovs, budget));
    if request.time_limit.is_some() {
        plan = plan.without_shared_paths();
    }
    let known = RayEstimate::of(sequence, &plan);
    let worth = if known.exact || known.shares_views { WORTH_A_PILOT } else { WORTH_WITH_ERROR };
    let CostEstimate { films, .. } = plan::cost_estimate(sequence, &plan, PilotBudget::NONE);
    let (mut films, mut forecast) = (films, Forecast::of(&plan, &known));
    // A time limit already implies a pilot.
    if let Some(notify) = notify.filter(|_| known.camera >= worth && request.time_limit.is_none()) {
        notify(Notice::Pilot { plan: &plan });
        let limit = PilotTime::of_run(&sequence.quality);
        let outlook =
            info_span!("pilot").in_scope(|| run_pilot(sequence, &plan, aovs, limit, TimeSource::Machine));
        let run = outlook.forecast(&sequence.quality);
        films = run.films.iter().map(|film| film.took.wall).collect();
        forecast = Forecast { pilot: outlook.spent.cpu.unwrap_or_default(), ..forecast.with(&run) };
        notify(Notice::Outlook { plan: &plan, outlook: &outlook });
    }
    meter.begin(kept, films);
    Ok((plan::run(&plan, frames, on)?, Some(forecast)))
}

/// Renders the missing frames that no other process renders. Returns the number of frames that it began, or of all
/// frames if all exist now.
fn render_shared(
    sequence: &Sequence,
    request: &Request,
    states: &FrameStates,
    frames: &mut FrameLoop<Encoder>,
    (meter, stop): (&ProgressMeter, &Stop),
) -> Result<(usize, Option<Forecast>), FrameError> {
    let aovs = requested_aovs(sequence, &request.outputs);
    let plan = (sequence, aovs, request.reuse.budget(sequence, aovs));
    meter.begin(request.frames.len() - states.frames.len(), Vec::new());
    let there = |others: usize| {
        meter.frames.fetch_add(others as u32, Relaxed);
    };
    let on = || stop.signal().is_none();
    let SharedRun { done, complete } = run_shared(states, plan, frames, on, there)?;
    Ok((if complete { states.frames.len() } else { done }, None))
}

/// Checks for everything that would stop a render before its first frame: pictures too large for memory, and outputs
/// that cannot be written. Changes nothing on disk.
pub fn check(sequence: &Sequence, request: &Request) -> Result<(), RenderError> {
    let aovs = requested_aovs(sequence, &request.outputs);
    MemoryUse::Picture.check(memory::needed(sequence, aovs))?;
    Ok(job(sequence, request, &FrameStates::default()).check().map_err(EncodeError::from)?)
}

/// Bytes of stack of a tracing thread. Unoptimized kernels need more than the 2 MiB that threads have otherwise.
const STACK: usize = 8 << 20;

/// The pool of tracing threads.
pub(crate) fn pool(threads: Option<NonZeroUsize>) -> Result<ThreadPool, RenderError> {
    let threads = threads.map_or(0, NonZeroUsize::get);
    let name = |index: usize| format!("render {index}");
    let pool =
        rayon::ThreadPoolBuilder::new().num_threads(threads).thread_name(name).stack_size(STACK).build();
    pool.map_err(|error| RenderError::Threads(error.to_string()))
}
