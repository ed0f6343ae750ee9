//! Animations from existing pictures.

use super::animations::Animations;
use super::error::{EncodeError, FilmsError};
use super::job::EncodeJob;
use super::new_folders::NewFolders;
use super::picture::Picture;
use super::report::Report;
use crate::base::cancel::Stop;
use crate::base::files;
use image::{DynamicImage, ImageError, ImageReader};
use rayon::ThreadPool;
use std::io::{self, Cursor, ErrorKind};
use std::path::Path;
use std::sync::Arc;

/// Writes animations from pictures. If it is dropped before [`AnimationAssembler::finish`], no file appears.
pub struct AnimationAssembler {
    job: EncodeJob,
    animations: Animations,
    pool: Arc<ThreadPool>,
    done: usize,
    folders: NewFolders,
}

impl AnimationAssembler {
    /// Checks the job and prepares its folders. The threads of `pool` encode the animations.
    pub fn start(job: EncodeJob, pool: Arc<ThreadPool>) -> Result<Self, EncodeError> {
        job.check()?;
        let folders = job.prepare_folders()?;
        let animations = Animations::start(&job, None, &pool, &Stop::default())?;
        Ok(Self { job, animations, pool, done: 0, folders })
    }

    /// Adds the job's next frame.
    pub fn push(&mut self, picture: &Picture) -> Result<(), EncodeError> {
        let frame = self.job.frames.get(self.done).copied().unwrap_or_default();
        let got = (picture.width, picture.height);
        if got != self.job.size {
            return Err(FilmsError::Size { frame, expected: self.job.size, got }.into());
        }
        self.done += 1;
        match (&picture.alpha, self.job.transparent) {
            (None, true) => {
                let solid = Picture { alpha: Some(vec![255; picture.rgb.len() / 3]), ..picture.clone() };
                self.animations.push(&solid, picture)
            }
            (None, false) => self.animations.push(picture, picture),
            (Some(_), _) => self.animations.push(picture, &picture.over(self.job.background_color)),
        }
    }

    /// Finishes the animations and renames their files into place.
    pub fn finish(mut self) -> Result<Report, EncodeError> {
        let notes = self.animations.finish(&self.job, &self.pool)?;
        self.folders.keep();
        let files = self.job.outputs.iter().map(|output| output.name().to_owned()).collect();
        Ok(Report { files, notes, ..Report::default() })
    }
}

/// Reads a picture from a file of any supported format. 16 bits per channel are reduced to 8.
pub fn read_picture(path: &Path) -> Result<Picture, EncodeError> {
    let fault = |error: io::Error| EncodeError::Unreadable { path: path.to_path_buf(), reason: error };
    // The file's size has no limit here, because the decoder has its own.
    let bytes = files::read(path, u64::MAX - 1).map_err(fault)?;
    decode_picture(&bytes).map_err(fault)
}

/// Like [`read_picture`], from the file's bytes.
pub fn decode_picture(bytes: &[u8]) -> io::Result<Picture> {
    if files::is_truncated(bytes) {
        return Err(io::Error::new(ErrorKind::InvalidData, CUT));
    }
    let image = ImageReader::new(Cursor::new(bytes)).with_guessed_format()?.decode().map_err(plain_error)?;
    let (width, height) = (image.width(), image.height());
    if !image.color().has_alpha() {
        return Ok(Picture::opaque(width, height, image.into_rgb8().into_raw()));
    }
    let pixels = DynamicImage::into_rgba8(image).into_raw();
    let pixels = pixels.as_chunks::<4>().0;
    let rgb = pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
    Ok(Picture { width, height, rgb, alpha: Some(pixels.iter().map(|pixel| pixel[3]).collect()) })
}

/// The error of a file that ends too early.
const CUT: &str = "it ends before its picture does";

/// A decoder's error as a plain message.
fn plain_error(error: ImageError) -> io::Error {
    let why = match error {
        ImageError::Unsupported(_) => "it is not a picture of a supported format",
        ImageError::Limits(_) => "it takes too much memory to decode",
        ImageError::IoError(_) => CUT,
        ImageError::Decoding(_) | ImageError::Encoding(_) | ImageError::Parameter(_) => {
            "its data cannot be decoded"
        }
    };
    io::Error::new(ErrorKind::InvalidData, why)
}
