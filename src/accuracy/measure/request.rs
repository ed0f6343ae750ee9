//! The request for a measurement.

use std::num::NonZeroUsize;
use std::time::Duration;

/// What to measure, and how long that may take.
#[derive(Clone, Debug)]
pub struct MeasurementRequest {
    pub frames: Vec<u32>,
    /// The approximate time of the measurement. The size of the pictures is reduced to meet it.
    pub time: Duration,
    /// Fewer settings, for a first answer.
    pub quick: bool,
    /// The size of the pictures; if absent, as large as the time allows.
    pub size: Option<(u32, u32)>,
    /// The largest number of samples that is measured, unless the file's own setting has more.
    pub most_samples: Option<u32>,
    pub threads: Option<NonZeroUsize>,
}
