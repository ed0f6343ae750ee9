//! The library's main entry point: renders a sequence into files.

use crate::base::cancel::Stop;
use crate::base::clock::TimeSource;
use crate::base::machine;
use crate::base::stats::{Counts, ProgressMeter};
use crate::base::units;
use crate::camera::path::NoCamera;
use crate::encode::{
    EncodeError, EncodeJob, Encoder, Existing, FrameKey, Output, Report, SequenceInfo, StillFormat,
    TimeBudget,
};
use crate::film::{AovSet, Film, Noise};
use crate::pipeline::memory;
use crate::pipeline::plan::{
    self, CostEstimate, FilmCache, FrameStates, Outlook, PilotBudget, PilotTime, Plan, Range, RayEstimate,
    RunForecast, SharedRun, evaluate, evaluate_until, run_pilot, run_shared,
};
use crate::pipeline::schedule::{FilmSink, FrameError, FrameLoop, FrameStage, FrameState, Stats};
use crate::sequence::Sequence;
use crate::sequence::quality::{NoiseTarget, Quality};
use rayon::ThreadPool;
use std::error::Error;
use std::fmt::{Display, Formatter};
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::time::{Duration, Instant};

/// Frames to render, and the files to write.
#[derive(Clone, Debug)]
pub struct Request {
    /// Frame numbers in the order of rendering and playback.
    pub frames: Vec<u32>,
    pub outputs: Vec<Output>,
    /// Whether outputs must stay within the working directory after links are followed. This holds for outputs that a
    /// sequence names, because sequences may come from others.
    pub confined: bool,
    pub existing: Existing,
    /// Number of tracing threads. If absent, one for each processor of the machine.
    pub threads: Option<NonZeroUsize>,
    pub reuse: Reuse,
    /// The time limit that determined the number of samples, if any. It is written into metadata.
    pub time_limit: Option<Duration>,
}

impl Request {
    /// All frames of a sequence into these outputs, on all processors. Frames that exist and are current are kept.
    pub fn new(sequence: &Sequence, outputs: Vec<Output>) -> Self {
        Self {
            frames: (0..sequence.timeline.frames).collect(),
            outputs,
            confined: false,
            existing: Existing::default(),
            threads: None,
            reuse: Reuse::default(),
            time_limit: None,
        }
    }

    fn limit(&self) -> Option<TimeBudget> {
        self.time_limit.map(|time| TimeBudget { time, frames: self.frames.len() as u32 })
    }
}

/// Memory limit of the film cache. It never changes a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reuse {
    /// Each frame is traced separately.
    Off,
    /// A share of the free memory.
    #[default]
    Share,
    Within(u64),
}

impl Reuse {
    /// The limit in bytes for films of this sequence.
    pub fn budget(self, sequence: &Sequence, aovs: AovSet) -> u64 {
        match self {
            Self::Off => 0,
            Self::Share => memory::for_films(sequence, aovs),
            Self::Within(bytes) => bytes,
        }
    }
}

/// Results of a run.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    pub frames: u32,
    /// Frames that existed, were valid, and were kept.
    pub kept: u32,
    /// Frames that reused the film of another frame.
    pub reused: u32,
    pub counts: Counts,
    /// Number of times that the top-level tree was built, and that it was refitted instead.
    pub bvh_builds: u64,
    pub bvh_refits: u64,
    /// The forecast, if there was a plan.
    pub expected: Option<Forecast>,
    /// Error of each frame that was sampled towards a target error.
    pub noise: Vec<(u32, Noise)>,
    /// Processor time of tracing in seconds, over all threads. None if the system does not measure it.
    pub cpu: Option<f64>,
    /// Wall time of each stage, in order. Encoding runs in parallel with the others.
    pub stages: Vec<(&'static str, Duration)>,
    pub elapsed: Duration,
    /// Written files: a pattern or a file for each output.
    pub files: Vec<PathBuf>,
    /// Notes for the user.
    pub notes: Vec<String>,
}

/// Forecast of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    pub reused: u32,
    pub camera_rays: u64,
    /// Whether `camera_rays` is exact. It is not if frames are sampled towards a target error.
    pub exact: bool,
    /// Rays of all kinds, if a pilot was traced.
    pub rays: Option<u64>,
    /// Number of times that the top-level tree is built or refitted.
    pub bvh_updates: u64,
    /// Wall time and processor time of tracing in seconds, and the error of the worst film as a share of the mean
    /// brightness. None without a pilot.
    pub wall: Option<Range>,
    pub cpu: Option<Range>,
    /// Processor time of the pilot in seconds.
    pub pilot: f64,
    pub error: Option<Range>,
}

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

