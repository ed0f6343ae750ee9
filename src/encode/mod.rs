//! Film → files: develops films into pictures and writes them on a thread of its own.

use crate::film::Film;
use crate::sequence::{GifSettings, Tonemap};
use crate::time::Rate;
use std::path::PathBuf;
use std::time::Duration;

/// One thing to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Output {
    /// One PNG per frame; the path holds the frame number's place.
    Png(PathBuf),
    /// One GIF of all frames.
    Gif(PathBuf),
}

/// What all outputs of one run share.
#[derive(Clone, Debug)]
pub struct Job {
    pub outputs: Vec<Output>,
    /// The frame numbers that will come, in order.
    pub frames: Vec<u32>,
    pub rate: Rate,
    pub size: (u32, u32),
    pub tonemap: Tonemap,
    pub gif: GifSettings,
}

/// What was written.
#[derive(Clone, Debug, Default)]
pub struct Report {
    pub files: Vec<PathBuf>,
    pub notes: Vec<String>,
    /// Time the encoder was at work.
    pub busy: Duration,
}

#[derive(Debug)]
pub struct EncodeError;

/// The encoding thread.
pub struct Encoder;

impl Encoder {
    pub fn start(_job: Job) -> Result<Self, EncodeError> {
        Ok(Self)
    }

    /// Hands over the next frame; waits while the encoder is behind, so that memory stays bounded.
    pub fn push(&mut self, _frame: u32, _film: Film) -> Result<(), EncodeError> {
        Ok(())
    }

    /// Waits for everything to be written.
    pub fn finish(self) -> Result<Report, EncodeError> {
        Ok(Report::default())
    }
}
