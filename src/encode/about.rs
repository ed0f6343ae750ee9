//! What is known about a run's frames besides their pixels, for captions, metadata and the names of layers.

use crate::base::time::{Rate, Time};
use crate::base::units::counted;
use std::fmt;
use std::time::Duration;

/// The sequence that is rendered, as files may tell it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct About {
    /// The sequence's name.
    pub name: String,
    /// How many frames the whole sequence has.
    pub frames: u32,
    pub seed: u32,
    /// Samples in each pixel where something is random.
    pub samples: u32,
    /// Samples along each side of a pixel where nothing is.
    pub antialias: u32,
    /// The error to which pixels are sampled, in place of a number of samples.
    pub noise: Option<f64>,
    /// What settled how many samples there are, if the sequence did not.
    pub time_limit: Option<TimeLimit>,
    /// Names of the film's layers of light.
    pub layers: Vec<String>,
}

/// A time that so many frames were to take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimeLimit {
    pub time: Duration,
    pub frames: u32,
}

impl fmt::Display for TimeLimit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} s for {}", self.time.as_secs_f64(), counted(self.frames.into(), "frame"))
    }
}

/// One frame of it.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    pub about: &'a About,
    pub frame: u32,
    pub rate: Rate,
}

impl Shown<'_> {
    /// When the frame starts, in seconds.
    pub fn time(&self) -> Time {
        self.rate.time_of(self.frame)
    }

    /// The frame's number with as many digits as the last one has, so that a counter does not jump about.
    pub fn padded(&self) -> String {
        let digits = self.about.frames.saturating_sub(1).max(self.frame).to_string().len();
        format!("{:0digits$}", self.frame)
    }

    /// The time in seconds to two decimals.
    pub fn seconds(&self) -> String {
        let hundredths = (self.time() * 100).round().to_integer();
        format!("{}.{:02}", hundredths / 100, hundredths % 100)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_and_times_are_as_wide_as_the_last() {
        let about = About { name: "turn".into(), frames: 101, ..About::default() };
        let told = |frame, rate: (i128, i128)| {
            let shown = Shown { about: &about, frame, rate: Rate::new(rate.0, rate.1).expect("a rate") };
            (shown.padded(), shown.seconds())
        };
        assert_eq!(told(7, (24, 1)), ("007".into(), "0.29".into()));
        assert_eq!(told(100, (30_000, 1001)), ("100".into(), "3.34".into()));
        assert_eq!(told(12_000, (1, 1)), ("12000".into(), "12000.00".into()));
    }
}
