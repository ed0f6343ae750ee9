//! The outputs of a run as the user writes them: `-o out/frame_####.png`, `-o out.gif`.

use super::pattern::{FramePattern, PatternError};
use super::place::same_folder;
use super::settings::Formats;
use crate::base::escape;
use std::ffi::{OsStr, OsString};
use std::fmt;
use std::path::{Path, PathBuf};

/// One output of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Output {
    /// One file per frame.
    Stills(StillFormat, FramePattern),
    /// One file of all frames.
    Movie(AnimationFormat, PathBuf),
    /// All frames on the standard output.
    Stream(StreamFormat),
}

/// Formats of the standard output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StreamFormat {
    /// Raw video.
    Y4m,
    /// Concatenated PPM files, as netpbm's programs read them.
    Ppm,
    /// Concatenated ASCII PPM files, P3.
    AsciiPpm,
    Png,
}

impl StreamFormat {
    /// The formats with their names on the command line.
    pub const NAMED: [(&str, Self); 4] =
        [("y4m", Self::Y4m), ("ppm", Self::Ppm), ("ppm-ascii", Self::AsciiPpm), ("png", Self::Png)];
}

/// Formats of single frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StillFormat {
    Png,
    Jpeg,
    /// Binary, P6.
    Ppm,
    /// OpenEXR with linear radiance.
    Exr,
}

/// Formats of animations and videos.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnimationFormat {
    Gif,
    Apng,
    Webp,
    /// Raw video for other encoders.
    Y4m,
    /// H.264 in an MP4 container.
    Mp4,
}

impl StillFormat {
    /// Whether files of this format hold an identity, so that a later run can check whether they are current.
    pub fn has_identity(self, formats: &Formats) -> bool {
        match self {
            Self::Png => formats.png.metadata,
            Self::Exr => true,
            Self::Jpeg | Self::Ppm => false,
        }
    }
}

/// The extensions of stills.
const STILLS: [(&str, StillFormat); 5] = [
    ("png", StillFormat::Png),
    ("jpg", StillFormat::Jpeg),
    ("jpeg", StillFormat::Jpeg),
    ("ppm", StillFormat::Ppm),
    ("exr", StillFormat::Exr),
];

/// The extensions of animations.
const MOVING: [(&str, AnimationFormat); 5] = [
    ("gif", AnimationFormat::Gif),
    ("apng", AnimationFormat::Apng),
    ("webp", AnimationFormat::Webp),
    ("mp4", AnimationFormat::Mp4),
    ("y4m", AnimationFormat::Y4m),
];

/// Extensions of video formats that Kinora does not write.
const UNSUPPORTED_VIDEOS: [&str; 6] = ["mov", "mkv", "webm", "avi", "m4v", "ogv"];

/// The name of the standard output.
const STREAM: &str = "-";