/// Data that may not fit into memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MemoryUse {
    Picture,
    Filmstrip,
    /// Pictures of several settings that are compared.
    Measurement,
}

impl MemoryUse {
    /// Returns an error if `needed` bytes exceed the free memory.
    pub(crate) fn check(self, needed: u64) -> Result<(), RenderError> {
        let available = machine::free_memory();
        if needed > available {
            return Err(RenderError::TooLarge { what: self, needed, available });
        }
        Ok(())
    }
}

/// Why a run stopped.
#[derive(Debug)]
pub enum RenderError {
    Encode(EncodeError),
    /// Bytes needed and bytes available.
    TooLarge {
        what: MemoryUse,
        needed: u64,
        available: u64,
    },
    /// A signal arrived after `done` frames; `files` were written.
    Stopped {
        signal: usize,
        done: usize,
        files: Vec<PathBuf>,
        /// Frames that were not rendered.
        rest: Vec<u32>,
        /// Whether the next run keeps the existing frames.
        keeps: bool,
    },
    /// The thread pool could not be started.
    Threads(String),
    /// A frame has no camera.
    Camera {
        frame: u32,
        why: NoCamera,
    },
}

impl From<EncodeError> for RenderError {
    fn from(error: EncodeError) -> Self {
        Self::Encode(error)
    }
}

impl From<FrameError> for RenderError {
    fn from(error: FrameError) -> Self {
        match error {
            FrameError::Camera { frame, why } => Self::Camera { frame, why },
            FrameError::Encode(error) => Self::Encode(error),
        }
    }
}

impl FilmSink for Encoder {
    fn push(&mut self, frame: u32, film: Film) -> Result<(), EncodeError> {
        Self::push(self, frame, film)
    }
}

impl Display for RenderError {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Encode(error) => error.fmt(f),
            Self::TooLarge { what, needed, available } => {
                let (what, mend) = match what {
                    MemoryUse::Picture => (
                        "the picture needs",
                        "make it smaller with --size, such as 1280x720, or with --draft",
                    ),
                    MemoryUse::Filmstrip => {
                        ("the filmstrip needs", "show fewer frames, or make them smaller, such as 320x200")
                    }
                    MemoryUse::Measurement => (
                        "to compare pictures of this size needs",
                        "measure smaller ones with --size, such as 320x200, or fewer frames",
                    ),
                };
                let (needed, available) = (units::bytes(*needed), units::bytes(*available));
                write!(f, "{what} {needed} of memory and there are {available}; {mend}")
            }
            Self::Camera { frame, why } => write!(f, "frame {frame} has no camera: {why}"),
            Self::Stopped { done, .. } => {
                write!(f, "stopped after {}", units::counted(*done as u64, "frame"))
            }
            Self::Threads(why) => write!(f, "cannot start the threads: {why}; try fewer with --threads"),
        }
    }
}

impl Error for RenderError {}

/// Renders the requested frames. Another thread may watch `meter` meanwhile.
pub fn render(
    sequence: &Sequence,
    request: &Request,
    meter: &Arc<ProgressMeter>,
) -> Result<Summary, RenderError> {
    render_until(sequence, request, meter, &Stop::default())
}

/// [`render`], which stops when `stop` is set: after the current frame, or with the current samples if a target error
/// is set. Written stills remain. Unfinished animations, and frames that miss their target error, are closed under a
/// name beside the final one.
pub fn render_until(
    sequence: &Sequence,
    request: &Request,
    meter: &Arc<ProgressMeter>,
    stop: &Stop,
) -> Result<Summary, RenderError> {
    render_with_notices(sequence, request, meter, stop, &|_| ())
}

