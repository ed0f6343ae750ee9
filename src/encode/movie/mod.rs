//! Animations that take their frames one after the other. GIFs are not among them: they know their palette only
//! after the last frame.

pub mod apng;
pub mod clock;
pub mod difference;
mod gops;
mod h264;
mod h264_encoder;
pub mod mp4;
#[cfg(test)]
mod tests;
pub mod webp;
pub mod y4m;
mod yuv;

use super::error::EncodeError;
use super::job::Job;
use super::output::{Moving, Output, Streamed};
use super::picture::Picture;
use crate::base::cancel::Stop;
use rayon::ThreadPool;
use std::path::PathBuf;
use std::sync::Arc;

/// An animation in the making. Its file appears when it is finished, and not at all if it is dropped before.
pub trait Movie: Send {
    /// Adds the job's next frame.
    fn push(&mut self, picture: &Picture) -> Result<(), EncodeError>;

    /// Seconds of processor time that other threads have spent on this animation so far.
    fn cpu(&self) -> f64 {
        0.0
    }

    /// Writes what is left.
    fn finish(self: Box<Self>) -> Result<(), EncodeError>;

    /// From now on the animation is a part of what it was to be, and will be beside its place; names the file, if it is one.
    fn divert(&mut self) -> Option<PathBuf>;

    /// Closes the animation with the frames that came, beside the place of the whole one, and names the file.
    fn stop(mut self: Box<Self>) -> Result<Option<PathBuf>, EncodeError> {
        let path = self.divert();
        self.finish().map(|()| path)
    }
}

/// Starts the animation that an output is, unless it is none or a GIF. Videos are encoded on the threads of `pool`.
pub fn start(
    output: &Output,
    job: &Job,
    pool: &Arc<ThreadPool>,
    stop: &Stop,
) -> Result<Option<Box<dyn Movie>>, EncodeError> {
    let (format, path) = match output {
        Output::Stills(..) => return Ok(None),
        Output::Stream(Streamed::Y4m) => return Ok(Some(Box::new(y4m::Y4m::to_stdout(job)?))),
        // Frames by themselves, which the worker writes.
        Output::Stream(Streamed::Ppm | Streamed::AsciiPpm | Streamed::Png) => return Ok(None),
        Output::Movie(format, path) => (format, path),
    };
    Ok(match format {
        Moving::Gif => None,
        Moving::Apng => Some(Box::new(apng::Apng::create(path, job)?)),
        Moving::Webp => Some(Box::new(webp::Webp::create(path, job)?)),
        Moving::Y4m => Some(Box::new(y4m::Y4m::create(path, job, stop)?)),
        Moving::Mp4 => Some(Box::new(mp4::Mp4::create(path, job, pool)?)),
    })
}
