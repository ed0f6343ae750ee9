//! Progress of a run, told by a thread that watches the meter while others render.

use super::json::Object;
use super::terminal;
use crate::base::stats::{Line, Meter, Work};
use crate::base::units;
use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{Write, stderr, stdout};
use std::sync::atomic::Ordering::Relaxed;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

/// How progress is told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ProgressMode {
    /// A bar on a terminal, plain lines otherwise
    #[default]
    Auto,
    /// Lines on stderr, once a second or less
    Plain,
    /// One JSON object per line on stdout, the summary last
    Json,
    /// Lines on stdout that runners of Open Job Description read
    #[value(name = "openjd")]
    OpenJd,
}

/// Where and how progress is shown.
pub enum Reporter {
    Silent,
    Bar(ProgressBar),
    Lines { out: Box<dyn Write + Send>, form: Form, last: String },
}

/// For whom lines are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    People,
    Json,
    OpenJd,
}

/// How soon notices are shown.
const NOTICES: Duration = Duration::from_millis(100);

/// One look at a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snapshot {
    /// Frames done, with the part of the one in hand.
    done: f64,
    frames: usize,
    /// Those that were made of the film of another.
    reused: u32,
    rays: u64,
    elapsed: Duration,
    /// What is done of what takes time, and since when.
    work: Work,
    working: Duration,
}

/// Does the work while another thread shows how far it has come.
pub fn watch<T>(meter: &Meter, frames: usize, mut show: Reporter, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    // Dropped when the work is over, also by a panic, which ends the watch.
    let (working, over) = mpsc::channel::<()>();
    thread::scope(|scope| {
        let watcher = move || {
            let look = || Snapshot::of(meter, frames, start.elapsed());
            let mut told = start;
            while over.recv_timeout(show.pause(start.elapsed()).min(NOTICES))
                == Err(RecvTimeoutError::Timeout)
            {
                show.notices(&meter.take_notices());
                if told.elapsed() >= show.pause(start.elapsed()) {
                    told = Instant::now();
                    show.tell(&look());
                }
            }
            show.notices(&meter.take_notices());
            show.finish(&look());
        };
        // Without a thread to spare the work goes on, only unwatched.
        let _ = thread::Builder::new().spawn_scoped(scope, watcher);
        let result = work();
        drop(working);
        result
    })
}

impl Reporter {
    pub fn new(mode: ProgressMode, quiet: bool, frames: usize) -> Self {
        match mode {
            _ if quiet => Self::Silent,
            ProgressMode::Auto if terminal::interactive() => Self::bar(frames),
            ProgressMode::Auto | ProgressMode::Plain => {
                Self::Lines { out: Box::new(stderr()), form: Form::People, last: String::new() }
            }
            ProgressMode::Json => Self::on_stdout(Form::Json),
            ProgressMode::OpenJd => Self::on_stdout(Form::OpenJd),
        }
    }

    fn on_stdout(form: Form) -> Self {
        Self::Lines { out: Box::new(stdout()), form, last: String::new() }
    }

    fn bar(frames: usize) -> Self {
        let bar =
            ProgressBar::with_draw_target(Some(frames as u64 * 1000), ProgressDrawTarget::stderr_with_hz(10));
        // The template is a constant; if it were faulty, the default style would still tell the position.
        if let Ok(style) = ProgressStyle::with_template("[{bar:30}] {msg}") {
            bar.set_style(style.progress_chars("=> "));
        }
        Self::Bar(bar)
    }

    /// How long to wait before telling again. Logs of long runs would be all progress at one line a second.
    fn pause(&self, elapsed: Duration) -> Duration {
        match self {
            Self::Silent => Duration::from_secs(3600),
            Self::Bar(_) => Duration::from_millis(100),
            Self::Lines { .. } => (elapsed / 20).clamp(Duration::from_secs(1), Duration::from_secs(30)),
        }
    }

