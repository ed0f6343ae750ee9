//! The library's front door: a sequence in, files out.

use crate::base::cancel::Stop;
use crate::base::clock::Clock;
use crate::base::machine;
use crate::base::stats::{Counts, Meter};
use crate::base::units;
use crate::camera::path::NoCamera;
use crate::encode::{About, EncodeError, Encoder, Existing, Job, Output, Report, Seen, Still, TimeLimit};
use crate::film::{Extras, Film, Noise};
use crate::pipeline::memory;
use crate::pipeline::plan::{
    self, Effort, Expected, Outlook, Patience, Plan, Range, Room, RunForecast, Shared, Survey, Work,
    look_ahead, run_shared, survey, survey_until,
};
use crate::pipeline::schedule::{FilmSink, FrameLoop, Look, NoFrame, Stage, Tally};
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

/// What to render of a sequence, and where to.
#[derive(Clone, Debug)]
pub struct Request {
    /// Frame numbers in the order in which they are rendered and shown.
    pub frames: Vec<u32>,
    pub outputs: Vec<Output>,
    /// Whether these stay within the working directory, wherever links lead: those do that a sequence names, which may
    /// come from others.
    pub confined: bool,
    pub existing: Existing,
    /// Threads that trace; as many as the machine has if absent.
    pub threads: Option<NonZeroUsize>,
    pub reuse: Reuse,
    /// What settled how many samples the sequence has, if that was a limit of time: files tell it.
    pub time_limit: Option<Duration>,
}

impl Request {
    fn limit(&self) -> Option<TimeLimit> {
        self.time_limit.map(|time| TimeLimit { time, frames: self.frames.len() as u32 })
    }
}

/// How many bytes films may have that are kept, so that nothing is traced twice. It never shows in a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reuse {
    /// Every frame is traced by itself.
    Off,
    /// A share of what the machine has left.
    #[default]
    Share,
    Within(u64),
}

impl Reuse {
    /// The bytes of it for films of this sequence.
    pub fn budget(self, sequence: &Sequence, extras: Extras) -> u64 {
        match self {
            Self::Off => 0,
            Self::Share => memory::for_films(sequence, extras),
            Self::Within(bytes) => bytes,
        }
    }
}

/// What a run did.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    pub frames: u32,
    /// Those of them that were there, whole and right, and were left as they are.
    pub kept: u32,
    /// Those of them that were made of the film of another.
    pub reused: u32,
    pub counts: Counts,
    pub bvh_builds: u64,
    /// What was expected, if there was a plan.
    pub expected: Option<Forecast>,
    /// Frames that were sampled until they were good enough, and how good they are.
    pub noise: Vec<(u32, Noise)>,
    /// Seconds that tracing took of all processors together, where the system tells.
    pub cpu: Option<f64>,
    /// Wall time spent in each stage, in the order of the flow. Encoding runs beside the others.
    pub stages: Vec<(&'static str, Duration)>,
    pub elapsed: Duration,
    /// What was written: a pattern or a file per output.
    pub files: Vec<PathBuf>,
    /// What a user should know about the result.
    pub notes: Vec<String>,
}

/// What a plan says about a run before it begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    pub reused: u32,
    pub camera_rays: u64,
    /// Whether that is known exactly: not where samples are taken until an error is reached.
    pub exact: bool,
    /// Of all kinds, if it was worth a trial.
    pub rays: Option<u64>,
    pub bvh_builds: u64,
    /// Seconds of tracing, on the wall and of all processors together, and the error of the worst film, as a share of the
    /// mean brightness, if it was worth a pilot.
    pub wall: Option<Range>,
    pub cpu: Option<Range>,
    /// Seconds of all processors that the pilot itself took.
    pub pilot: f64,
    pub error: Option<Range>,
}

/// What a run says of itself before it traces its frames.
#[derive(Clone, Copy, Debug)]
pub enum Notice<'a> {
    /// A pilot begins, as the run may take long.
    Pilot { plan: &'a Plan },
    /// The pilot is over.
    Outlook { plan: &'a Plan, outlook: &'a Outlook },
}

/// Who hears of notices.
pub type Listener<'a> = &'a (dyn Fn(Notice) + Sync);

