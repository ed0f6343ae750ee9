//! A developed frame as the bytes of a file: PNG, JPEG or PPM.

use super::develop::develop_deep;
use super::info::FrameInfo;
use super::job::EncodeJob;
use super::metadata::{self, TextEntry};
use super::output::{Output, StillFormat, StreamFormat};
use super::picture::Picture;
use super::{jpeg, png, ppm};
use crate::base::digest::Digest;
use crate::film::Film;
use std::io;

/// A frame that is being written.
pub struct DevelopedFrame<'a> {
    /// Its index in the job's list.
    pub index: usize,
    pub info: FrameInfo<'a>,
    pub film: &'a Film,
    pub picture: &'a Picture,
    /// The picture without alpha.
    pub opaque: &'a Picture,
}

/// The frame's identity. `None` for unfinished frames, because a later run must not keep them.
pub fn identity(job: &EncodeJob, format: StillFormat, frame: &DevelopedFrame) -> Option<Digest> {
    job.identity(format, frame.index).filter(|_| !frame.film.unfinished)
}

/// The metadata of a frame's file.
pub fn metadata(job: &EncodeJob, format: StillFormat, frame: &DevelopedFrame) -> Vec<TextEntry> {
    if !job.writes_metadata(format) {
        return Vec::new();
    }
    let mut entries = metadata::frame_entries(&frame.info, job.frame_keys.get(frame.index));
    entries.extend(frame.film.noise.as_ref().map(metadata::noise_entry));
    entries
}

/// The bytes of a frame's own file. `None` for EXR, which is written directly, and for files of several frames.
pub fn still(job: &EncodeJob, output: &Output, frame: &DevelopedFrame) -> Option<io::Result<Vec<u8>>> {
    match output {
        Output::Stills(StillFormat::Png, _) | Output::Stream(StreamFormat::Png) => {
            Some(png_bytes(job, frame))
        }
        _ => without_alpha(job, output, frame.opaque),
    }
}

fn png_bytes(job: &EncodeJob, frame: &DevelopedFrame) -> io::Result<Vec<u8>> {
    let (entries, identity) =
        (metadata(job, StillFormat::Png, frame), identity(job, StillFormat::Png, frame));
    if !job.formats.png.deep {
        return png::sealed(frame.picture, entries, identity);
    }
    let mut deep = develop_deep(job.tonemap, frame.film);
    if let Some(caption) = &job.caption {
        caption.draw(&mut deep, &frame.info);
    }
    png::sealed(&deep, entries, identity)
}

/// The bytes of a picture in a single-frame format without alpha. `None` for other formats.
pub fn without_alpha(job: &EncodeJob, output: &Output, opaque: &Picture) -> Option<io::Result<Vec<u8>>> {
    let ascii = job.formats.ppm.ascii;
    match output {
        Output::Stills(StillFormat::Jpeg, _) => Some(jpeg::encode(opaque, job.formats.jpeg.quality)),
        Output::Stills(StillFormat::Ppm, _) | Output::Stream(StreamFormat::Ppm) => {
            Some(ppm::encode(opaque, ascii))
        }
        Output::Stream(StreamFormat::AsciiPpm) => Some(ppm::encode(opaque, true)),
        Output::Stills(StillFormat::Png | StillFormat::Exr, _)
        | Output::Stream(StreamFormat::Png | StreamFormat::Y4m)
        | Output::Movie(..) => None,
    }
}
