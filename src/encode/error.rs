//! What can go wrong between films and files, grouped by cause.

use super::inspect::Flaw;
use crate::base::escape;
use crate::base::files::Channel;
use crate::base::frame_set::{self, MOST_FRAMES};
use std::collections::BTreeMap;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

#[derive(Debug)]
pub enum EncodeError {
    /// The job contradicts itself or a format; nothing was written.
    Job(JobError),
    /// A file or folder could not be written.
    Write { path: PathBuf, reason: io::Error },
    /// A stored frame could not be read back.
    Read { path: PathBuf, reason: io::Error },
    /// A picture that is to be part of an animation cannot be read.
    Unreadable { path: PathBuf, reason: io::Error },
    /// A signal of this number came while a pipe was waited for that nobody reads, after the films of so many frames.
    Interrupted { signal: usize, done: usize },
    /// What was pushed is not what the job announced.
    Films(FilmsError),
    /// The encoder has failed before and has told why, or its thread could not live.
    Stopped(Option<io::Error>),
}

/// What is wrong with a job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JobError {
    /// `frames` frames would all go to one file.
    NoPlace { output: String, frames: usize, suggestion: String },
    /// Two outputs write the same file.
    Duplicate { path: PathBuf },
    /// A folder stands where a file should go.
    IsFolder { path: PathBuf },
    /// A file stands where the path has a folder.
    IsFile { path: PathBuf, file: PathBuf },
    /// A link leads out of the working directory, in which a sequence has to stay.
    Leaves { path: PathBuf, to: PathBuf },
    /// A format does not go into a pipe or a device, or nothing does.
    Channel { path: PathBuf, channel: Channel },
    /// Frames that something is to be made of, and what is wrong with each; with what to do about it.
    Frames { names: String, flaws: Vec<(u32, Flaw)>, advice: &'static str },
    /// From the first frame to the last there are more than any run has.
    Apart { names: String, first: u32, last: u32 },
    /// What is made of frames would be one of them; with its path among them, or the pattern of their names.
    OwnFrame { path: PathBuf, frames: PathBuf },
    /// No file can be made in a folder of the system.
    NoFiles { folder: PathBuf, why: String },
    /// A file is there, and none is to be replaced.
    Exists { path: PathBuf },
    /// Processes cannot share the making of what does not say what it shows.
    NotShared { output: String },
    /// No frames, or no pixels.
    Empty,
    /// A format that holds no single picture.
    NoPicture { output: String },
    /// A picture of more pixels than a format takes; `limit` says how many those are.
    TooLarge { path: PathBuf, size: (u32, u32), limit: &'static str },
    /// An animation that runs for months.
    TooLong { path: PathBuf },
}

/// How films differ from what the job announced.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FilmsError {
    /// Another frame was to come; none if all had come.
    Order {
        expected: Option<u32>,
        got: u32,
    },
    Size {
        frame: u32,
        expected: (u32, u32),
        got: (u32, u32),
    },
    /// `finish` before the last frame.
    Missing {
        expected: usize,
        got: usize,
    },
}

impl EncodeError {
    pub(super) fn write(path: impl AsRef<Path>, reason: impl Into<io::Error>) -> Self {
        Self::Write { path: path.as_ref().to_path_buf(), reason: reason.into() }
    }

    /// In a folder that is there, but takes no files.
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
            Self::Interrupted { .. } => f.write_str("stopped while a pipe was waited for that nobody reads"),
            Self::Stopped(None) => f.write_str("the encoder has stopped after an earlier error"),
            Self::Stopped(Some(reason)) => write!(f, "cannot run the encoder's thread: {reason}"),
        }
    }
}

/// The reason without the name of the temporary file that it was met at, which `tempfile` adds.
fn plain(reason: &io::Error) -> String {
    let text = reason.to_string();
    text.split_once(" at path ").map_or(text.clone(), |(why, _)| why.to_owned())
}