/// [`render_until`], which also calls `notify` with a forecast if the run is long enough for a pilot.
pub fn render_with_notices(
    sequence: &Sequence,
    request: &Request,
    meter: &Arc<ProgressMeter>,
    stop: &Stop,
    notify: Listener,
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
    (stop, notify): (&Stop, Listener),
) -> Result<Summary, RenderError> {
    let start = Instant::now();
    let _ = meter.stop.set(stop.clone());
    let aovs = requested_aovs(sequence, &request.outputs);
    MemoryUse::Picture.check(memory::needed(sequence, aovs))?;
    let pool = Arc::new(pool(request.threads)?);
    let states = pool.install(|| evaluate_until(sequence, &request.frames, stop));
    let job = job(sequence, request, &states);
    let keeps = job.can_keep_frames();
    if let Some(signal) = stop.signal().filter(|_| states.frames.len() < request.frames.len()) {
        let rest = request.frames.clone();
        return Err(RenderError::Stopped { signal, done: 0, files: Vec::new(), rest, keeps });
    }
    let encoder = Encoder::start(job, Arc::clone(&pool), stop)?;
    let missing = encoder.missing();
    meter.frames.fetch_add((request.frames.len() - missing.len()) as u32, Relaxed);
    let mut frames = FrameLoop::with_aovs(sequence, aovs, encoder, Arc::clone(meter));
    let before = machine::cpu_time();
    let states = states.only(&missing);
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
    let report = encoder.map_or_else(|| Ok(Report::default()), Encoder::finish)?;
    let mut summary = summary(&stats, report, request.frames.len() as u32, start.elapsed());
    summary.cpu = cpu.map(|cpu| cpu - expected.map_or(0.0, |expected| expected.pilot));
    summary.expected = expected;
    summary.notes.splice(..0, sequence.notes());
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
    (meter, stop, notify): (&ProgressMeter, &Stop, Listener),
) -> Result<(usize, Option<Forecast>), FrameError> {
    let on = || stop.signal().is_none();
    let kept = request.frames.len() - missing.frames.len();
    if request.reuse == Reuse::Off {
        meter.begin(kept, Vec::new());
        let mut done = 0;
        missing.frames.iter().take_while(|_| on()).try_for_each(|state| {
            frames.trace_alone(state)?;
            done += usize::from(!meter.unfinished.load(Relaxed));
            Ok::<_, FrameError>(())
        })?;
        return Ok((done, None));
    }
    let aovs = requested_aovs(sequence, &request.outputs);
    let budget = request.reuse.budget(sequence, aovs);
    let plan = Plan::from_states(missing, sequence, aovs, budget);
    let known = RayEstimate::of(sequence, &plan);
    let worth = if known.exact { WORTH_A_PILOT } else { WORTH_WITH_ERROR };
    let CostEstimate { films, .. } = plan::cost_estimate(sequence, &plan, PilotBudget::NONE);
    let (mut films, mut forecast) = (films, Forecast::of(&plan, &known));
    // A time limit already implies a pilot.
    if known.camera >= worth && request.time_limit.is_none() {
        notify(Notice::Pilot { plan: &plan });
        let outlook = run_pilot(sequence, &plan, aovs, PilotTime::RUN, TimeSource::Machine);
        let run = outlook.forecast(&sequence.quality);
        films = run.films.iter().map(|film| film.took.wall).collect();
        forecast = Forecast { pilot: outlook.spent.cpu.unwrap_or_default(), ..forecast.with(&run) };
        notify(Notice::Outlook { plan: &plan, outlook: &outlook });
    }
    meter.begin(kept, films);
    Ok((plan::run(&plan, frames, on)?, Some(forecast)))
}

impl Forecast {
    /// The forecast without a pilot.
    fn of(plan: &Plan, known: &RayEstimate) -> Self {
        Self {
            reused: plan.reused() as u32,
            camera_rays: known.camera,
            exact: known.exact,
            rays: None,
            bvh_updates: plan.bvh_updates(),
            wall: None,
            cpu: None,
            pilot: 0.0,
            error: None,
        }
    }

    fn with(self, run: &RunForecast) -> Self {
        Self {
            camera_rays: if self.exact { self.camera_rays } else { run.camera as u64 },
            rays: Some(run.rays as u64),
            wall: Some(run.wall),
            cpu: run.cpu,
            error: run.error,
            ..self
        }
    }
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
    let cache = FilmCache::of(sequence, aovs, request.reuse.budget(sequence, aovs));
    meter.begin(request.frames.len() - states.frames.len(), Vec::new());
    let there = |others: usize| {
        meter.frames.fetch_add(others as u32, Relaxed);
    };
    let on = || stop.signal().is_none();
    let SharedRun { done, complete } = run_shared(states, cache, frames, on, there)?;
    Ok((if complete { states.frames.len() } else { done }, None))
}

