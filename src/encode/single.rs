//! Single pictures that are not frames, such as filmstrips.

use super::atomic::AtomicFile;
use super::error::{EncodeError, JobError};
use super::output::{Output, StillFormat};
use super::picture::Picture;
use super::settings::Formats;
use super::{jpeg, png, ppm};
use crate::base::cancel::Stop;
use std::io;
use std::path::Path;

/// Writes a picture as a still of 8 bits per channel, into the output's file for a frame.
pub fn write_picture(
    output: &Output,
    frame: u32,
    picture: &Picture,
    formats: Formats,
) -> Result<(), EncodeError> {
    let bytes = match output {
        Output::Stills(StillFormat::Png, _) => png::encode(picture, &[]),
        Output::Stills(StillFormat::Jpeg, _) => jpeg::encode(picture, formats.jpeg.quality),
        Output::Stills(StillFormat::Ppm, _) => ppm::encode(picture, formats.ppm.ascii),
        Output::Stills(StillFormat::Exr, _) | Output::Movie(..) | Output::Stream(_) => {
            return Err(JobError::NoPicture { output: output.to_string() }.into());
        }
    };
    AtomicFile::with_encoded(&output.path(frame), bytes, &Stop::default())?.commit()
}

/// Writes a picture as a PNG file. The file appears complete or not at all.
pub fn write_png(path: &Path, picture: &Picture) -> Result<(), EncodeError> {
    AtomicFile::with_encoded(path, png::encode(picture, &[]), &Stop::default())?.commit()
}

/// Encodes a picture as PNG in memory.
pub fn png_bytes(picture: &Picture) -> io::Result<Vec<u8>> {
    png::encode(picture, &[])
}