/// What may be too large for the memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Large {
    Picture,
    Filmstrip,
    /// Pictures of several settings, which are compared.
    Measurement,
}

impl Large {
    /// Refuses what takes so many bytes and does not fit into memory.
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
    /// It would not fit: bytes needed and bytes there are.
    TooLarge {
        what: Large,
        needed: u64,
        available: u64,
    },
    /// A signal came when so many frames were done; these files were written.
    Stopped {
        signal: usize,
        done: usize,
        files: Vec<PathBuf>,
        /// Frames that are still to come.
        rest: Vec<u32>,
        /// Whether a next run keeps the frames that are there.
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

impl From<NoFrame> for RenderError {
    fn from(error: NoFrame) -> Self {
        match error {
            NoFrame::Camera { frame, why } => Self::Camera { frame, why },
            NoFrame::Encode(error) => Self::Encode(error),
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
                    Large::Picture => (
                        "the picture needs",
                        "make it smaller with --size, such as 1280x720, or with --draft",
                    ),
                    Large::Filmstrip => {
                        ("the filmstrip needs", "show fewer frames, or make them smaller, such as 320x200")
                    }
                    Large::Measurement => (
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

/// Renders the requested frames. `meter` may be watched from another thread meanwhile.
pub fn render(sequence: &Sequence, request: &Request, meter: &Arc<Meter>) -> Result<Summary, RenderError> {
    render_until(sequence, request, meter, &Stop::default())
}

/// The same, but that it stops when it is asked to: after the frame in hand, or with the samples that this has if an error
/// is to be reached. Stills that are written stay; animations are closed with the frames that there are, beside the place
/// of the whole one, and so are frames that are not as good as they should be.
pub fn render_until(
    sequence: &Sequence,
    request: &Request,
    meter: &Arc<Meter>,
    stop: &Stop,
) -> Result<Summary, RenderError> {
    render_told(sequence, request, meter, stop, &|_| ())
}

/// The same; `tell` hears how long the run is expected to take, if that is worth a pilot.
pub fn render_told(
    sequence: &Sequence,
    request: &Request,
    meter: &Arc<Meter>,
    stop: &Stop,
    tell: Listener,
) -> Result<Summary, RenderError> {
    rendered(sequence, request, meter, (stop, tell)).map_err(|error| match error {
        RenderError::Encode(EncodeError::Interrupted { signal, done }) => {
            let rest = request.frames.get(done..).unwrap_or_default().to_vec();
            let keeps = job(sequence, request, &Survey::default()).keeps();
            RenderError::Stopped { signal, done, files: Vec::new(), rest, keeps }
        }
        error => error,
    })
}

fn rendered(
    sequence: &Sequence,
    request: &Request,
    meter: &Arc<Meter>,
    (stop, tell): (&Stop, Listener),
) -> Result<Summary, RenderError> {
    let start = Instant::now();
    let _ = meter.stop.set(stop.clone());
    let extras = extras(sequence, &request.outputs);
    Large::Picture.check(memory::needed(sequence, extras))?;
    let pool = Arc::new(pool(request.threads)?);
    let survey = pool.install(|| survey_until(sequence, &request.frames, stop));
    let job = job(sequence, request, &survey);
    let keeps = job.keeps();
    if let Some(signal) = stop.signal().filter(|_| survey.frames.len() < request.frames.len()) {
        let rest = request.frames.clone();
        return Err(RenderError::Stopped { signal, done: 0, files: Vec::new(), rest, keeps });
    }
    let encoder = Encoder::start(job, Arc::clone(&pool), stop)?;
    let missing = encoder.missing();
    meter.frames.fetch_add((request.frames.len() - missing.len()) as u32, Relaxed);
    let mut frames = FrameLoop::with_extras(sequence, extras, encoder, Arc::clone(meter));
    let before = machine::processor_time();
    let survey = survey.only(&missing);
    let (done, expected) = pool.install(|| match request.existing {
        Existing::Share => shared(sequence, request, &survey, &mut frames, (meter, stop)),
        _ => planned(sequence, request, survey, &mut frames, (meter, stop, tell)),
    })?;
    let after = machine::processor_time();
    if let Some(signal) = stop.signal().filter(|_| done < missing.len()) {
        let report = frames.into_sink().map_or_else(|| Ok(Report::default()), Encoder::stop)?;
        let rest = missing[done..].to_vec();
        return Err(RenderError::Stopped { signal, done, files: report.files, rest, keeps });
    }
    let tally = frames.tally().clone();
    let encoder = frames.into_sink();
    let encoding = encoder.as_ref().and_then(Encoder::cpu);
    let cpu = after.zip(before).zip(encoding).map(|((after, before), encoding)| after - before - encoding);
    let report = encoder.map_or_else(|| Ok(Report::default()), Encoder::finish)?;
    let mut summary = summary(&tally, report, request.frames.len() as u32, start.elapsed());
    summary.cpu = cpu.map(|cpu| cpu - expected.map_or(0.0, |expected| expected.pilot));
    summary.expected = expected;
    summary.notes.splice(..0, sequence.notes());
    Ok(summary)
}

/// Samples of a run before which a pilot is worth its time, to tell how long it will take; and the least number of them
/// where they are taken until an error is reached, which may be far more.
const WORTH_A_PILOT: u64 = 1 << 23;
const WORTH_WITH_ERROR: u64 = 1 << 17;

/// Makes the frames that are missing by a plan, or each by itself. Gives the number of those that were begun.
fn planned<S: FilmSink>(
    sequence: &Sequence,
    request: &Request,
    missing: Survey,
    frames: &mut FrameLoop<S>,
    (meter, stop, tell): (&Meter, &Stop, Listener),
) -> Result<(usize, Option<Forecast>), NoFrame> {
    let on = || stop.signal().is_none();
    let kept = request.frames.len() - missing.frames.len();
    if request.reuse == Reuse::Off {
        meter.begin(kept, Vec::new());
        let mut done = 0;
        missing.frames.iter().take_while(|_| on()).try_for_each(|look| {
            frames.trace_alone(look)?;
            done += usize::from(!meter.unfinished.load(Relaxed));
            Ok::<_, NoFrame>(())
        })?;
        return Ok((done, None));
    }
    let extras = extras(sequence, &request.outputs);
    let budget = request.reuse.budget(sequence, extras);
    let plan = Plan::of(missing, sequence, extras, budget);
    let known = Expected::of(sequence, &plan);
    let worth = if known.exact { WORTH_A_PILOT } else { WORTH_WITH_ERROR };
    let Work { films, .. } = plan::work(sequence, &plan, Effort::NONE);
    let (mut films, mut forecast) = (films, Forecast::of(&plan, &known));
    // Whoever has limited the time has had a pilot.
    if known.camera >= worth && request.time_limit.is_none() {
        tell(Notice::Pilot { plan: &plan });
        let outlook = look_ahead(sequence, &plan, extras, Patience::RUN, Clock::Machine);
        let run = outlook.forecast(&sequence.quality);
        films = run.films.iter().map(|film| film.took.wall).collect();
        forecast = Forecast { pilot: outlook.spent.cpu.unwrap_or_default(), ..forecast.with(&run) };
        tell(Notice::Outlook { plan: &plan, outlook: &outlook });
    }
    meter.begin(kept, films);
    Ok((plan::run(&plan, frames, on)?, Some(forecast)))
}

impl Forecast {
    /// What is known without a pilot.
    fn of(plan: &Plan, known: &Expected) -> Self {
        Self {
            reused: plan.reused() as u32,
            camera_rays: known.camera,
            exact: known.exact,
            rays: None,
            bvh_builds: plan.builds(),
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

/// Makes those of the missing frames that no other process makes. Gives how many were begun; or all, when all are there.
fn shared(
    sequence: &Sequence,
    request: &Request,
    survey: &Survey,
    frames: &mut FrameLoop<Encoder>,
    (meter, stop): (&Meter, &Stop),
) -> Result<(usize, Option<Forecast>), NoFrame> {
    let extras = extras(sequence, &request.outputs);
    let room = Room::of(sequence, extras, request.reuse.budget(sequence, extras));
    meter.begin(request.frames.len() - survey.frames.len(), Vec::new());
    let there = |others: usize| {
        meter.frames.fetch_add(others as u32, Relaxed);
    };
    let on = || stop.signal().is_none();
    let Shared { done, complete } = run_shared(survey, room, frames, on, there)?;
    Ok((if complete { survey.frames.len() } else { done }, None))
}

/// Finds what a render would refuse before its first frame: a picture that does not fit into memory, or outputs that
/// cannot be written. Nothing is touched.
pub fn check(sequence: &Sequence, request: &Request) -> Result<(), RenderError> {
    let extras = extras(sequence, &request.outputs);
    Large::Picture.check(memory::needed(sequence, extras))?;
    Ok(job(sequence, request, &Survey::default()).check().map_err(EncodeError::from)?)
}

/// The threads that trace.
pub(crate) fn pool(threads: Option<NonZeroUsize>) -> Result<ThreadPool, RenderError> {
    let threads = threads.map_or(0, NonZeroUsize::get);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|error| RenderError::Threads(error.to_string()))
}

/// The quality of frames that an earlier run with the same limit of time has made, if any of them are there, whole and as
/// they would be made now with these samples.
pub fn settled(sequence: &Sequence, request: &Request) -> Option<Quality> {
    if request.existing != Existing::Keep {
        return None;
    }
    let counts = job(sequence, request, &Survey::default()).settled();
    let qualities = counts.into_iter().map(|(samples, antialias)| Quality {
        samples,
        antialias,
        noise: sequence.quality.noise.map(|target| NoiseTarget { most: samples, ..target }),
        ..sequence.quality
    });
    qualities.into_iter().find(|&quality| {
        let sequence = Sequence { quality, ..sequence.clone() };
        job(&sequence, request, &survey(&sequence, &request.frames)).keeps_any()
    })
}

pub(crate) fn job(sequence: &Sequence, request: &Request, survey: &Survey) -> Job {
    let output = &sequence.output;
    // By what they look like, those are found that are there.
    let seen = |look: &Look| Seen {
        radiance: look.radiance,
        film: look.film(),
        exposure: look.exposure,
        random: look.random,
    };
    Job {
        outputs: request.outputs.clone(),
        confined: request.confined,
        existing: request.existing,
        frames: request.frames.clone(),
        seen: survey.frames.iter().map(seen).collect(),
        rate: sequence.timeline.rate,
        size: output.size,
        tonemap: output.tonemap,
        transparent: output.transparent,
        matte: output.matte,
        caption: output.caption.clone(),
        formats: output.formats,
        about: About { time_limit: request.limit(), ..sequence.about() },
    }
}

/// What films have to record for these outputs.
pub(crate) fn extras(sequence: &Sequence, outputs: &[Output]) -> Extras {
    let exr = outputs.iter().any(|output| matches!(output, Output::Stills(Still::Exr, _)));
    let guides = exr && sequence.output.formats.exr.layers.call_for_guides();
    Extras { coverage: sequence.output.transparent, guides }
}

/// What a run of so many frames did.
pub(crate) fn summary(tally: &Tally, report: Report, frames: u32, elapsed: Duration) -> Summary {
    // The frame loop only waits for the encoder; its own time is what encoding took.
    let time = |stage| if stage == Stage::Encode { report.busy } else { tally.stages[stage as usize] };
    Summary {
        frames,
        kept: report.kept,
        reused: tally.reused,
        expected: None,
        counts: tally.counts,
        bvh_builds: tally.bvh_builds,
        noise: report.noise,
        cpu: None,
        stages: Stage::ALL.map(|stage| (stage.name(), time(stage))).to_vec(),
        elapsed,
        files: report.files,
        notes: report.notes,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_that_is_too_large_says_how_to_shrink_it() {
        for (what, parts) in [
            (Large::Picture, ["the picture", "--size", "--draft"]),
            (Large::Filmstrip, ["the filmstrip", "fewer frames", "320x200"]),
            (Large::Measurement, ["to compare", "--size", "fewer frames"]),
        ] {
            let text = RenderError::TooLarge { what, needed: 48_000_000_000, available: 8_100_000_000 };
            let text = text.to_string();
            assert!(text.contains("48.0 GB") && text.contains("8.10 GB"), "{text}");
            assert!(parts.iter().all(|part| text.contains(part)), "{text}");
        }
        assert!(matches!(Large::Picture.check(u64::MAX), Err(RenderError::TooLarge { .. })));
        assert!(Large::Picture.check(1).is_ok());
    }
}