/// Checks for everything that would stop a render before its first frame: pictures too large for memory, and outputs
/// that cannot be written. Changes nothing on disk.
pub fn check(sequence: &Sequence, request: &Request) -> Result<(), RenderError> {
    let aovs = requested_aovs(sequence, &request.outputs);
    MemoryUse::Picture.check(memory::needed(sequence, aovs))?;
    Ok(job(sequence, request, &FrameStates::default()).check().map_err(EncodeError::from)?)
}

/// The pool of tracing threads.
pub(crate) fn pool(threads: Option<NonZeroUsize>) -> Result<ThreadPool, RenderError> {
    let threads = threads.map_or(0, NonZeroUsize::get);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|error| RenderError::Threads(error.to_string()))
}

/// The quality of frames that an earlier run with the same time limit rendered. None if no valid frame exists that
/// this quality would render identically.
pub fn existing_quality(sequence: &Sequence, request: &Request) -> Option<Quality> {
    if request.existing != Existing::Keep {
        return None;
    }
    let counts = job(sequence, request, &FrameStates::default()).earlier_sample_counts();
    let qualities = counts.into_iter().map(|(samples, antialias)| Quality {
        samples,
        antialias,
        noise: sequence.quality.noise.map(|target| NoiseTarget { most: samples, ..target }),
        ..sequence.quality
    });
    qualities.into_iter().find(|&quality| {
        let sequence = Sequence { quality, ..sequence.clone() };
        job(&sequence, request, &evaluate(&sequence, &request.frames)).can_keep_any()
    })
}

pub(crate) fn job(sequence: &Sequence, request: &Request, states: &FrameStates) -> EncodeJob {
    let output = &sequence.output;
    // Frame states identify existing frames.
    let frame_key = |state: &FrameState| FrameKey {
        radiance: state.radiance,
        film: state.film(),
        exposure: state.exposure,
        random: state.random,
    };
    EncodeJob {
        outputs: request.outputs.clone(),
        confined: request.confined,
        existing: request.existing,
        frames: request.frames.clone(),
        frame_keys: states.frames.iter().map(frame_key).collect(),
        rate: sequence.timeline.rate,
        size: output.size,
        tonemap: output.tonemap,
        transparent: output.transparent,
        background_color: output.background_color,
        caption: output.caption.clone(),
        formats: output.formats,
        info: SequenceInfo { time_limit: request.limit(), ..sequence.about() },
    }
}

/// The layers besides light that these outputs need.
pub(crate) fn requested_aovs(sequence: &Sequence, outputs: &[Output]) -> AovSet {
    let exr = outputs.iter().any(|output| matches!(output, Output::Stills(StillFormat::Exr, _)));
    let features = exr && sequence.output.formats.exr.layers.need_features();
    AovSet { coverage: sequence.output.transparent, features }
}

/// Summarises a run.
pub(crate) fn summary(stats: &Stats, report: Report, frames: u32, elapsed: Duration) -> Summary {
    // The frame loop only waits for the encoder, so the encoder's own time counts.
    let time = |stage| if stage == FrameStage::Encode { report.busy } else { stats.stages[stage as usize] };
    Summary {
        frames,
        kept: report.kept,
        reused: stats.reused,
        expected: None,
        counts: stats.counts,
        bvh_builds: stats.bvh_builds,
        bvh_refits: stats.bvh_refits,
        noise: report.noise,
        cpu: None,
        stages: FrameStage::ALL.map(|stage| (stage.name(), time(stage))).to_vec(),
        elapsed,
        files: report.files,
        notes: report.notes,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_that_exceed_memory_suggest_a_size() {
        for (what, parts) in [
            (MemoryUse::Picture, ["the picture", "--size", "--draft"]),
            (MemoryUse::Filmstrip, ["the filmstrip", "fewer frames", "320x200"]),
            (MemoryUse::Measurement, ["to compare", "--size", "fewer frames"]),
        ] {
            let text = RenderError::TooLarge { what, needed: 48_000_000_000, available: 8_100_000_000 };
            let text = text.to_string();
            assert!(text.contains("48.0 GB") && text.contains("8.10 GB"), "{text}");
            assert!(parts.iter().all(|part| text.contains(part)), "{text}");
        }
        assert!(matches!(MemoryUse::Picture.check(u64::MAX), Err(RenderError::TooLarge { .. })));
        assert!(MemoryUse::Picture.check(1).is_ok());
    }
}
