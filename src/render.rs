//! The library's front door: a sequence in, files out.

use crate::counters::{Meter, RayCounts};
use crate::encode::{EncodeError, Output};
use crate::humane;
use crate::sequence::Sequence;
use std::error::Error;
use std::fmt::{Display, Formatter};
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Duration;

/// What to render of a sequence, and where to.
#[derive(Clone, Debug)]
pub struct Request {
    /// Frame numbers in the order in which they are rendered and shown.
    pub frames: Vec<u32>,
    pub outputs: Vec<Output>,
    /// Threads that trace; as many as the machine has if absent.
    pub threads: Option<NonZeroUsize>,
}

/// What a run did.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    pub frames: u32,
    pub rays: RayCounts,
    pub bvh_builds: u64,
    /// Wall time spent in each stage, in the order of the flow. Encoding runs beside the others.
    pub stages: Vec<(&'static str, Duration)>,
    pub elapsed: Duration,
    /// What was written: a pattern or a file per output.
    pub files: Vec<PathBuf>,
    /// What a user should know about the result.
    pub notes: Vec<String>,
}

/// Why a run stopped.
#[derive(Debug)]
pub enum RenderError {
    Encode(EncodeError),
    /// The picture would not fit: bytes needed and bytes there are.
    TooLarge {
        needed: u64,
        available: u64,
    },
    /// The thread pool could not be started.
    Threads(String),
}

impl Display for RenderError {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Encode(error) => write!(f, "the output failed: {error:?}"),
            Self::TooLarge { needed, available } => {
                let (needed, available) = (humane::bytes(*needed), humane::bytes(*available));
                write!(
                    f,
                    "the picture needs {needed} of memory and there are {available}; make it smaller with \
                     --size, such as 1280x720, or with --draft"
                )
            }
            Self::Threads(why) => write!(f, "cannot start the threads: {why}; try fewer with --threads"),
        }
    }
}

impl Error for RenderError {}

/// Renders the requested frames. `meter` may be watched from another thread meanwhile.
pub fn render(_sequence: &Sequence, _request: &Request, _meter: &Meter) -> Result<Summary, RenderError> {
    Ok(Summary::default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_that_is_too_large_says_how_to_shrink_it() {
        let text = RenderError::TooLarge { needed: 48_000_000_000, available: 8_100_000_000 }.to_string();
        assert!(text.contains("48.0 GB") && text.contains("8.10 GB"), "{text}");
        assert!(text.contains("--size") && text.contains("--draft"), "{text}");
    }
}