    /// Shows lines that are no progress.
    fn notices(&mut self, lines: &[Line]) {
        for line in lines {
            match self {
                Self::Silent => {}
                Self::Bar(bar) => bar.suspend(|| terminal::complain(&line.text)),
                Self::Lines { out, form, .. } => {
                    // A reader that went away does not stop a run.
                    let _ = match form {
                        Form::People => terminal::tell(out, &line.text),
                        Form::Json => terminal::tell(out, &line.json),
                        // Of these, only the run's status has a place.
                        Form::OpenJd => Ok(()),
                    };
                }
            }
        }
    }

    fn tell(&mut self, snapshot: &Snapshot) {
        match self {
            Self::Silent => {}
            Self::Bar(bar) => {
                bar.set_position((snapshot.done * 1000.0) as u64);
                bar.set_message(snapshot.line());
            }
            Self::Lines { out, form, last } => {
                let line = snapshot.told(*form);
                if line != *last {
                    // A reader that went away does not stop a run.
                    let _ = terminal::tell(out, &line);
                    *last = line;
                }
            }
        }
    }

    /// The last word: lines end with the final state, unless a run is so short that none was needed.
    fn finish(&mut self, snapshot: &Snapshot) {
        match self {
            Self::Bar(bar) => bar.finish_and_clear(),
            // Programs want the last line however short the run is.
            Self::Lines { form, .. }
                if *form != Form::People || snapshot.elapsed >= Duration::from_secs(1) =>
            {
                self.tell(snapshot);
            }
            _ => {}
        }
    }
}

impl Snapshot {
    fn of(meter: &Meter, frames: usize, elapsed: Duration) -> Self {
        // Both parts of the meter are not read at once, and may be a frame apart.
        let done = meter.frames_done().min(frames as f64);
        let reused = meter.reused.load(Relaxed);
        let working = meter.outset.get().map_or(elapsed, |outset| outset.at.elapsed());
        let rays = meter.rays.load(Relaxed);
        Self { done, frames, reused, rays, elapsed, work: meter.work(frames), working }
    }

    /// Time left if the rest of the work goes on as what is done. None before anything is, nor for frames that take no
    /// work, of which all that is known is that they take little.
    fn left(&self) -> Option<Duration> {
        let Work { done, rest } = self.work;
        if self.frames > 0 && self.done >= self.frames as f64 {
            return Some(Duration::ZERO);
        }
        (done > 0.0 && rest > 0.0)
            .then(|| Duration::try_from_secs_f64(self.working.as_secs_f64() * rest / done).ok())
            .flatten()
    }

    fn told(&self, form: Form) -> String {
        match form {
            Form::People => self.line(),
            Form::Json => self.json(),
            Form::OpenJd => self.openjd(),
        }
    }

    /// `frame 12/72 · 3.10 Mray/s · 5 reused · 21 s left`.
    fn line(&self) -> String {
        let rate = units::ray_rate(self.rays, self.elapsed);
        let mut line = format!("frame {}/{} · {rate}", self.done as u64, self.frames);
        if self.reused > 0 {
            line += &format!(" · {} reused", self.reused);
        }
        if self.done < self.frames as f64
            && let Some(left) = self.left()
        {
            line += &format!(" · {} left", units::rough_time(left));
        }
        line
    }

    /// What a runner of Open Job Description shows of a task: how much of it is done, in per cent, and a line.
    fn openjd(&self) -> String {
        let share = if self.frames == 0 { 1.0 } else { self.done / self.frames as f64 };
        format!("openjd_progress: {:.1}\nopenjd_status: {}", 100.0 * share, self.line())
    }

