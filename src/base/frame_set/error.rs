//! What can be wrong with a set of frames, and what would be right.

use std::error::Error;
use std::fmt::{Display, Formatter, Result};

/// Why a text is no set of frames, or not one of this sequence. Parts are as the user wrote them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FrameSetError {
    /// Nothing was named at all.
    Empty,
    /// Neither a number nor a range.
    Malformed(String),
    /// Frames count from zero.
    Negative(String),
    /// More than any sequence can have.
    TooLarge(String),
    /// The end lies before the beginning.
    Backwards {
        part: String,
        first: u32,
        end: u32,
    },
    /// A range whose exclusive end is its beginning.
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
    TooMany,
}

impl Display for FrameSetError {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Empty => write!(f, "no frames named; write for example 0-47, 0..48 or 7,9,20"),
            Self::Malformed(part) => {
                write!(f, "`{part}` is no frame or range; write for example 7, 0-47, 0..48 or 1-40:2")
            }
            Self::Negative(part) => write!(f, "`{part}` has a negative number; frames count from 0"),
            Self::TooLarge(number) => write!(f, "{number} is too large; frames count up to {}", u32::MAX),
            Self::Backwards { part, first, end } => {
                write!(f, "`{part}` runs backwards; write {end}-{first} (frames always come in rising order)")
            }
            Self::NoFrames { part, frame } => {
                write!(f, "`{part}` holds no frame, for its end is exclusive; write {frame} for that frame")
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
            Self::TooMany => {
                let most = super::MOST_FRAMES;
                write!(f, "more than {most} frames in one run; name fewer with --frames, such as 0-47")
            }
        }
    }
}

impl Error for FrameSetError {}
