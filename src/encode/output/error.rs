//! Errors of texts that are not outputs.

use crate::base::escape;
use crate::encode::pattern::PatternError;
use std::fmt;
use std::path::PathBuf;

/// Why a text is not an output. The message is one line and says what would be right.
#[derive(Clone, Debug, PartialEq, Eq)]
#[warn(missing_docs)]
pub struct OutputError {
    pub(super) text: PathBuf,
    pub(super) cause: Cause,
}

/// What is wrong with the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Cause {
    NoExtension,
    UnknownExtension,
    UnsupportedVideo,
    PlaceholderInMovie,
    Pattern(PatternError),
}

const KNOWN: &str = "known are .png, .jpg, .ppm and .exr (one file per frame: \"frame_####.png\"), and .gif, .apng, \
     .webp, .mp4 and .y4m (one file for all)";

impl fmt::Display for OutputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "output \"{}\" ", escape::path(&self.text))?;
        match self.cause {
            Cause::NoExtension => write!(f, "has no extension, which selects the format; {KNOWN}"),
            Cause::UnknownExtension => write!(f, "has an unknown extension; {KNOWN}"),
            Cause::UnsupportedVideo => f.write_str(
                "is a video format that Kinora does not write; write .mp4, or .y4m (- on the command line for the \
                 standard output), which other programs can convert",
            ),
            Cause::PlaceholderInMovie => f.write_str(
                "has a place for frame numbers, but one file of this format holds all frames; leave the place out",
            ),
            Cause::Pattern(PatternError::NoFileName) => f.write_str("has no file name"),
            Cause::Pattern(PatternError::TwoPlaceholders) => {
                f.write_str("has two places for the frame number; keep one run of # or one %04d")
            }
            Cause::Pattern(PatternError::PadsWithSpaces) => {
                f.write_str("would pad frame numbers with spaces; write %04d, with a zero")
            }
            Cause::Pattern(PatternError::TooWide) => {
                f.write_str("has more digits than frame numbers can have; \"####\" is usual")
            }
            Cause::Pattern(PatternError::NotText) => f.write_str("is not valid Unicode; choose another name"),
        }
    }
}

impl std::error::Error for OutputError {}
