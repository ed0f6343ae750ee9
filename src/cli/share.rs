//! Progress of work that is no run of frames: what share of it is done, and how long the rest will take.

use super::json::Object;
use super::progress::ProgressMode;
use super::terminal;
use crate::base::units;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::{Duration, Instant};

/// Where and how it is shown.
pub struct Reporter {
    show: Show,
    start: Instant,
    told: Instant,
}

enum Show {
    Silent,
    Bar(ProgressBar),
    Lines,
    Json,
    OpenJd,
}

impl Reporter {
    pub fn new(mode: ProgressMode, quiet: bool) -> Self {
        let show = match mode {
            _ if quiet => Show::Silent,
            ProgressMode::Auto if terminal::interactive() => Show::Bar(bar()),
            ProgressMode::Auto | ProgressMode::Plain => Show::Lines,
            ProgressMode::Json => Show::Json,
            ProgressMode::OpenJd => Show::OpenJd,
        };
        Self { show, start: Instant::now(), told: Instant::now() }
    }

    /// Tells that this share of the work, from 0 to 1, is done. Lines come no oftener than every few seconds.
    pub fn tell(&mut self, done: f64) {
        let elapsed = self.start.elapsed();
        if let Show::Bar(bar) = &self.show {
            bar.set_position((1000.0 * done) as u64);
            bar.set_message(line(done, elapsed));
            return;
        }
        if self.told.elapsed() < (elapsed / 20).max(Duration::from_secs(1)) {
            return;
        }
        self.told = Instant::now();
        match &self.show {
            Show::Lines => terminal::complain(&line(done, elapsed)),
            Show::Json => {
                let object = Object::new()
                    .text("event", "progress")
                    .real("done", Some(done))
                    .real("elapsed_s", Some(elapsed.as_secs_f64()))
                    .real("left_s", left(done, elapsed).map(|left| left.as_secs_f64()));
                // A reader that went away does not stop the work.
                let _ = terminal::say(&object.finish());
            }
            Show::OpenJd => {
                let status = line(done, elapsed);
                let _ =
                    terminal::say(&format!("openjd_progress: {:.1}\nopenjd_status: {status}", 100.0 * done));
            }
            Show::Silent | Show::Bar(_) => {}
        }
    }

    pub fn finish(&self) {
        if let Show::Bar(bar) = &self.show {
            bar.finish_and_clear();
        }
    }
}

fn bar() -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr_with_hz(10));
    // The template is a constant; if it were faulty, the default style would still tell the position.
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

/// Time left if the rest goes on as what is done.
fn left(done: f64, elapsed: Duration) -> Option<Duration> {
    let rest = elapsed.as_secs_f64() * (1.0 - done) / done;
    Duration::try_from_secs_f64(rest).ok().filter(|_| done > 0.0 && done < 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_tell_the_share_and_the_time_left() {
        let second = Duration::from_secs(10);
        assert_eq!(line(0.25, second), "25 % · 30 s left");
        assert_eq!((line(0.0, second), line(1.0, second)), ("0 %".to_owned(), "100 %".to_owned()));
    }
}
