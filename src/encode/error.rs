//! Errors of encoding, grouped by cause.

use super::flaw::Flaw;
use crate::base::escape;
use crate::base::files::SpecialFile;
use crate::base::frame_set::{self, MAX_FRAMES};
use std::collections::BTreeMap;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

#[derive(Debug)]
pub enum EncodeError {
    /// The job is invalid. Nothing was written.
    Job(JobError),
    /// A file or folder could not be written.
    Write { path: PathBuf, reason: io::Error },
    /// A stored frame could not be read back.
    Read { path: PathBuf, reason: io::Error },
    /// A picture for an animation cannot be read.
    Unreadable { path: PathBuf, reason: io::Error },
    /// A signal ended the wait for a pipe's reader. `done` is the number of finished films.
    Interrupted { signal: usize, done: usize },
    /// The films differ from those that the job announced.
    Films(FilmsError),
    /// The encoder has already returned an error, or its thread could not start.
    Stopped(Option<io::Error>),
}

/// What is wrong with a job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JobError {
    /// `frames` frames would all be written to one file.
    NoPlaceholder { output: String, frames: usize, suggestion: String },
    /// Two outputs write the same file.
    Duplicate { path: PathBuf },
    /// The path of a file is a folder.
    IsFolder { path: PathBuf },
    /// A folder of the path is a file.
    IsFile { path: PathBuf, file: PathBuf },
    /// A link leads out of the working directory, which a sequence's outputs must not leave.
    Leaves { path: PathBuf, to: PathBuf },
    /// The format cannot be written to a pipe or a device, or the path is a socket.
    Channel { path: PathBuf, channel: SpecialFile },
    /// Input frames have flaws; with advice for the user.
    Frames { names: String, flaws: Vec<(u32, Flaw)>, advice: &'static str },
    /// The range from the first to the last frame is larger than any run.
    Apart { names: String, first: u32, last: u32 },
    /// The output would replace one of its own input frames; `frames` is the pattern of their names.
    OwnFrame { path: PathBuf, frames: PathBuf },
    /// The file system takes no new files in this folder, for example in `/proc`.
    NoFiles { folder: PathBuf, why: String },
    /// The file exists, and the job must not replace files.
    Exists { path: PathBuf },
    /// Processes cannot share an output whose files hold no identity.
    NotShared { output: String },
    /// No frames, or no pixels.
    Empty,
    /// The format cannot hold a single picture.
    NoPicture { output: String },
    /// The format cannot hold a picture of this size; `limit` describes its limit.
    TooLarge { path: PathBuf, size: (u32, u32), limit: &'static str },
    /// The animation would play for more than 100 days.
    TooLong { path: PathBuf },
}

/// How films differ from those that the job announced.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FilmsError {
    /// Another frame was expected; None if no more frames were expected.
    Order {
        expected: Option<u32>,
        got: u32,
    },
    Size {
        frame: u32,
        expected: (u32, u32),
        got: (u32, u32),
    },
    /// `finish` was called before the last frame.
    Missing {
        expected: usize,
        got: usize,
    },
}

impl EncodeError {
    pub(super) fn write(path: impl AsRef<Path>, reason: impl Into<io::Error>) -> Self {
        Self::Write { path: path.as_ref().to_path_buf(), reason: reason.into() }
    }

    /// An error for an existing folder that takes no new files.
    pub(super) fn no_files(folder: &Path, reason: &io::Error) -> Self {
        Self::Job(JobError::NoFiles { folder: folder.to_path_buf(), why: plain(reason) })
    }

    pub(super) fn read(path: impl AsRef<Path>, reason: impl Into<io::Error>) -> Self {
        Self::Read { path: path.as_ref().to_path_buf(), reason: reason.into() }
    }
}

impl From<JobError> for EncodeError {
    fn from(error: JobError) -> Self {
        Self::Job(error)
    }
}

impl From<FilmsError> for EncodeError {
    fn from(error: FilmsError) -> Self {
        Self::Films(error)
    }
}

impl fmt::Display for EncodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Job(error) => error.fmt(f),
            Self::Films(error) => error.fmt(f),
            Self::Write { path, reason } => {
                write!(f, "cannot write {}: {}{}", escape::path(path), plain(reason), remedy(reason))
            }
            Self::Read { path, reason } => {
                write!(f, "cannot read the frame {} back for an animation: {reason}; ", escape::path(path))?;
                f.write_str("leave the run's files alone until it ends")
            }
            Self::Unreadable { path, reason } => {
                write!(f, "cannot read the frame {}: {reason}", escape::path(path))
            }
            Self::Interrupted { .. } => f.write_str("stopped while waiting for a reader of a pipe"),
            Self::Stopped(None) => f.write_str("the encoder has stopped after an earlier error"),
            Self::Stopped(Some(reason)) => write!(f, "cannot run the encoder's thread: {reason}"),
        }
    }
}

/// The reason without the path of the temporary file, which `tempfile` adds.
fn plain(reason: &io::Error) -> String {
    let text = reason.to_string();
    text.split_once(" at path ").map_or(text.clone(), |(why, _)| why.to_owned())
}

/// Advice for folders that take no new files, as the end of a message.
const NO_FILES: &str = "; no file can be created there; name another folder with -o";