    fn json(&self) -> String {
        Object::new()
            .text("event", "progress")
            .whole("frame", self.done as u64)
            .whole("frames", self.frames as u64)
            .whole("reused", self.reused.into())
            .whole("rays", self.rays)
            .real("elapsed_s", Some(self.elapsed.as_secs_f64()))
            .real("left_s", self.left().map(|left| left.as_secs_f64()))
            .finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::{Arc, Mutex};

    /// Standard output of a test.
    #[derive(Clone, Default)]
    struct Shared(Arc<Mutex<Vec<u8>>>);

    impl Write for Shared {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0.lock().expect("no panic in a test").write(bytes)
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    fn snapshot(done: f64, seconds: u64) -> Snapshot {
        let elapsed = Duration::from_secs(seconds);
        let work = Work { done, rest: 72.0 - done };
        Snapshot { done, frames: 72, reused: 0, rays: 31_000_000, elapsed, work, working: elapsed }
    }

    /// Forty frames of an earlier run, and of the films of the others the one that takes most.
    #[test]
    fn what_is_left_is_weighed_by_its_work() {
        let some = Snapshot {
            work: Work { done: 900.0, rest: 100.0 },
            working: Duration::from_secs(9),
            ..snapshot(41.0, 10)
        };
        assert_eq!(some.left(), Some(Duration::from_secs(1)));
        let mixed = Snapshot { work: Work { done: 1000.0, rest: 0.0 }, ..some };
        assert_eq!(mixed.left(), None);
        assert_eq!(mixed.line(), "frame 41/72 · 3.10 Mray/s");
        assert_eq!(Snapshot { done: 72.0, ..mixed }.left(), Some(Duration::ZERO));
        assert_eq!(Snapshot { work: Work { done: 0.0, rest: 1000.0 }, ..some }.left(), None);
    }

    #[test]
    fn a_look_at_a_run_takes_what_the_meter_tells() {
        let meter = Meter { frames: 8.into(), reused: 3.into(), ..Meter::default() };
        meter.begin(4, vec![600.0, 400.0]);
        let look = Snapshot::of(&meter, 12, Duration::from_secs(3600));
        assert_eq!((look.done, look.reused, look.work), (8.0, 3, Work { done: 600.0, rest: 400.0 }));
        assert!(look.working < look.elapsed, "what came before tracing does not count");
    }

    #[test]
    fn lines_tell_frames_rate_and_time_left() {
        assert_eq!(snapshot(24.7, 10).line(), "frame 24/72 · 3.10 Mray/s · 19 s left");
        assert_eq!(snapshot(0.0, 10).line(), "frame 0/72 · 3.10 Mray/s");
        assert_eq!(snapshot(72.0, 10).line(), "frame 72/72 · 3.10 Mray/s");
        let some = Snapshot { reused: 5, ..snapshot(24.0, 10) };
        assert_eq!(some.line(), "frame 24/72 · 3.10 Mray/s · 5 reused · 20 s left");
        let json = r#"{"event":"progress","frame":24,"frames":72,"reused":0,"rays":31000000,"elapsed_s":10.000,"left_s":20.000}"#;
        assert_eq!(snapshot(24.0, 10).json(), json);
        assert_eq!(
            snapshot(24.7, 10).openjd(),
            "openjd_progress: 34.3\nopenjd_status: frame 24/72 · 3.10 Mray/s · 19 s left"
        );
        assert!(snapshot(0.0, 0).json().ends_with(r#""elapsed_s":0.000,"left_s":null}"#));
    }

    #[test]
    fn the_end_is_told() {
        let (meter, out) = (Meter::default(), Shared::default());
        let show = Reporter::Lines { out: Box::new(out.clone()), form: Form::Json, last: String::new() };
        let result = watch(&meter, 2, show, || {
            meter.frames.store(2, Relaxed);
            meter.rays.store(5, Relaxed);
            "done"
        });
        assert_eq!(result, "done");
        let text = String::from_utf8(out.0.lock().expect("no panic in a test").clone()).expect("text");
        assert!(
            text.starts_with(r#"{"event":"progress","frame":2,"frames":2,"reused":0,"rays":5,"#),
            "{text}"
        );
        assert_eq!(text.lines().count(), 1);
    }

    #[test]
    fn short_runs_need_no_lines() {
        let out = Shared::default();
        let show = Reporter::Lines { out: Box::new(out.clone()), form: Form::People, last: String::new() };
        watch(&Meter::default(), 1, show, || ());
        assert!(out.0.lock().expect("no panic in a test").is_empty());
    }
}
