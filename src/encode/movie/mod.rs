//! In: pictures, one after the other. Out: an APNG, WebP, MP4 or Y4M file, or Y4M on the standard output.
//!
//! GIFs are separate, because their palette is known only after the last frame.

pub mod apng;
pub mod clock;
pub mod difference;
#[cfg(feature = "video")]
mod gops;
#[cfg(feature = "video")]
mod h264;
#[cfg(feature = "video")]
mod h264_encoder;
#[cfg(feature = "video")]
pub mod mp4;
#[cfg(test)]
#[cfg(feature = "video")]
mod tests;
pub mod webp;
mod writer;
pub mod y4m;
mod yuv;

pub use writer::MovieWriter;

use super::error::EncodeError;
use super::job::EncodeJob;
use super::output::{AnimationFormat, Output, StreamFormat};
use crate::base::cancel::Stop;
use rayon::ThreadPool;
use std::sync::Arc;

/// Starts the animation of an output. `None` for stills and GIFs. The threads of `pool` encode videos.
#[cfg_attr(not(feature = "video"), expect(unused_variables, reason = "only videos are encoded in a pool"))]
pub fn start(
    output: &Output,
    job: &EncodeJob,
    pool: &Arc<ThreadPool>,
    stop: &Stop,
) -> Result<Option<Box<dyn MovieWriter>>, EncodeError> {
    let (format, path) = match output {
        Output::Stills(..) => return Ok(None),
        Output::Stream(StreamFormat::Y4m) => return Ok(Some(Box::new(y4m::Y4m::to_stdout(job)?))),
        // Streams of stills, which the worker writes.
        Output::Stream(StreamFormat::Ppm | StreamFormat::AsciiPpm | StreamFormat::Png) => return Ok(None),
        Output::Movie(format, path) => (format, path),
    };
    Ok(match format {
        AnimationFormat::Gif => None,
        AnimationFormat::Apng => Some(Box::new(apng::Apng::create(path, job)?)),
        AnimationFormat::Webp => Some(Box::new(webp::Webp::create(path, job)?)),
        AnimationFormat::Y4m => Some(Box::new(y4m::Y4m::create(path, job, stop)?)),
        #[cfg(not(feature = "video"))]
        AnimationFormat::Mp4 => {
            crate::encode::check_size(output, 0, job.size)?;
            None
        }
        #[cfg(feature = "video")]
        AnimationFormat::Mp4 => Some(Box::new(mp4::Mp4::create(path, job, pool)?)),
    })
}
