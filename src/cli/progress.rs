//! Progress of a render, shown by a thread that watches the meter while others render.

use super::json::{self, rounded};
use super::terminal;
use crate::base::stats::{Progress, ProgressMeter, StatusLine};
use crate::base::units;
use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use std::io::{Write, stderr, stdout};
use std::sync::atomic::Ordering::Relaxed;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

/// How to report progress.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ProgressMode {
    /// A bar on a terminal, plain lines otherwise
    #[default]
    Auto,
    /// Lines on stderr, at most one a second
    Plain,
    /// One JSON object per line on stdout, the summary last
    Json,
    /// Lines on stdout for runners of Open Job Description
    #[value(name = "openjd")]
    OpenJd,
}

/// Where and how progress is shown.
pub enum ProgressReporter {
    Silent,
    Bar(ProgressBar),
    Lines { out: Box<dyn Write + Send>, format: LineFormat, last: String },
}

/// The reader of the lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineFormat {
    People,
    Json,
    OpenJd,
}

/// The longest delay of a notice.
const NOTICE_DELAY: Duration = Duration::from_millis(100);

/// The state of a run at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunSnapshot {
    /// Finished frames, plus the finished part of the current one.
    done: f64,
    frames: usize,
    /// Frames that reuse the film of another.
    reused: u32,
    rays: u64,
    elapsed: Duration,
    /// The finished and the remaining work, in rays.
    work: Progress,
    /// The time since that work began.
    working: Duration,
}

/// Does the work while another thread shows its progress.
pub fn watch<T>(
    meter: &ProgressMeter,
    frames: usize,
    mut reporter: ProgressReporter,
    work: impl FnOnce() -> T,
) -> T {
    let start = Instant::now();
    // The watch ends when `working` is dropped, also by a panic.
    let (working, over) = mpsc::channel::<()>();
    thread::scope(|scope| {
        let watcher = move || {
            let snapshot = || RunSnapshot::of(meter, frames, start.elapsed());
            let mut shown = start;
            while over.recv_timeout(reporter.pause(start.elapsed()).min(NOTICE_DELAY))
                == Err(RecvTimeoutError::Timeout)
            {
                reporter.notices(&meter.take_notices());
                if shown.elapsed() >= reporter.pause(start.elapsed()) {
                    shown = Instant::now();
                    reporter.update(&snapshot());
                }
            }
            reporter.notices(&meter.take_notices());
            reporter.finish(&snapshot());
        };
        // If no thread can be started, the work continues without progress.
        let _ = thread::Builder::new().spawn_scoped(scope, watcher);
        let result = work();
        drop(working);
        result
    })
}

impl ProgressReporter {
    pub fn new(mode: ProgressMode, quiet: bool, frames: usize) -> Self {
        match mode {
            _ if quiet => Self::Silent,
            ProgressMode::Auto if terminal::interactive() => Self::bar(frames),
            ProgressMode::Auto | ProgressMode::Plain => {
                Self::Lines { out: Box::new(stderr()), format: LineFormat::People, last: String::new() }
            }
            ProgressMode::Json => Self::on_stdout(LineFormat::Json),
            ProgressMode::OpenJd => Self::on_stdout(LineFormat::OpenJd),
        }
    }

    fn on_stdout(format: LineFormat) -> Self {
        Self::Lines { out: Box::new(stdout()), format, last: String::new() }
    }

    fn bar(frames: usize) -> Self {
        let bar =
            ProgressBar::with_draw_target(Some(frames as u64 * 1000), ProgressDrawTarget::stderr_with_hz(10));
        // The template is a constant. If it were invalid, the default style would still show the position.
        if let Ok(style) = ProgressStyle::with_template("[{bar:30}] {msg}") {
            bar.set_style(style.progress_chars("=> "));
        }
        Self::Bar(bar)
    }

    /// The time between updates. It grows with the run, so that progress does not fill the logs of long runs.
    fn pause(&self, elapsed: Duration) -> Duration {
        match self {
            Self::Silent => Duration::from_secs(3600),
            Self::Bar(_) => Duration::from_millis(100),
            Self::Lines { .. } => (elapsed / 20).clamp(Duration::from_secs(1), Duration::from_secs(30)),
        }
    }

    /// Shows lines that are not progress.
    fn notices(&mut self, lines: &[StatusLine]) {
        for line in lines {
            match self {
                Self::Silent => {}
                Self::Bar(bar) => bar.suspend(|| terminal::eprint_line(&line.text)),
                Self::Lines { out, format, .. } => {
                    // If the reader went away, the run continues.
                    let _ = match format {
                        LineFormat::People => terminal::write_line(out, &line.text),
                        LineFormat::Json => terminal::write_line(out, &line.json),
                        // The format has no place for notices.
                        LineFormat::OpenJd => Ok(()),
                    };
                }
            }
        }
    }

    fn update(&mut self, snapshot: &RunSnapshot) {
        match self {
            Self::Silent => {}
            Self::Bar(bar) => {
                bar.set_position((snapshot.done * 1000.0) as u64);
                bar.set_message(snapshot.line());
            }
            Self::Lines { out, format, last } => {
                let line = snapshot.text(*format);
                if line != *last {
                    // If the reader went away, the run continues.
                    let _ = terminal::write_line(out, &line);
                    *last = line;
                }
            }
        }
    }

    /// Shows the final state. People see no line for a run of less than a second.
    fn finish(&mut self, snapshot: &RunSnapshot) {
        match self {
            Self::Bar(bar) => bar.finish_and_clear(),
            // Programs get the last line of every run.
            Self::Lines { format, .. }
                if *format != LineFormat::People || snapshot.elapsed >= Duration::from_secs(1) =>
            {
                self.update(snapshot);
            }
            _ => {}
        }
    }
}

