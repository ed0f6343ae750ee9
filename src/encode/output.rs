//! The outputs of a run as the user writes them: `-o out/frame_####.png`, `-o out.gif`.

use super::pattern::{FramePattern, PatternError};
use super::place::same_folder;
use crate::base::escape;
use std::ffi::{OsStr, OsString};
use std::fmt;
use std::path::{Path, PathBuf};

mod error;
mod format;
#[cfg(test)]
mod tests;

use error::Cause;
pub use error::OutputError;
pub use format::{AnimationFormat, StillFormat, StreamFormat};
use format::{MOVING, STILLS, UNSUPPORTED_VIDEOS, named};

/// One output of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
#[warn(missing_docs)]
pub enum Output {
    /// One file per frame.
    Stills(StillFormat, FramePattern),
    /// One file of all frames.
    Movie(AnimationFormat, PathBuf),
    /// All frames on the standard output.
    Stream(StreamFormat),
}

/// The name of the standard output.
const STREAM: &str = "-";

#[warn(missing_docs)]
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

    /// The pattern of the frames' files. `None` if one file holds all frames.
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

impl fmt::Display for Output {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&escape::path(self.name()))
    }
}
