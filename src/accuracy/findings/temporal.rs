//! How wrong the change from one frame to the next is.

use super::base::with_interval;
use crate::accuracy::measure::{Measured, TemporalError};
use crate::accuracy::statistics::ConfidenceInterval;

impl TemporalError {
    /// A squared error in words: a share of the mean brightness, with its interval.
    pub fn error_text(&self, squared: ConfidenceInterval) -> String {
        with_interval(self.share(squared))
    }
}

impl Measured {
    /// The error of the change to the next frame, in a sentence.
    pub fn flicker(&self) -> Option<String> {
        let found = self.temporal.as_ref()?;
        let ([before, after], quality) = (found.frames, &self.own().setting.quality);
        let own = found.error_text(found.own(quality));
        let other = match (found.varied, quality.vary_noise) {
            (None, _) => String::new(),
            (Some(varied), false) => {
                let varied = found.error_text(varied);
                format!(" with the same random numbers in both frames; {varied} with --vary-noise")
            }
            (Some(_), true) => {
                let same = found.error_text(found.same);
                format!(" with random numbers of their own; {same} without vary_noise")
            }
        };
        Some(format!(
            "Error of the change from frame {before} to {after}, of the mean brightness: {own}{other}"
        ))
    }
}