/// Advice for an I/O error, as the end of a message.
fn remedy(reason: &io::Error) -> &'static str {
    match reason.kind() {
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            "; name a writable folder with -o"
        }
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "; free some space or name another folder with -o"
        }
        io::ErrorKind::NotFound => NO_FILES,
        io::ErrorKind::FileTooLarge => {
            "; the file exceeds the size limit: raise the limit (ulimit -f), or render fewer frames at a time"
        }
        io::ErrorKind::BrokenPipe => "; the reader of the pipe has ended",
        io::ErrorKind::NotADirectory | io::ErrorKind::AlreadyExists => "; a folder of the path is a file",
        _ => "",
    }
}

impl fmt::Display for JobError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoPlaceholder { output, frames, suggestion } => write!(
                f,
                "output \"{output}\" has no place for the numbers of {frames} frames; write \"{suggestion}\""
            ),
            Self::Duplicate { path } => {
                write!(f, "two outputs would write {}; name each file once", escape::path(path))
            }
            Self::NotShared { output } => write!(
                f,
                "{output} cannot hold metadata that identifies its frames, so processes cannot share the work; write \
                 PNGs with metadata, or EXR"
            ),
            Self::IsFolder { path } => {
                write!(f, "cannot write {}: it is a folder; name a file in it", escape::path(path))
            }
            Self::IsFile { path, file } => {
                write!(
                    f,
                    "cannot write {}: {} is a file; name a folder there",
                    escape::path(path),
                    escape::path(file)
                )
            }
            Self::Leaves { path, to } => write!(
                f,
                "cannot write {}: it leads to {}, out of the working directory; only what -o names may go there",
                escape::path(path),
                escape::path(to)
            ),
            Self::Channel { path, channel: channel @ SpecialFile::Socket } => {
                write!(f, "cannot write {}: it is {}; name a file", escape::path(path), channel.name())
            }
            Self::Channel { path, channel } => write!(
                f,
                "cannot write {}: it is {}, which takes only formats that are written sequentially: .png, .jpg, .ppm \
                 and .y4m; name a file",
                escape::path(path),
                channel.name()
            ),
            Self::Frames { names, flaws, advice } => {
                write!(f, "{names} cannot be assembled:")?;
                by_flaw(flaws).try_for_each(|(flaw, frames)| write!(f, "\n  {frames}: {flaw}"))?;
                write!(f, "\n{advice}")
            }
            Self::Apart { names, first, last } => write!(
                f,
                "{names}: frames {first} to {last} are more than {MAX_FRAMES}, the maximum of one run; select frames \
                 with --frames"
            ),
            Self::OwnFrame { path, frames } => write!(
                f,
                "cannot write {}: it would replace one of its input frames {}; name another file",
                escape::path(path),
                escape::path(frames)
            ),
            Self::NoFiles { folder, why } => {
                write!(f, "cannot write {}: {why}{NO_FILES}", escape::path(folder))
            }
            Self::Exists { path } => write!(
                f,
                "{} exists already; name another file, or leave out --fail-if-exists to keep current frames and \
                 replace all others",
                escape::path(path)
            ),
            Self::Empty => {
                f.write_str("there is nothing to write: the job has no frames, or their size is zero")
            }
            Self::NoPicture { output } => {
                write!(f, "output \"{output}\" cannot hold a single picture; write .png, .jpg or .ppm")
            }
            Self::TooLarge { path, size: (width, height), limit } => write!(
                f,
                "{} cannot hold {width}x{height} pixels: {limit}; render smaller (-s) or to PNG",
                escape::path(path)
            ),
            Self::TooLong { path } => {
                write!(
                    f,
                    "{} would play for more than 100 days; raise the frame rate (-r)",
                    escape::path(path)
                )
            }
        }
    }
}

/// Groups frames by their flaw. Frames are written as `--frames` takes them.
fn by_flaw(flaws: &[(u32, Flaw)]) -> impl Iterator<Item = (&Flaw, String)> {
    let mut by_flaw: BTreeMap<&Flaw, Vec<u32>> = BTreeMap::new();
    for (frame, flaw) in flaws {
        by_flaw.entry(flaw).or_default().push(*frame);
    }
    by_flaw.into_iter().map(|(flaw, frames)| {
        let noun = if frames.len() == 1 { "frame" } else { "frames" };
        (flaw, format!("{noun} {}", frame_set::text(&frames)))
    })
}

impl fmt::Display for FilmsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Order { expected: Some(expected), got } => {
                write!(f, "received frame {got} instead of frame {expected}")
            }
            Self::Order { expected: None, got } => write!(f, "received frame {got} after the last frame"),
            Self::Size { frame, expected, got } => write!(
                f,
                "frame {frame} has {}x{} pixels instead of {}x{}",
                got.0, got.1, expected.0, expected.1
            ),
            Self::Missing { expected, got } => write!(f, "received only {got} of {expected} frames"),
        }
    }
}

impl std::error::Error for EncodeError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Job(error) => Some(error),
            Self::Films(error) => Some(error),
            Self::Write { reason, .. }
            | Self::Read { reason, .. }
            | Self::Unreadable { reason, .. }
            | Self::Stopped(Some(reason)) => Some(reason),
            Self::Interrupted { .. } | Self::Stopped(None) => None,
        }
    }
}

impl std::error::Error for JobError {}
impl std::error::Error for FilmsError {}
