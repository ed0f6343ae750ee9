//! Progress of loading, told by a thread that watches the meter. Most sequences are there at once, and nothing is
//! told of them.

use super::json::Object;
use super::progress::ProgressMode;
use super::terminal;
use crate::base::escape;
use crate::import::LoadMeter;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{Write, stderr, stdout};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

/// Loading that takes no longer than this is not told of.
const PATIENCE: Duration = Duration::from_millis(700);

/// Where and how progress is shown.
pub enum Reporter {
    Silent,
    Bar(Option<ProgressBar>),
    Lines { out: Box<dyn Write + Send>, format: fn(&Snapshot) -> String, last: String },
}

/// One look at a meter.
pub struct Snapshot {
    what: String,
    /// Bytes done and bytes there are.
    share: Option<(u64, u64)>,
}

/// Does the work while another thread shows how far it has come.
pub fn watch<T>(meter: &LoadMeter, mut show: Reporter, work: impl FnOnce() -> T) -> T {
    // Dropped when the work is over, also by a panic, which ends the watch.
    let (working, over) = mpsc::channel::<()>();
    thread::scope(|scope| {
        let watcher = move || {
            let mut pause = PATIENCE;
            while over.recv_timeout(pause) == Err(RecvTimeoutError::Timeout) {
                show.tell(&Snapshot { what: meter.what(), share: meter.share() });
                pause = show.pause();
            }
            show.finish();
        };
        // Without a thread to spare the work goes on, only unwatched.
        let _ = thread::Builder::new().spawn_scoped(scope, watcher);
        let result = work();
        drop(working);
        result
    })
}

impl Reporter {
    pub fn new(mode: ProgressMode, quiet: bool) -> Self {
        match mode {
            _ if quiet => Self::Silent,
            ProgressMode::Auto if terminal::interactive() => Self::Bar(None),
            ProgressMode::Auto | ProgressMode::Plain => {
                Self::Lines { out: Box::new(stderr()), format: Snapshot::line, last: String::new() }
            }
            ProgressMode::Json => {
                Self::Lines { out: Box::new(stdout()), format: Snapshot::json, last: String::new() }
            }
            ProgressMode::OpenJd => {
                Self::Lines { out: Box::new(stdout()), format: Snapshot::openjd, last: String::new() }
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

    fn tell(&mut self, snapshot: &Snapshot) {
        match self {
            Self::Silent => {}
            Self::Bar(bar) => {
                let bar = bar.get_or_insert_with(new_bar);
                let (done, total) = snapshot.share.unwrap_or((1, 1));
                bar.set_length(total);
                bar.set_position(done);
                bar.set_message(escape::line(&snapshot.line()).into_owned());
            }
            Self::Lines { out, format, last } => {
                let line = format(snapshot);
                if line != *last {
                    // A reader that went away does not stop the work.
                    let _ = terminal::tell(out, &line);
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
    // The template is a constant; if it were faulty, the default style would still tell the position.
    if let Ok(style) = ProgressStyle::with_template("[{bar:30}] {msg}") {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
}

impl Snapshot {
    /// `loading bunny.ply 43 %`
    fn line(&self) -> String {
        // Before the first mesh there is only the sequence file itself.
        let what = if self.what.is_empty() { "loading" } else { &self.what };
        match self.share {
            Some((done, total)) => format!("{what} {} %", u128::from(done) * 100 / u128::from(total)),
            None => what.to_owned(),
        }
    }

    fn openjd(&self) -> String {
        format!("openjd_status: {}", self.line())
    }

    fn json(&self) -> String {
        let object = Object::new().text("event", "loading").text("what", &self.what);
        match self.share {
            Some((done, total)) => object.whole("bytes", done).whole("of", total).finish(),
            None => object.finish(),
        }
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
    fn lines_tell_what_and_how_far() {
        let snapshot = |share| Snapshot { what: "loading bunny.ply".to_owned(), share };
        assert_eq!(snapshot(Some((437, 1000))).line(), "loading bunny.ply 43 %");
        assert_eq!(snapshot(Some((u64::MAX, u64::MAX))).line(), "loading bunny.ply 100 %");
        assert_eq!(snapshot(None).line(), "loading bunny.ply");
        let json = r#"{"event":"loading","what":"loading bunny.ply","bytes":437,"of":1000}"#;
        assert_eq!(snapshot(Some((437, 1000))).json(), json);
        assert_eq!(snapshot(None).json(), r#"{"event":"loading","what":"loading bunny.ply"}"#);
    }

    #[test]
    fn only_what_takes_long_is_told() {
        let told = |time: Duration| {
            let (send, sent) = mpsc::channel();
            let show =
                Reporter::Lines { out: Box::new(Sent(send)), format: Snapshot::line, last: String::new() };
            let meter = LoadMeter::default();
            let work = || {
                meter.start("loading a.ply".to_owned(), 10);
                meter.advance(5);
                thread::sleep(time);
                "done"
            };
            assert_eq!(watch(&meter, show, work), "done");
            sent.iter().collect::<String>()
        };
        assert_eq!(told(Duration::ZERO), "");
        assert_eq!(told(PATIENCE + Duration::from_millis(300)), "loading a.ply 50 %\n");
    }
}