impl Output {
    /// Parses an output. The extension decides the format, in upper or lower case.
    pub fn parse(text: impl AsRef<Path>) -> Result<Self, OutputError> {
        let text = text.as_ref();
        if text.as_os_str() == STREAM {
            return Ok(Self::Stream(StreamFormat::Y4m));
        }
        let fault = |cause| OutputError { text: text.to_owned(), cause };
        let Some(extension) =
            text.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase())
        else {
            return Err(fault(Cause::NoExtension));
        };
        let pattern = FramePattern::parse(text);
        if let Some(format) = named(&STILLS, &extension) {
            return pattern
                .map(|pattern| Self::Stills(format, pattern))
                .map_err(|e| fault(Cause::Pattern(e)));
        }
        if let Some(format) = named(&MOVING, &extension) {
            return match pattern {
                Ok(pattern) if !pattern.has_placeholder() => Ok(Self::Movie(format, PathBuf::from(text))),
                Err(error @ PatternError::NoFileName) => Err(fault(Cause::Pattern(error))),
                _ => Err(fault(Cause::PlaceholderInMovie)),
            };
        }
        let video = UNSUPPORTED_VIDEOS.contains(&extension.as_str());
        Err(fault(if video { Cause::UnsupportedVideo } else { Cause::UnknownExtension }))
    }

    /// Whether a run of `frames` frames would write all of them to the same file.
    pub fn needs_placeholder(&self, frames: usize) -> bool {
        frames > 1 && self.pattern().is_some_and(|pattern| !pattern.has_placeholder())
    }

    /// The pattern of the frames' files. None if one file holds all frames.
    pub fn pattern(&self) -> Option<&FramePattern> {
        if let Self::Stills(_, pattern) = self { Some(pattern) } else { None }
    }

    /// Whether it is the standard output.
    pub fn is_stream(&self) -> bool {
        matches!(self, Self::Stream(_))
    }

    /// Whether all frames are written to one file or stream.
    pub fn is_animation(&self) -> bool {
        !matches!(self, Self::Stills(..))
    }

    /// Whether its files are written sequentially, so that they can be pipes and devices.
    pub fn is_sequential(&self) -> bool {
        match self {
            Self::Stills(StillFormat::Png | StillFormat::Jpeg | StillFormat::Ppm, _) => true,
            Self::Movie(AnimationFormat::Y4m, _) | Self::Stream(_) => true,
            Self::Stills(StillFormat::Exr, _) | Self::Movie(..) => false,
        }
    }

    /// Whether its format supports alpha.
    pub fn takes_alpha(&self) -> bool {
        matches!(
            self,
            Self::Stills(StillFormat::Png | StillFormat::Exr, _)
                | Self::Movie(AnimationFormat::Apng | AnimationFormat::Webp, _)
        )
    }

    /// The name as the user wrote it.
    pub fn name(&self) -> &Path {
        match self {
            Self::Stills(_, pattern) => pattern.name(),
            Self::Movie(_, path) => path,
            Self::Stream(_) => Path::new(STREAM),
        }
    }

    /// The same output with `prefix` before the file name.
    pub fn prefixed(&self, prefix: &str) -> Self {
        match self {
            Self::Stream(_) => self.clone(),
            _ => Self::parse(prefixed(self.name(), prefix)).unwrap_or_else(|_| self.clone()),
        }
    }

    /// The first file that both outputs would write for these frames.
    pub fn shared_with(&self, other: &Self, frames: &[u32]) -> Option<PathBuf> {
        if self.extension() != other.extension() || !same_folder(&self.path(0), &other.path(0)) {
            return None;
        }
        let shared = |frame: u32| self.path(frame).file_name() == other.path(frame).file_name();
        let numbered = |output: &Self| output.pattern().is_some_and(FramePattern::has_placeholder);
        let frames = if numbered(self) || numbered(other) { frames } else { frames.get(..1)? };
        frames.iter().find(|&&frame| shared(frame)).map(|&frame| self.path(frame))
    }

    fn extension(&self) -> Option<OsString> {
        self.path(0).extension().map(OsStr::to_owned)
    }

    /// The existing files of these frames, which must be in ascending order.
    pub fn existing_files(&self, frames: &[u32]) -> Vec<PathBuf> {
        match self {
            Self::Stream(_) => Vec::new(),
            Self::Stills(_, pattern) if pattern.has_placeholder() => {
                // If the folder cannot be listed, writing to it will report the error.
                let there = pattern.numbers().unwrap_or_default().into_iter();
                there.filter(|n| frames.binary_search(n).is_ok()).map(|n| pattern.path(n)).collect()
            }
            Self::Stills(..) | Self::Movie(..) => {
                let path = self.path(0);
                // Broken links count as existing.
                if path.symlink_metadata().is_ok() { vec![path] } else { Vec::new() }
            }
        }
    }

    /// The file of `frame`.
    pub fn path(&self, frame: u32) -> PathBuf {
        match self {
            Self::Stills(_, pattern) => pattern.path(frame),
            Self::Movie(_, path) => path.clone(),
            Self::Stream(_) => PathBuf::from(STREAM),
        }
    }
}

