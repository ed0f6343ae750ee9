//! Why a run stops.

use crate::base::{machine, units};
use crate::camera::path::NoCamera;
use crate::encode::EncodeError;
use crate::import::series::StepError;
use crate::pipeline::schedule::FrameError;
use std::error::Error;
use std::fmt::{Display, Formatter};
use std::path::PathBuf;

/// Data that may not fit into memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MemoryUse {
    Picture,
    Filmstrip,
    /// All pictures of a run at the same time.
    Pictures,
    /// Pictures of several settings that are compared.
    Measurement,
}

impl MemoryUse {
    /// Returns an error if `needed` bytes exceed the free memory.
    pub(crate) fn check(self, needed: u64) -> Result<(), RenderError> {
        let available = machine::free_memory();
        if needed > available {
            return Err(RenderError::TooLarge { what: self, needed, available });
        }
        Ok(())
    }
}

/// Why a run stopped.
#[derive(Debug)]
#[warn(missing_docs)]
pub enum RenderError {
    /// A file could not be written.
    Encode(EncodeError),
    /// Bytes needed and bytes available.
    TooLarge {
        /// What needs the memory.
        what: MemoryUse,
        /// The bytes that it needs.
        needed: u64,
        /// The bytes that there are.
        available: u64,
    },
    /// A signal arrived after `done` frames; `files` were written.
    Stopped {
        /// The number of the signal.
        signal: usize,
        /// The number of finished frames.
        done: usize,
        /// Files that were written.
        files: Vec<PathBuf>,
        /// Frames that were not rendered.
        rest: Vec<u32>,
        /// Whether the next run keeps the existing frames.
        keeps: bool,
    },
    /// The thread pool could not be started.
    Threads(String),
    /// A mesh of a frame cannot be loaded.
    Mesh {
        /// The number of the frame.
        frame: u32,
        /// What is wrong with the mesh.
        why: StepError,
    },
    /// A frame has no camera.
    Camera {
        /// The number of the frame.
        frame: u32,
        /// Why it has no camera.
        why: NoCamera,
    },
}

impl From<EncodeError> for RenderError {
    fn from(error: EncodeError) -> Self {
        Self::Encode(error)
    }
}

impl From<FrameError> for RenderError {
    fn from(error: FrameError) -> Self {
        match error {
            FrameError::Camera { frame, why } => Self::Camera { frame, why },
            FrameError::Mesh { frame, why } => Self::Mesh { frame, why },
            FrameError::Encode(error) => Self::Encode(error),
        }
    }
}

impl Display for RenderError {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Encode(error) => error.fmt(f),
            Self::TooLarge { what, needed, available } => {
                let (what, mend) = match what {
                    MemoryUse::Picture => (
                        "the picture needs",
                        "make it smaller with --size, such as 1280x720, or with --draft",
                    ),
                    MemoryUse::Filmstrip => {
                        ("the filmstrip needs", "show fewer frames, or make them smaller, such as 320x200")
                    }
                    MemoryUse::Pictures => {
                        ("all pictures together need", "render fewer frames at a time, or smaller ones")
                    }
                    MemoryUse::Measurement => (
                        "to compare pictures of this size needs",
                        "measure smaller ones with --size, such as 320x200, or fewer frames",
                    ),
                };
                let (needed, available) = (units::bytes(*needed), units::bytes(*available));
                write!(f, "{what} {needed} of memory and there are {available}; {mend}")
            }
            Self::Camera { frame, why } => write!(f, "frame {frame} has no camera: {why}"),
            Self::Mesh { frame, why } => write!(f, "frame {frame}: {why}"),
            Self::Stopped { done, .. } => {
                write!(f, "stopped after {}", units::counted(*done as u64, "frame"))
            }
            Self::Threads(why) => write!(f, "cannot start the threads: {why}; try fewer with --threads"),
        }
    }
}

impl Error for RenderError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_that_exceed_memory_suggest_a_size() {
        for (what, parts) in [
            (MemoryUse::Picture, ["the picture", "--size", "--draft"]),
            (MemoryUse::Filmstrip, ["the filmstrip", "fewer frames", "320x200"]),
            (MemoryUse::Pictures, ["all pictures", "fewer frames", "smaller"]),
            (MemoryUse::Measurement, ["to compare", "--size", "fewer frames"]),
        ] {
            let text = RenderError::TooLarge { what, needed: 48_000_000_000, available: 8_100_000_000 };
            let text = text.to_string();
            assert!(text.contains("48.0 GB") && text.contains("8.10 GB"), "{text}");
            assert!(parts.iter().all(|part| text.contains(part)), "{text}");
        }
        assert!(matches!(MemoryUse::Picture.check(u64::MAX), Err(RenderError::TooLarge { .. })));
        assert!(MemoryUse::Picture.check(1).is_ok());
    }
}
