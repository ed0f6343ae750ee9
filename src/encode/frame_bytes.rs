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
use tracing::debug_span;

/// A picture with its annotations.
pub struct DrawnPicture {
    pub picture: Picture,
    /// The picture without annotations. None if it has none, or if no file will hold it.
    clean: Option<Picture>,
}

impl DrawnPicture {
    /// Draws the annotations of the frame of an index.
    pub fn new(job: &EncodeJob, index: usize, mut picture: Picture) -> Self {
        let kept = job.is_annotated(index) && job.source().is_some();
        let clean = kept.then(|| picture.clone());
        debug_span!("annotate").in_scope(|| job.annotate(index, &mut picture));
        Self { picture, clean }
    }

    /// The bytes of its PNG file of 8 bits per channel.
    pub fn png(&self, job: &EncodeJob, index: usize, entries: Vec<TextEntry>) -> io::Result<Vec<u8>> {
        let identity = job.identity(StillFormat::Png, index);
        let clean = self.clean.as_ref().zip(job.clean_identity(StillFormat::Png, index));
        let below =
            clean.map(|(clean, identity)| png::underlay(clean, &self.picture, identity)).transpose()?;
        png::sealed(&self.picture, entries, identity, below.as_deref())
    }
}

/// A frame that is being written.
pub struct DevelopedFrame<'a> {
    /// Its index in the job's list.
    pub index: usize,
    pub info: FrameInfo<'a>,
    pub film: &'a Film,
    pub drawn: &'a DrawnPicture,
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
    let entries = metadata(job, StillFormat::Png, frame);
    if !job.formats.png.deep && !frame.film.unfinished {
        return frame.drawn.png(job, frame.index, entries);
    }
    let identity = identity(job, StillFormat::Png, frame);
    if !job.formats.png.deep {
        return png::sealed(&frame.drawn.picture, entries, identity, None);
    }
    let mut deep = develop_deep(job.tonemap, frame.film);
    job.annotate(frame.index, &mut deep);
    png::sealed(&deep, entries, identity, None)
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
