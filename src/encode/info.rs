//! Facts about a sequence and its frames, for captions, metadata and the names of layers.

use crate::base::time::{Fraction, Rate, Time};
use crate::base::units::counted;
use std::fmt;
use std::time::Duration;

/// Facts about the rendered sequence that go into files.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SequenceInfo {
    /// The sequence's name.
    pub name: String,
    /// Number of frames of the whole sequence.
    pub frames: u32,
    pub seed: u32,
    /// Whether each frame has random numbers of its own.
    pub vary_noise: bool,
    /// Samples per pixel of frames with random effects.
    pub samples: u32,
    /// Samples along each side of a pixel of frames without random effects.
    pub antialias: u32,
    /// The target error of adaptive sampling, which replaces the number of samples.
    pub noise: Option<f64>,
    /// Whether frames with random effects are denoised.
    pub denoised: bool,
    /// The time limit that determined the numbers of samples, if the sequence did not.
    pub time_limit: Option<TimeBudget>,
    /// Names of the film's light groups.
    pub layers: Vec<String>,
}

/// A time limit for rendering a number of frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimeBudget {
    pub time: Duration,
    pub frames: u32,
}

impl fmt::Display for TimeBudget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} s for {}", self.time.as_secs_f64(), counted(self.frames.into(), "frame"))
    }
}

/// One frame of a sequence.
#[derive(Clone, Copy, Debug)]
pub struct FrameInfo<'a> {
    pub sequence: &'a SequenceInfo,
    pub frame: u32,
    pub rate: Rate,
}

impl FrameInfo<'_> {
    /// The start of the frame in seconds.
    pub fn time(&self) -> Time {
        self.rate.time_of(self.frame)
    }

    /// The start of the frame in seconds, rounded once.
    pub fn time_value(&self) -> f64 {
        Fraction::new(self.time(), Time::from_integer(1)).value()
    }

    /// The frame's number, padded to the digits of the last frame, so that a counter in captions does not move.
    pub fn padded(&self) -> String {
        let digits = self.sequence.frames.saturating_sub(1).max(self.frame).to_string().len();
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
        let sequence = SequenceInfo { name: "turn".into(), frames: 101, ..SequenceInfo::default() };
        let shown = |frame, rate: (i128, i128)| {
            let rate = Rate::new(rate.0, rate.1).expect("a rate");
            let info = FrameInfo { sequence: &sequence, frame, rate };
            (info.padded(), info.seconds())
        };
        assert_eq!(shown(7, (24, 1)), ("007".into(), "0.29".into()));
        assert_eq!(shown(100, (30_000, 1001)), ("100".into(), "3.34".into()));
        assert_eq!(shown(12_000, (1, 1)), ("12000".into(), "12000.00".into()));
    }
}