/// What helps where a folder takes no files, as the end of a message.
const NO_FILES: &str = "; no file can be made there, so name another place with -o";

/// What usually helps, as the end of a message.
fn remedy(reason: &io::Error) -> &'static str {
    match reason.kind() {
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            "; name a place you may write to with -o"
        }
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "; free some space or name another place with -o"
        }
        io::ErrorKind::NotFound => NO_FILES,
        io::ErrorKind::FileTooLarge => {
            "; a file may not become so large: raise the limit (ulimit -f), or render less at a time"
        }
        io::ErrorKind::BrokenPipe => "; whoever was to read it has gone away",
        io::ErrorKind::NotADirectory | io::ErrorKind::AlreadyExists => {
            "; a file stands where the path has a folder"
        }
        _ => "",
    }
}

impl fmt::Display for JobError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoPlace { output, frames, suggestion } => write!(
                f,
                "output \"{output}\" has no place for the numbers of {frames} frames; write \"{suggestion}\""
            ),
            Self::Duplicate { path } => {
                write!(f, "two outputs would write {}; name each file once", escape::path(path))
            }
            Self::NotShared { output } => write!(
                f,
                "{output} does not say what it shows, so processes that share the work could not tell what is done; write \
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
            Self::Channel { path, channel: channel @ Channel::Socket } => {
                write!(f, "cannot write {}: it is {}; name a file", escape::path(path), channel.name())
            }
            Self::Channel { path, channel } => write!(
                f,
                "cannot write {}: it is {}, into which only .png, .jpg, .ppm and .y4m go, which are written from their \
                 beginning to their end; name a file",
                escape::path(path),
                channel.name()
            ),
            Self::Frames { names, flaws, advice } => {
                write!(f, "{names} cannot be assembled:")?;
                by_flaw(flaws).try_for_each(|(flaw, frames)| write!(f, "\n  frames {frames}: {flaw}"))?;
                write!(f, "\n{advice}")
            }
            Self::Apart { names, first, last } => write!(
                f,
                "{names}: frames {first} to {last} are more than {MOST_FRAMES}, the most of one run; name those that are \
                 meant with --frames"
            ),
            Self::OwnFrame { path, frames } => write!(
                f,
                "cannot write {}: it would be one of the frames {} that it is made of; name another file",
                escape::path(path),
                escape::path(frames)
            ),
            Self::NoFiles { folder, why } => {
                write!(f, "cannot write {}: {why}{NO_FILES}", escape::path(folder))
            }
            Self::Exists { path } => write!(
                f,
                "{} is there already; name another file, or leave out --fail-if-exists to keep what is right and \
                 replace what is not",
                escape::path(path)
            ),
            Self::Empty => f.write_str("there is nothing to write: no frames, or a size of zero"),
            Self::NoPicture { output } => {
                write!(f, "output \"{output}\" holds no picture; write .png, .jpg or .ppm")
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

/// What is wrong, each with the frames of which it is, as `--frames` takes them.
fn by_flaw(flaws: &[(u32, Flaw)]) -> impl Iterator<Item = (&Flaw, String)> {
    let mut by_flaw: BTreeMap<&Flaw, Vec<u32>> = BTreeMap::new();
    for (frame, flaw) in flaws {
        by_flaw.entry(flaw).or_default().push(*frame);
    }
    by_flaw.into_iter().map(|(flaw, frames)| (flaw, frame_set::text(&frames)))
}

impl fmt::Display for FilmsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Order { expected: Some(expected), got } => {
                write!(f, "frame {got} came where frame {expected} was to come")
            }
            Self::Order { expected: None, got } => write!(f, "frame {got} came after the last one"),
            Self::Size { frame, expected, got } => write!(
                f,
                "frame {frame} has {}x{} pixels instead of {}x{}",
                got.0, got.1, expected.0, expected.1
            ),
            Self::Missing { expected, got } => write!(f, "only {got} of {expected} frames came"),
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