/// The same path with `prefix` before the file name.
pub fn prefixed(path: &Path, prefix: &str) -> PathBuf {
    let mut name = OsString::from(prefix);
    name.push(path.file_name().unwrap_or_default());
    path.with_file_name(name)
}

fn named<T: Copy>(table: &[(&str, T)], extension: &str) -> Option<T> {
    table.iter().find(|(name, _)| *name == extension).map(|(_, format)| *format)
}

impl fmt::Display for Output {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&escape::path(self.name()))
    }
}

/// Why a text is not an output. The message is one line and says what would be right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputError {
    text: PathBuf,
    cause: Cause,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Cause {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extension_selects_the_format() {
        for (text, format) in [
            ("a/b_####.png", StillFormat::Png),
            ("A.JPEG", StillFormat::Jpeg),
            ("a_####.ppm", StillFormat::Ppm),
            ("a.exr", StillFormat::Exr),
        ] {
            assert!(matches!(Output::parse(text), Ok(Output::Stills(found, _)) if found == format), "{text}");
        }
        for (name, format) in MOVING {
            let text = format!("a/b.{name}");
            assert_eq!(Output::parse(&text), Ok(Output::Movie(format, text.into())));
        }
        assert_eq!(Output::parse("-"), Ok(Output::Stream(StreamFormat::Y4m)));
    }

    #[test]
    fn displays_as_the_user_wrote_it() {
        for text in ["./a//b_%04d.png", "b.GIF", "b.png", "-"] {
            assert_eq!(Output::parse(text).expect(text).to_string(), text);
        }
    }

    #[test]
    fn only_stills_of_several_frames_need_a_placeholder() {
        let needs = |text, frames| Output::parse(text).expect(text).needs_placeholder(frames);
        assert!(needs("a.png", 2) && needs("a.exr", 2));
        assert!(!needs("a.png", 1));
        assert!(!needs("a_#.png", 2));
        assert!(!needs("a.gif", 2) && !needs("-", 2));
    }

    #[test]
    fn outputs_that_share_a_file_are_found() {
        let shared = |a: &str, b: &str, frames: &[u32]| {
            let parsed = |text| Output::parse(text).expect(text);
            let path = parsed(a).shared_with(&parsed(b), frames);
            path.map(escape::path)
        };
        assert_eq!(shared("a_#.png", "./a_##.png", &[3, 9]), None);
        assert_eq!(shared("a_#.png", "./a_##.png", &[3, 9, 10]), Some("a_10.png".into()));
        assert_eq!(shared("a_#.png", "b/a_#.png", &[3]), None);
        assert_eq!(shared("a_#.png", "a_3.png", &[3]), Some("a_3.png".into()));
        assert_eq!(shared("a.gif", "./a.gif", &[0, 1]), Some("a.gif".into()));
        assert_eq!(shared("a.gif", "none/../a.gif", &[0, 1]), Some("a.gif".into()));
        assert_eq!(shared("a.gif", "a.apng", &[0, 1]), None);
        assert_eq!(shared("-", "a.y4m", &[0]), None);
        assert_eq!(shared("-", "-", &[0]), Some("-".into()));
    }

    #[test]
    fn refusals_say_what_is_right() {
        for (text, part) in [
            ("a.tiff", "known are .png"),
            ("a", "known are .png"),
            ("a.webm", "write .mp4, or .y4m"),
            ("a_##.mp4", "leave the place out"),
            ("a_##.gif", "leave the place out"),
            ("a_##_#.png", "keep one run of #"),
            ("a_%4d.png", "write %04d"),
        ] {
            let message = Output::parse(text).expect_err(text).to_string();
            assert!(message.contains(part) && message.contains(text), "{message}");
        }
    }
}
