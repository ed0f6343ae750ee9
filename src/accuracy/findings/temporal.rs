//! What the noise does from one frame to the next.

use crate::accuracy::measure::Measured;
use crate::accuracy::statistics::ConfidenceInterval;
use crate::base::units::percent;

impl Measured {
    /// The error of the change to the next frame, in a sentence.
    pub fn flicker(&self) -> Option<String> {
        let found = self.temporal.as_ref()?;
        let ([before, after], quality) = (found.frames, &self.own().setting.quality);
        let error = |squared: ConfidenceInterval| match squared.mean > 0.0 {
            true => format!("{} of the mean brightness", percent(self.share(squared.root().mean))),
            false => "0".to_owned(),
        };
        let how = match (found.varied, quality.vary_noise) {
            (None, _) => String::new(),
            (Some(varied), false) => {
                format!(
                    ", because noise stays in its place where nothing changes; --vary-noise: {}",
                    error(varied)
                )
            }
            (Some(_), true) => {
                format!(
                    ", because each frame has noise of its own; without vary_noise: {}",
                    error(found.same)
                )
            }
        };
        Some(format!(
            "Error of the change from frame {before} to {after}: {}{how}",
            error(found.own(quality))
        ))
    }
}
