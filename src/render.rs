//! The library's front door: a sequence in, files out.

use crate::camera_path::NoCamera;
use crate::counters::{Counts, Meter};
use crate::encode::{EncodeError, Encoder, Job, Output, Report, Still};
use crate::film::{Extras, Film, Noise};
use crate::humane;
use crate::memory;
use crate::schedule::{FilmSink, FrameLoop, NoFrame, Stage, Tally};
use crate::sequence::Sequence;
use crate::stop::Stop;
use rayon::ThreadPool;
use std::error::Error;
use std::fmt::{Display, Formatter};
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What to render of a sequence, and where to.
#[derive(Clone, Debug)]
pub struct Request {
    /// Frame numbers in the order in which they are rendered and shown.
    pub frames: Vec<u32>,
    pub outputs: Vec<Output>,
    /// Threads that trace; as many as the machine has if absent.
    pub threads: Option<NonZeroUsize>,
}

/// What a run did.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    pub frames: u32,
    pub counts: Counts,
    pub bvh_builds: u64,
    /// Frames that were sampled until they were good enough, and how good they are.
    pub noise: Vec<(u32, Noise)>,
    /// Wall time spent in each stage, in the order of the flow. Encoding runs beside the others.
    pub stages: Vec<(&'static str, Duration)>,
    pub elapsed: Duration,
    /// What was written: a pattern or a file per output.
    pub files: Vec<PathBuf>,
    /// What a user should know about the result.
    pub notes: Vec<String>,
}

/// Why a run stopped.
#[derive(Debug)]
pub enum RenderError {
    Encode(EncodeError),
    /// The picture would not fit: bytes needed and bytes there are.
    TooLarge {
        needed: u64,
        available: u64,
    },
    /// A signal came when so many frames were done; these files were written.
    Stopped {
        signal: usize,
        done: usize,
        files: Vec<PathBuf>,
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
            Self::TooLarge { needed, available } => {
                let (needed, available) = (humane::bytes(*needed), humane::bytes(*available));
                write!(
                    f,
                    "the picture needs {needed} of memory and there are {available}; make it smaller with \
                     --size, such as 1280x720, or with --draft"
                )
            }
            Self::Camera { frame, why } => write!(f, "frame {frame} has no camera: {why}"),
            Self::Stopped { done, .. } => {
                write!(f, "stopped after {}", humane::counted(*done as u64, "frame"))
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

/// The same, but that it stops after the frame in hand when it is asked to. Stills that are written stay; animations
/// are closed with the frames that there are, beside the place of the whole one.
pub fn render_until(
    sequence: &Sequence,
    request: &Request,
    meter: &Arc<Meter>,
    stop: &Stop,
) -> Result<Summary, RenderError> {
    let start = Instant::now();
    let extras = extras(sequence, &request.outputs);
    check_memory(sequence, extras)?;
    let pool = Arc::new(pool(request.threads)?);
    let encoder = Encoder::start(job(sequence, request), Arc::clone(&pool))?;
    let mut frames = FrameLoop::with_extras(sequence, extras, encoder, Arc::clone(meter));
    let mut done = 0;
    pool.install(|| {
        request.frames.iter().take_while(|_| stop.signal().is_none()).try_for_each(|&frame| {
            done += 1;
            frames.frame(frame)
        })
    })?;
    if let Some(signal) = stop.signal().filter(|_| done < request.frames.len()) {
        let report = frames.into_sink().map_or_else(|| Ok(Report::default()), Encoder::stop)?;
        return Err(RenderError::Stopped { signal, done, files: report.files });
    }
    let tally = frames.tally().clone();
    let report = frames.into_sink().map_or_else(|| Ok(Report::default()), Encoder::finish)?;
    let mut summary = summary(&tally, report, request.frames.len() as u32, start.elapsed());
    summary.notes.splice(..0, sequence.notes());
    Ok(summary)
}

/// Refuses pictures that do not fit into memory.
pub(crate) fn check_memory(sequence: &Sequence, extras: Extras) -> Result<(), RenderError> {
    let (needed, available) = (memory::needed(sequence, extras), memory::available());
    if needed > available { Err(RenderError::TooLarge { needed, available }) } else { Ok(()) }
}

/// The threads that trace.
pub(crate) fn pool(threads: Option<NonZeroUsize>) -> Result<ThreadPool, RenderError> {
    let threads = threads.map_or(0, NonZeroUsize::get);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|error| RenderError::Threads(error.to_string()))
}

fn job(sequence: &Sequence, request: &Request) -> Job {
    let output = &sequence.output;
    Job {
        outputs: request.outputs.clone(),
        frames: request.frames.clone(),
        rate: sequence.timeline.rate,
        size: output.size,
        tonemap: output.tonemap,
        transparent: output.transparent,
        matte: output.matte,
        caption: output.caption.clone(),
        formats: output.formats,
        about: sequence.about(),
    }
}

/// What films have to record for these outputs.
fn extras(sequence: &Sequence, outputs: &[Output]) -> Extras {
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
        counts: tally.counts,
        bvh_builds: tally.bvh_builds,
        noise: tally.noise.clone(),
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
        let text = RenderError::TooLarge { needed: 48_000_000_000, available: 8_100_000_000 }.to_string();
        assert!(text.contains("48.0 GB") && text.contains("8.10 GB"), "{text}");
        assert!(text.contains("--size") && text.contains("--draft"), "{text}");
    }
}
