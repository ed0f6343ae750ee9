//! Progress of loading, shown by a thread that watches the meter. Most sequences load at once and show nothing.

use super::json;
use super::progress::ProgressMode;
use super::terminal;
use crate::base::escape;
use crate::import::LoadProgress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use std::io::{Write, stderr, stdout};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

/// Loading shows no progress before this time.
const SILENT_TIME: Duration = Duration::from_millis(700);

/// Where and how progress is shown.
pub enum LoadingReporter {
    Silent,
    Bar(Option<ProgressBar>),
    Lines { out: Box<dyn Write + Send>, format: fn(&LoadSnapshot) -> String, last: String },
}

/// The state of loading at one moment.
pub struct LoadSnapshot {
    /// The current step, such as `loading bunny.ply`.
    what: String,
    /// Bytes read, and the size of the file.
    bytes: Option<(u64, u64)>,
}

/// Does the work while another thread shows its progress.
pub fn watch<T>(meter: &LoadProgress, mut reporter: LoadingReporter, work: impl FnOnce() -> T) -> T {
    // The watch ends when `working` is dropped, also by a panic.
    let (working, over) = mpsc::channel::<()>();
    thread::scope(|scope| {
        let watcher = move || {
            let mut pause = SILENT_TIME;
            while over.recv_timeout(pause) == Err(RecvTimeoutError::Timeout) {
                reporter.update(&LoadSnapshot { what: meter.what(), bytes: meter.bytes() });
                pause = reporter.pause();
            }
            reporter.finish();
        };
        // If no thread can be started, the work continues without progress.
        let _ = thread::Builder::new().spawn_scoped(scope, watcher);
        let result = work();
        drop(working);
        result
    })
}

impl LoadingReporter {
    pub fn new(mode: ProgressMode, quiet: bool) -> Self {
        match mode {
            _ if quiet => Self::Silent,
            ProgressMode::Auto if terminal::interactive() => Self::Bar(None),
            ProgressMode::Auto | ProgressMode::Plain => {
                Self::Lines { out: Box::new(stderr()), format: LoadSnapshot::line, last: String::new() }
            }
            ProgressMode::Json => {
                Self::Lines { out: Box::new(stdout()), format: LoadSnapshot::json, last: String::new() }
            }
            ProgressMode::OpenJd => {
                Self::Lines { out: Box::new(stdout()), format: LoadSnapshot::openjd, last: String::new() }
            }
        }
    }

    fn pause(&self) -> Duration {
        match self {
            Self::Silent => Duration::from_secs(3600),
            Self::Bar(_) => Duration::from_millis(100),
            Self::Lines { .. } => Duration::from_secs(1),
        }
    }

    fn update(&mut self, snapshot: &LoadSnapshot) {
        match self {
            Self::Silent => {}
            Self::Bar(bar) => {
                let bar = bar.get_or_insert_with(new_bar);
                let (done, total) = snapshot.bytes.unwrap_or((1, 1));
                bar.set_length(total);
                bar.set_position(done);
                bar.set_message(escape::line(&snapshot.line()).into_owned());
            }
            Self::Lines { out, format, last } => {
                let line = format(snapshot);
                if line != *last {
                    // If the reader went away, the work continues.
                    let _ = terminal::write_line(out, &line);
                    *last = line;
                }
            }
        }
    }

    fn finish(&mut self) {
        if let Self::Bar(Some(bar)) = self {
            bar.finish_and_clear();
        }
    }
}

fn new_bar() -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(1), ProgressDrawTarget::stderr_with_hz(10));
    // The template is a constant. If it were invalid, the default style would still show the position.
    if let Ok(style) = ProgressStyle::with_template("[{bar:30}] {msg}") {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
}

impl LoadSnapshot {
    /// `loading bunny.ply 43 %`
    fn line(&self) -> String {
        // Before the first mesh, the sequence file itself is read.
        let what = if self.what.is_empty() { "loading" } else { &self.what };
        match self.bytes {
            Some((done, total)) => format!("{what} {} %", u128::from(done) * 100 / u128::from(total)),
            None => what.to_owned(),
        }
    }

    fn openjd(&self) -> String {
        format!("openjd_status: {}", self.line())
    }

    fn json(&self) -> String {
        json::line(match self.bytes {
            Some((done, total)) => {
                json!({ "event": "loading", "what": self.what, "bytes": done, "of": total })
            }
            None => json!({ "event": "loading", "what": self.what }),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::Sender;

    /// Standard output of a test.
    struct Sent(Sender<String>);

    impl Write for Sent {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0.send(String::from_utf8_lossy(bytes).into_owned()).expect("a receiver");
            Ok(bytes.len())
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn lines_show_the_file_and_the_share() {
        let snapshot = |bytes| LoadSnapshot { what: "loading bunny.ply".to_owned(), bytes };
        assert_eq!(snapshot(Some((437, 1000))).line(), "loading bunny.ply 43 %");
        assert_eq!(snapshot(Some((u64::MAX, u64::MAX))).line(), "loading bunny.ply 100 %");
        assert_eq!(snapshot(None).line(), "loading bunny.ply");
        let json = r#"{"event":"loading","what":"loading bunny.ply","bytes":437,"of":1000}"#;
        assert_eq!(snapshot(Some((437, 1000))).json(), json);
        assert_eq!(snapshot(None).json(), r#"{"event":"loading","what":"loading bunny.ply"}"#);
    }

    #[test]
    fn only_slow_loading_is_shown() {
        let shown = |time: Duration| {
            let (send, sent) = mpsc::channel();
            let reporter = LoadingReporter::Lines {
                out: Box::new(Sent(send)),
                format: LoadSnapshot::line,
                last: String::new(),
            };
            let meter = LoadProgress::default();
            let work = || {
                meter.start("loading a.ply".to_owned(), 10);
                meter.advance(5);
                thread::sleep(time);
                "done"
            };
            assert_eq!(watch(&meter, reporter, work), "done");
            sent.iter().collect::<String>()
        };
        assert_eq!(shown(Duration::ZERO), "");
        assert_eq!(shown(SILENT_TIME + Duration::from_millis(300)), "loading a.ply 50 %\n");
    }
}
