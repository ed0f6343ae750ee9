//! The result of an encoder's run.

use crate::film::Noise;
use std::path::PathBuf;
use std::time::Duration;

/// What a run wrote and what the user should know about it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// One path per output, in the job's order: the pattern of stills as the user wrote it, or the file.
    pub files: Vec<PathBuf>,
    /// Number of frames whose files already existed and were left unchanged.
    pub kept: u32,
    /// The noise of frames that were sampled adaptively, kept frames included.
    pub noise: Vec<(u32, Noise)>,
    /// Messages for the user, one line each.
    pub notes: Vec<String>,
    /// Pixels of all films that have a NaN component. Pictures show such components as 0.
    pub nan_pixels: u64,
    /// Time that the encoder's thread has worked.
    pub busy: Duration,
}
