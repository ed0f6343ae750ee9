//! Exact counts of the work done, and the progress of a run.

use crate::base::cancel::Stop;
use std::ops::AddAssign;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering::Relaxed};
use std::sync::{Mutex, OnceLock};
use std::time::Instant;

/// The target of events about finished frames, one by the frame loop and one by the encoder. `--metrics` joins them.
pub const FRAME_EVENTS: &str = "kinora::frame";

/// Declares a struct of counts that add up.
macro_rules! counts {
    ($(#[$doc:meta])* $name:ident { $($(#[$field_doc:meta])* $field:ident),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct $name {
            $($(#[$field_doc])* pub $field: u64,)*
        }

        impl $name {
            pub fn total(&self) -> u64 {
                [$(self.$field),*].iter().sum()
            }
        }

        impl AddAssign for $name {
            fn add_assign(&mut self, other: Self) {
                $(self.$field += other.$field;)*
            }
        }
    };
}

counts! {
    /// Rays by kind.
    RayCounts {
        camera,
        /// Reflected by mirrors and boundaries, sharp or rough.
        mirror,
        /// Transmitted by transparent surfaces, refracted or not.
        transmitted,
        /// Scattered along paths.
        scattered,
        /// Towards lights. A shadow ray counts again after each transparent surface that it passes.
        shadow,
    }
}

counts! {
    /// Work of effects besides rays. Each count is exactly 0 if the scene does not use its effect.
    Evaluations {
        /// Path segments through fog.
        fog,
        /// Texture evaluations at points of surfaces.
        paint,
        /// Directions sampled towards area lights, emissive objects and skies.
        light_samples,
        /// Points sampled on the lens.
        lens_samples,
    }
}

counts! {
    /// Samples that were dropped because their value is not valid light, by cause. A sample counts once in each of
    /// its layers.
    Dropped {
        /// Not a number.
        undefined,
        infinite,
        negative,
    }
}

counts! {
    /// Paths of frames that are traced together, each from one sample of a pixel.
    SharedPaths {
        /// Paths of all of these frames.
        all,
        /// Paths that were traced once for all frames.
        once,
        /// Paths of a frame that were traced again, because they could meet something that moved.
        retraced,
        /// Paths of frames in tiles that were traced frame by frame, because sharing them gains too little.
        whole,
        /// The rays of the paths that were traced once.
        once_rays,
        /// The work of the paths that were traced once, of those that were traced again, and of all of these frames alone.
        still_work,
        retraced_work,
        alone_work,
        /// Searches of movers with many parts, such as meshes, along segments.
        tests,
    }
}

impl SharedPaths {
    /// The number of paths that were traced.
    pub fn traced(&self) -> u64 {
        self.once + self.retraced + self.whole
    }

    /// The number of paths that did not have to be traced.
    pub fn reused(&self) -> u64 {
        self.all.saturating_sub(self.traced())
    }

    /// The traced share of all paths; 1 if there are none.
    pub fn share(&self) -> f64 {
        if self.all > 0 { self.traced() as f64 / self.all as f64 } else { 1.0 }
    }
}

counts! {
    /// Samples of films whose views share them.
    SharedSamples {
        films,
        /// Samples that these films would have if each was traced alone.
        alone,
        /// Samples that were traced for all of them together.
        traced,
        /// Samples of pixels that got fewer from all views than they should have.
        own,
    }
}

/// Everything that tracing counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    pub rays: RayCounts,
    pub evaluations: Evaluations,
    pub dropped: Dropped,
    pub paths: SharedPaths,
    pub samples: SharedSamples,
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.evaluations += other.evaluations;
        self.dropped += other.dropped;
        self.paths += other.paths;
        self.samples += other.samples;
    }
}

/// The progress of a run, shared with a thread that displays it, and a request to stop. It affects nothing else of
/// the run.
#[derive(Debug, Default)]
#[warn(missing_docs)]
pub struct ProgressMeter {
    /// Finished frames.
    pub frames: AtomicU32,
    /// Finished frames that reused the film of another frame.
    pub reused: AtomicU32,
    /// Finished fraction of the current frame, in thousandths.
    pub thousandths: AtomicU32,
    /// The part of the current frame that is traced now.
    pub pass: AtomicU32,
    /// The number of its parts; 0 or 1 if it is traced at once.
    pub passes: AtomicU32,
    /// Rays of all kinds so far.
    pub rays: AtomicU64,
    /// Set when tracing begins.
    pub start: OnceLock<RunStart>,
    /// Once it has a signal, films that are being traced end with the samples that they have.
    pub stop: OnceLock<Stop>,
    /// Whether a film ended early because of `stop`.
    pub unfinished: AtomicBool,
    /// Lines to display.
    pub notices: Mutex<Vec<StatusLine>>,
}

#[warn(missing_docs)]
impl ProgressMeter {
    /// Shows that `done` of `all` parts of the current pass of a frame are finished.
    pub fn show(&self, done: u64, all: u64) {
        let (pass, passes) =
            (u64::from(self.pass.load(Relaxed)), u64::from(self.passes.load(Relaxed).max(1)));
        let thousandths = (pass * all + done) * 1000 / (passes * all).max(1);
        self.thousandths.store(thousandths as u32, Relaxed);
    }

