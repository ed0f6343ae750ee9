//! What a run writes, as the user says it: `-o out/frame_####.png`, `-o out.gif`.

use super::pattern::{FramePattern, PatternError};
use std::fmt;
use std::path::{Path, PathBuf};

/// One thing to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Output {
    /// One PNG per frame.
    Png(FramePattern),
    /// One binary PPM per frame.
    Ppm(FramePattern),
    /// One OpenEXR file per frame.
    Exr(FramePattern),
    /// One GIF of all frames.
    Gif(PathBuf),
}

impl Output {
    /// Reads an output; its format follows the extension, in either case.
    pub fn parse(text: &str) -> Result<Self, OutputError> {
        let fault = |cause| OutputError { text: text.to_owned(), cause };
        let pattern = || FramePattern::parse(text).map_err(|e| fault(Cause::Pattern(e)));
        let extension = Path::new(text).extension().and_then(|extension| extension.to_str());
        match extension.map(str::to_ascii_lowercase).as_deref() {
            Some("png") => pattern().map(Self::Png),
            Some("ppm") => pattern().map(Self::Ppm),
            Some("exr") => pattern().map(Self::Exr),
            Some("gif") => match FramePattern::parse(text) {
                Ok(pattern) if !pattern.has_place() => Ok(Self::Gif(PathBuf::from(text))),
                Err(error @ PatternError::NoFileName) => Err(fault(Cause::Pattern(error))),
                _ => Err(fault(Cause::PlaceInGif)),
            },
            Some(_) => Err(fault(Cause::UnknownExtension)),
            None => Err(fault(Cause::NoExtension)),
        }
    }

    /// Whether a run of `frames` frames would write all of them to one and the same file.
    pub fn needs_place(&self, frames: usize) -> bool {
        frames > 1 && self.pattern().is_some_and(|pattern| !pattern.has_place())
    }

    /// The names of the frames' own files, unless one file holds all.
    pub fn pattern(&self) -> Option<&FramePattern> {
        match self {
            Self::Png(pattern) | Self::Ppm(pattern) | Self::Exr(pattern) => Some(pattern),
            Self::Gif(_) => None,
        }
    }

    /// Whether all frames go into one file that shows them one after the other.
    pub fn is_animation(&self) -> bool {
        matches!(self, Self::Gif(_))
    }

    /// The same output with `prefix` in front of the file's name.
    pub fn prefixed(&self, prefix: &str) -> Self {
        let text = self.to_string();
        let path = Path::new(&text);
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let prefixed = path.with_file_name(format!("{prefix}{name}"));
        Self::parse(&prefixed.to_string_lossy()).unwrap_or_else(|_| self.clone())
    }

    /// The file that `frame` goes to.
    pub fn path(&self, frame: u32) -> PathBuf {
        match self {
            Self::Png(pattern) | Self::Ppm(pattern) | Self::Exr(pattern) => pattern.path(frame),
            Self::Gif(path) => path.clone(),
        }
    }
}

impl fmt::Display for Output {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Png(pattern) | Self::Ppm(pattern) | Self::Exr(pattern) => pattern.fmt(f),
            Self::Gif(path) => path.display().fmt(f),
        }
    }
}

/// Why a text names no output. Displays as one line that says what would be right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputError {
    text: String,
    cause: Cause,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Cause {
    NoExtension,
    UnknownExtension,
    PlaceInGif,
    Pattern(PatternError),
}

const KNOWN: &str =
    "known are .png, .ppm and .exr (one file per frame: \"frame_####.png\") and .gif (one file for all)";

impl fmt::Display for OutputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "output \"{}\" ", self.text)?;
        match self.cause {
            Cause::NoExtension => write!(f, "has no extension to tell its format; {KNOWN}"),
            Cause::UnknownExtension => write!(f, "has an unknown extension; {KNOWN}"),
            Cause::PlaceInGif => f.write_str(
                "has a place for frame numbers, but one GIF holds all frames; leave the place out",
            ),
            Cause::Pattern(PatternError::NoFileName) => f.write_str("has no file name"),
            Cause::Pattern(PatternError::TwoPlaces) => {
                f.write_str("has two places for the frame number; keep one run of # or one %04d")
            }
            Cause::Pattern(PatternError::PadsWithSpaces) => {
                f.write_str("would pad frame numbers with spaces; write %04d, with a zero")
            }
            Cause::Pattern(PatternError::TooWide) => {
                f.write_str("asks for more digits than frame numbers have; \"####\" is usual")
            }
        }
    }
}

impl std::error::Error for OutputError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_follow_the_extension() {
        assert!(matches!(Output::parse("a/b_####.png"), Ok(Output::Png(_))));
        assert!(matches!(Output::parse("A.PNG"), Ok(Output::Png(_))));
        assert!(matches!(Output::parse("a_####.ppm"), Ok(Output::Ppm(_))));
        assert!(matches!(Output::parse("a_####.exr"), Ok(Output::Exr(_))));
        assert_eq!(Output::parse("a/b.gif"), Ok(Output::Gif("a/b.gif".into())));
    }

    #[test]
    fn shows_what_the_user_wrote() {
        for text in ["./a//b_%04d.png", "b.GIF", "b.png"] {
            assert_eq!(Output::parse(text).expect(text).to_string(), text);
        }
    }

    #[test]
    fn only_stills_of_several_frames_need_a_place() {
        let needs = |text, frames| Output::parse(text).expect(text).needs_place(frames);
        assert!(needs("a.png", 2) && needs("a.exr", 2));
        assert!(!needs("a.png", 1));
        assert!(!needs("a_#.png", 2));
        assert!(!needs("a.gif", 2));
    }

    #[test]
    fn refusals_say_what_is_right() {
        for (text, part) in [
            ("a.webp", "known are .png"),
            ("a", "known are .png"),
            ("-", "known are .png"),
            ("a_##.gif", "leave the place out"),
            ("a_##_#.png", "keep one run of #"),
            ("a_%4d.png", "write %04d"),
        ] {
            let message = Output::parse(text).expect_err(text).to_string();
            assert!(message.contains(part) && message.contains(text), "{message}");
        }
    }
}
