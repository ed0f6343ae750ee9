//! What to render, and into which files.

use crate::encode::{Existing, Output, TimeBudget};
use crate::film::AovSet;
use crate::pipeline::memory;
use crate::sequence::Sequence;
use std::num::NonZeroUsize;
use std::time::Duration;

/// Frames to render, and the files to write.
#[derive(Clone, Debug)]
#[warn(missing_docs)]
pub struct Request {
    /// Frame numbers in the order of rendering and playback.
    pub frames: Vec<u32>,
    /// The files to write.
    pub outputs: Vec<Output>,
    /// Whether outputs must stay within the working directory after links are followed. This holds for outputs that a
    /// sequence names, because sequences may come from others.
    pub confined: bool,
    /// What happens to files of an earlier run.
    pub existing: Existing,
    /// Number of tracing threads. If absent, one for each processor of the machine.
    pub threads: Option<NonZeroUsize>,
    /// Memory for films that frames share.
    pub reuse: Reuse,
    /// The time limit that determined the number of samples, if any. It is written into metadata.
    pub time_limit: Option<Duration>,
}

#[warn(missing_docs)]
impl Request {
    /// All frames of a sequence into these outputs, on all processors. Frames that exist and are current are kept.
    pub fn new(sequence: &Sequence, outputs: Vec<Output>) -> Self {
        Self {
            frames: (0..sequence.timeline.frames).collect(),
            outputs,
            confined: false,
            existing: Existing::default(),
            threads: None,
            reuse: Reuse::default(),
            time_limit: None,
        }
    }

    pub(super) fn limit(&self) -> Option<TimeBudget> {
        self.time_limit.map(|time| TimeBudget { time, frames: self.frames.len() as u32 })
    }
}

/// Memory limit of the film cache. It never changes a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[warn(missing_docs)]
pub enum Reuse {
    /// Each frame is traced separately.
    Off,
    /// A share of the free memory.
    #[default]
    Share,
    /// At most this number of bytes.
    Within(u64),
}

#[warn(missing_docs)]
impl Reuse {
    /// The limit in bytes for films of this sequence.
    pub fn budget(self, sequence: &Sequence, aovs: AovSet) -> u64 {
        match self {
            Self::Off => 0,
            Self::Share => memory::for_films(sequence, aovs),
            Self::Within(bytes) => bytes,
        }
    }
}