    /// Counts work that is done as its share of frames that are traced together: part number `before` up to number
    /// `now` of `all`.
    pub fn advance(&self, before: u64, now: u64, all: u64, frames: u64) {
        let thousandths = |done: u64| u128::from(done) * u128::from(frames) * 1000 / u128::from(all.max(1));
        let (before, now) = (thousandths(before), thousandths(now));
        self.frames.fetch_add((now / 1000 - before / 1000) as u32, Relaxed);
        self.thousandths.store((now % 1000) as u32, Relaxed);
    }
}

/// A line for people, and the same content for programs as a JSON object.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StatusLine {
    pub text: String,
    pub json: String,
}

/// The work of a run when tracing begins.
#[derive(Clone, Debug)]
pub struct RunStart {
    pub at: Instant,
    /// Frames that existed before the run.
    pub kept: u32,
    /// Expected number of rays of each film, in the order of tracing; empty if the run has no plan.
    pub films: Vec<f64>,
}

/// Work done and work left: in rays, or in frames if the numbers of rays are unknown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    pub done: f64,
    pub rest: f64,
}

#[warn(missing_docs)]
impl ProgressMeter {
    /// Notes that tracing begins.
    pub fn begin(&self, kept: usize, films: Vec<f64>) {
        // A second run with the same meter continues the first one.
        let _ = self.start.set(RunStart { at: Instant::now(), kept: kept as u32, films });
    }

    /// Whether the run should stop.
    pub fn is_stopped(&self) -> bool {
        self.stop.get().is_some_and(|stop| stop.signal().is_some())
    }

    /// Adds a line to display.
    pub fn notice(&self, line: StatusLine) {
        if let Ok(mut notices) = self.notices.lock() {
            notices.push(line);
        }
    }

    /// Takes the lines that have not been displayed yet.
    pub fn take_notices(&self) -> Vec<StatusLine> {
        self.notices.lock().map(|mut notices| std::mem::take(&mut *notices)).unwrap_or_default()
    }

    /// Finished frames, plus the finished fraction of the current frame.
    pub fn frames_done(&self) -> f64 {
        f64::from(self.frames.load(Relaxed)) + f64::from(self.thousandths.load(Relaxed)) / 1000.0
    }

    /// The progress of a run of `frames` frames. Frames that existed before, or that reuse a film, count as no work.
    pub fn work(&self, frames: usize) -> Progress {
        let start = self.start.get();
        let kept = start.map_or(0.0, |start| f64::from(start.kept));
        // The counters are read one after the other, so they may differ by a frame.
        let made = (self.frames_done() - kept).max(0.0);
        match start.map(|start| &start.films[..]) {
            Some(films @ [_, ..]) => Progress::of(films, made - f64::from(self.reused.load(Relaxed))),
            _ => Progress { done: made, rest: (frames as f64 - kept - made).max(0.0) },
        }
    }
}

impl Progress {
    /// `films` holds the expected rays of each film; `traced` is the number of films that are done.
    fn of(films: &[f64], traced: f64) -> Self {
        let share = |film: usize| (traced - film as f64).clamp(0.0, 1.0);
        let sum = |part: &dyn Fn(usize) -> f64| {
            films.iter().enumerate().map(|(film, rays)| part(film) * rays).sum()
        };
        Self { done: sum(&share), rest: sum(&|film| 1.0 - share(film)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A meter with finished frames, reused frames, and thousandths of the current frame.
    fn meter(frames: u32, reused: u32, thousandths: u32) -> ProgressMeter {
        ProgressMeter {
            frames: frames.into(),
            reused: reused.into(),
            thousandths: thousandths.into(),
            ..ProgressMeter::default()
        }
    }

    #[test]
    fn without_a_plan_frames_are_counted() {
        assert_eq!(meter(0, 0, 0).work(8), Progress { done: 0.0, rest: 8.0 });
        assert_eq!(meter(5, 0, 500).work(8), Progress { done: 5.5, rest: 2.5 });
        let resumed = meter(5, 0, 500);
        resumed.begin(4, Vec::new());
        assert_eq!(resumed.work(8), Progress { done: 1.5, rest: 2.5 });
    }

    #[test]
    fn frames_of_other_films_and_of_earlier_runs_weigh_nothing() {
        let (films, frames) = (vec![600.0, 100.0, 300.0], 12);
        let work = |frames_done: u32, reused: u32, thousandths: u32| {
            let meter = meter(frames_done, reused, thousandths);
            meter.begin(4, films.clone());
            meter.work(frames)
        };
        assert_eq!(work(4, 0, 0), Progress { done: 0.0, rest: 1000.0 });
        assert_eq!(work(4, 0, 500), Progress { done: 300.0, rest: 700.0 });
        assert_eq!(work(8, 3, 0), Progress { done: 600.0, rest: 400.0 });
        assert_eq!(work(9, 3, 250), Progress { done: 775.0, rest: 225.0 });
        // Only frames with films to trace are left.
        assert_eq!(work(10, 3, 0), Progress { done: 1000.0, rest: 0.0 });
        // The meter is read between two stores.
        assert_eq!(work(6, 3, 0), Progress { done: 0.0, rest: 1000.0 });
    }
}
