//! Progress of a measurement: the finished fraction of the work, and the time left.

use crate::base::units;
use crate::cli::json::{self, rounded};
use crate::cli::progress::ProgressMode;
use crate::cli::terminal;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use std::time::{Duration, Instant};

/// Where and how progress is shown.
pub struct MeasureReporter {
    display: Display,
    start: Instant,
    shown: Instant,
}

enum Display {
    Silent,
    Bar(ProgressBar),
    Lines,
    Json,
    OpenJd,
}

impl MeasureReporter {
    pub fn new(mode: ProgressMode, quiet: bool) -> Self {
        let display = match mode {
            _ if quiet => Display::Silent,
            ProgressMode::Auto if terminal::interactive() => Display::Bar(bar()),
            ProgressMode::Auto | ProgressMode::Plain => Display::Lines,
            ProgressMode::Json => Display::Json,
            ProgressMode::OpenJd => Display::OpenJd,
        };
        Self { display, start: Instant::now(), shown: Instant::now() }
    }

    /// Shows that this fraction of the work, from 0 to 1, is done. Lines come at most every second, and more rarely in
    /// long runs.
    pub fn update(&mut self, done: f64) {
        let elapsed = self.start.elapsed();
        if let Display::Bar(bar) = &self.display {
            bar.set_position((1000.0 * done) as u64);
            bar.set_message(line(done, elapsed));
            return;
        }
        if self.shown.elapsed() < (elapsed / 20).max(Duration::from_secs(1)) {
            return;
        }
        self.shown = Instant::now();
        match &self.display {
            Display::Lines => terminal::eprint_line(&line(done, elapsed)),
            Display::Json => {
                let line = json::line(json!({
                    "event": "progress",
                    "done": rounded(done),
                    "elapsed_s": rounded(elapsed.as_secs_f64()),
                    "left_s": left(done, elapsed).map(|left| rounded(left.as_secs_f64())),
                }));
                // If the reader went away, the work continues.
                let _ = terminal::print_line(&line);
            }
            Display::OpenJd => {
                let status = line(done, elapsed);
                let progress = format!("openjd_progress: {:.1}\nopenjd_status: {status}", 100.0 * done);
                let _ = terminal::print_line(&progress);
            }
            Display::Silent | Display::Bar(_) => {}
        }
    }

    pub fn finish(&self) {
        if let Display::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
    }
}

fn bar() -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr_with_hz(10));
    // The template is a constant. If it were invalid, the default style would still show the position.
    if let Ok(style) = ProgressStyle::with_template("[{bar:30}] {msg}") {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
}

/// `37 % · 21 s left`.
fn line(done: f64, elapsed: Duration) -> String {
    let percent = format!("{:.0} %", 100.0 * done);
    left(done, elapsed)
        .map_or(percent.clone(), |left| format!("{percent} · {} left", units::rough_time(left)))
}

/// The time left at the rate so far.
fn left(done: f64, elapsed: Duration) -> Option<Duration> {
    let rest = elapsed.as_secs_f64() * (1.0 - done) / done;
    Duration::try_from_secs_f64(rest).ok().filter(|_| done > 0.0 && done < 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_show_the_share_and_the_time_left() {
        let elapsed = Duration::from_secs(10);
        assert_eq!(line(0.25, elapsed), "25 % · 30 s left");
        assert_eq!((line(0.0, elapsed), line(1.0, elapsed)), ("0 %".to_owned(), "100 %".to_owned()));
    }
}
