//! Chooses the next stage of a picture: coarse pictures only where whole ones take long.

use super::session::{Session, SessionOptions, Step};
use crate::base::cancel::Stop;
use crate::trace::Refinement;
use std::time::Duration;

/// A first picture that takes less time than this is not coarse.
const QUICK: Duration = Duration::from_millis(60);

/// The longest stage once every pixel has a sample. Then the page shows what there is.
const LONGEST: Duration = Duration::from_millis(400);

/// Measured speed of tracing, for films of one scene.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pace {
    /// Seconds per sample of a pixel.
    sample: Option<f64>,
}

impl Pace {
    /// Notes that `samples` samples took a time.
    pub fn note(&mut self, samples: u64, took: Duration) {
        if samples > 0 {
            self.sample = Some(took.as_secs_f64() / samples as f64);
        }
    }

    /// The predicted time of a number of samples.
    pub fn predict(&self, samples: u64) -> Option<Duration> {
        self.sample.map(|sample| Duration::from_secs_f64((sample * samples as f64).min(1e6)))
    }

    /// The stage after `done`, until all of `pixels` pixels have `most` samples. None if it is done.
    pub fn next(&self, done: Option<Refinement>, pixels: u64, most: u32) -> Option<Refinement> {
        let Some(done) = done else {
            let quick = self.predict(pixels).is_some_and(|time| time <= QUICK);
            return Some(if quick { Refinement::ALL_PIXELS } else { Refinement::FIRST });
        };
        let next = done.next(most)?;
        if done < Refinement::ALL_PIXELS {
            return Some(next);
        }
        let fitting =
            self.predict(pixels).map_or(1.0, |time| LONGEST.as_secs_f64() / time.as_secs_f64().max(1e-9));
        // Up to the next power of two, where the error is estimated again.
        let doubled = next.samples.min(done.samples.saturating_add(1).next_power_of_two());
        let samples = doubled.min(done.samples.saturating_add((fitting as u32).max(1)));
        Some(Refinement { samples, ..next })
    }
}

/// The picture of a frame with `samples` samples per pixel, or all that the sequence asks for, as a PNG file.
///
/// # Errors
/// The message that the page would show.
pub fn snapshot(options: SessionOptions, frame: u32, samples: Option<u32>) -> Result<Vec<u8>, String> {
    let mut session = Session::new(options);
    session.reload();
    if let Some(diagnostics) = session.diagnostics() {
        return Err(diagnostics.to_owned());
    }
    if frame >= session.frames() {
        return Err(format!(
            "error: there is no frame {frame}; the last one is {}",
            session.frames().saturating_sub(1)
        ));
    }
    session.go_to(frame);
    session.limit_samples(samples);
    let stop = Stop::default();
    while session.step(&stop) == Step::Refined {}
    session.png().ok_or_else(|| session.diagnostics().unwrap_or("error: there is no picture").to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_pictures_are_coarse_first() {
        let mut pace = Pace::default();
        assert_eq!(pace.next(None, 100, 4), Some(Refinement::FIRST));
        pace.note(1000, Duration::from_millis(1));
        assert_eq!(pace.next(None, 1000, 4), Some(Refinement::ALL_PIXELS));
        assert_eq!(pace.next(None, 1_000_000, 4), Some(Refinement::FIRST));
    }

    #[test]
    fn stages_are_short_and_end() {
        let mut pace = Pace::default();
        pace.note(1000, Duration::from_millis(1));
        // 0.1 s per sample of all pixels: at most four at once.
        let (mut done, mut seen) = (Some(Refinement::ALL_PIXELS), Vec::new());
        while let Some(next) = pace.next(done, 100_000, 23) {
            seen.push(next.samples);
            done = Some(next);
        }
        assert_eq!(seen, [2, 4, 8, 12, 16, 20, 23]);
    }
}
