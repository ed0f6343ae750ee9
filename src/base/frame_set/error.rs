//! Errors of frame sets. Each message says what would be right.

use std::error::Error;
use std::fmt::{Display, Formatter, Result};

/// Why a text is not a set of frames, or not one of this sequence. Parts are quoted as the user wrote them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FrameSetError {
    /// The text is empty.
    Empty,
    /// The part is neither a number nor a range.
    Malformed(String),
    /// A number is negative.
    Negative(String),
    /// A number exceeds the frames that any sequence can have.
    TooLarge(String),
    /// The end is before the start.
    Backwards {
        part: String,
        first: u32,
        end: u32,
    },
    /// The exclusive end of a range equals its start.
    NoFrames {
        part: String,
        frame: u32,
    },
    ZeroStep(String),
    /// A step after a single frame.
    StepWithoutRange(String),
    /// The sequence ends before this frame.
    Beyond {
        frame: u32,
        count: u32,
    },
    /// More frames than one run may hold.
    TooMany {
        max: usize,
    },
}

impl Display for FrameSetError {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Empty => write!(f, "no frames given; write for example 0-47, 0..48 or 7,9,20"),
            Self::Malformed(part) => {
                write!(
                    f,
                    "`{part}` is neither a frame nor a range; write for example 7, 0-47, 0..48 or 1-40:2"
                )
            }
            Self::Negative(part) => write!(f, "`{part}` has a negative number; frames count from 0"),
            Self::TooLarge(number) => write!(f, "{number} is too large; frames count up to {}", u32::MAX),
            Self::Backwards { part, first, end } => {
                write!(f, "`{part}` runs backwards; write {end}-{first} (frames are always in rising order)")
            }
            Self::NoFrames { part, frame } => {
                write!(
                    f,
                    "`{part}` contains no frame, because its end is exclusive; write {frame} for that frame"
                )
            }
            Self::ZeroStep(part) => write!(f, "`{part}` has a step of 0; the smallest step is 1"),
            Self::StepWithoutRange(part) => {
                write!(f, "`{part}` has a step but no range; write for example 1-40:2")
            }
            Self::Beyond { frame, count: 0 } => write!(f, "there is no frame {frame}; the sequence is empty"),
            Self::Beyond { frame, count: 1 } => {
                write!(f, "there is no frame {frame}; the sequence has one frame, 0")
            }
            Self::Beyond { frame, count } => {
                let last = count - 1;
                write!(f, "there is no frame {frame}; the sequence has {count} frames, 0-{last}")
            }
            Self::TooMany { max } => {
                write!(f, "more than {max} frames in one run; select fewer with --frames, such as 0-47")
            }
        }
    }
}

impl Error for FrameSetError {}