impl RunSnapshot {
    fn of(meter: &ProgressMeter, frames: usize, elapsed: Duration) -> Self {
        // The two counts of the meter are read one after the other, so the sum may be too large by a frame.
        let done = meter.frames_done().min(frames as f64);
        let reused = meter.reused.load(Relaxed);
        let working = meter.start.get().map_or(elapsed, |outset| outset.at.elapsed());
        let rays = meter.rays.load(Relaxed);
        Self { done, frames, reused, rays, elapsed, work: meter.work(frames), working }
    }

    /// The time left at the rate so far. None before any work is done, and while all remaining frames reuse films,
    /// because their time is unknown and short.
    fn left(&self) -> Option<Duration> {
        let Progress { done, rest } = self.work;
        if self.frames > 0 && self.done >= self.frames as f64 {
            return Some(Duration::ZERO);
        }
        (done > 0.0 && rest > 0.0)
            .then(|| Duration::try_from_secs_f64(self.working.as_secs_f64() * rest / done).ok())
            .flatten()
    }

    fn text(&self, format: LineFormat) -> String {
        match format {
            LineFormat::People => self.line(),
            LineFormat::Json => self.json(),
            LineFormat::OpenJd => self.openjd(),
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

    /// The progress of a task in per cent, and a status line, for a runner of Open Job Description.
    fn openjd(&self) -> String {
        let share = if self.frames == 0 { 1.0 } else { self.done / self.frames as f64 };
        format!("openjd_progress: {:.1}\nopenjd_status: {}", 100.0 * share, self.line())
    }

    fn json(&self) -> String {
        json::line(json!({
            "event": "progress",
            "frame": self.done as u64,
            "frames": self.frames,
            "reused": self.reused,
            "rays": self.rays,
            "elapsed_s": rounded(self.elapsed.as_secs_f64()),
            "left_s": self.left().map(|left| rounded(left.as_secs_f64())),
        }))
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

    fn snapshot(done: f64, seconds: u64) -> RunSnapshot {
        let elapsed = Duration::from_secs(seconds);
        let work = Progress { done, rest: 72.0 - done };
        RunSnapshot { done, frames: 72, reused: 0, rays: 31_000_000, elapsed, work, working: elapsed }
    }

    /// Forty frames are from an earlier run. Of the other films, the most expensive one is done.
    #[test]
    fn the_time_left_depends_on_the_remaining_work() {
        let some = RunSnapshot {
            work: Progress { done: 900.0, rest: 100.0 },
            working: Duration::from_secs(9),
            ..snapshot(41.0, 10)
        };
        assert_eq!(some.left(), Some(Duration::from_secs(1)));
        let mixed = RunSnapshot { work: Progress { done: 1000.0, rest: 0.0 }, ..some };
        assert_eq!(mixed.left(), None);
        assert_eq!(mixed.line(), "frame 41/72 · 3.10 Mray/s");
        assert_eq!(RunSnapshot { done: 72.0, ..mixed }.left(), Some(Duration::ZERO));
        assert_eq!(RunSnapshot { work: Progress { done: 0.0, rest: 1000.0 }, ..some }.left(), None);
    }

    #[test]
    fn snapshots_read_the_meter() {
        let meter = ProgressMeter { frames: 8.into(), reused: 3.into(), ..ProgressMeter::default() };
        meter.begin(4, vec![600.0, 400.0]);
        let snapshot = RunSnapshot::of(&meter, 12, Duration::from_secs(3600));
        assert_eq!(
            (snapshot.done, snapshot.reused, snapshot.work),
            (8.0, 3, Progress { done: 600.0, rest: 400.0 })
        );
        assert!(snapshot.working < snapshot.elapsed, "the time before tracing does not count");
    }

    #[test]
    fn lines_show_frames_rate_and_time_left() {
        assert_eq!(snapshot(24.7, 10).line(), "frame 24/72 · 3.10 Mray/s · 19 s left");
        assert_eq!(snapshot(0.0, 10).line(), "frame 0/72 · 3.10 Mray/s");
        assert_eq!(snapshot(72.0, 10).line(), "frame 72/72 · 3.10 Mray/s");
        let some = RunSnapshot { reused: 5, ..snapshot(24.0, 10) };
        assert_eq!(some.line(), "frame 24/72 · 3.10 Mray/s · 5 reused · 20 s left");
        let json = r#"{"event":"progress","frame":24,"frames":72,"reused":0,"rays":31000000,"elapsed_s":10.0,"left_s":20.0}"#;
        assert_eq!(snapshot(24.0, 10).json(), json);
        assert_eq!(
            snapshot(24.7, 10).openjd(),
            "openjd_progress: 34.3\nopenjd_status: frame 24/72 · 3.10 Mray/s · 19 s left"
        );
        assert!(snapshot(0.0, 0).json().ends_with(r#""elapsed_s":0.0,"left_s":null}"#));
    }

    #[test]
    fn the_end_is_shown() {
        let (meter, out) = (ProgressMeter::default(), Shared::default());
        let reporter = ProgressReporter::Lines {
            out: Box::new(out.clone()),
            format: LineFormat::Json,
            last: String::new(),
        };
        let result = watch(&meter, 2, reporter, || {
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
    fn short_runs_print_no_lines() {
        let out = Shared::default();
        let reporter = ProgressReporter::Lines {
            out: Box::new(out.clone()),
            format: LineFormat::People,
            last: String::new(),
        };
        watch(&ProgressMeter::default(), 1, reporter, || ());
        assert!(out.0.lock().expect("no panic in a test").is_empty());
    }
}
