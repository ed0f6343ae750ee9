//! Animations of pictures that are there already.

use super::Report;
use super::animations::Animations;
use super::atomic::NewFolders;
use super::error::{EncodeError, FilmsError};
use super::job::Job;
use super::picture::Picture;
use crate::base::cancel::Stop;
use crate::base::files;
use image::{DynamicImage, ImageError, ImageReader};
use rayon::ThreadPool;
use std::io::{self, Cursor, ErrorKind};
use std::path::Path;
use std::sync::Arc;

/// Animations in the making, fed with finished pictures. Dropped before it is finished, nothing appears.
pub struct Assembly {
    job: Job,
    animations: Animations,
    pool: Arc<ThreadPool>,
    done: usize,
    folders: NewFolders,
}

impl Assembly {
    /// Checks the job and prepares all places. Animations are made on the threads of `pool`.
    pub fn start(job: Job, pool: Arc<ThreadPool>) -> Result<Self, EncodeError> {
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
            (Some(_), _) => self.animations.push(picture, &picture.over(self.job.matte)),
        }
    }

    /// Writes what is left and puts all files in their places.
    pub fn finish(mut self) -> Result<Report, EncodeError> {
        let notes = self.animations.finish(&self.job, &self.pool)?;
        self.folders.keep();
        let files = self.job.outputs.iter().map(|output| output.name().to_owned()).collect();
        Ok(Report { files, notes, ..Report::default() })
    }
}

/// A picture from a file of any format that is read; 16 bits become 8.
pub fn read_picture(path: &Path) -> Result<Picture, EncodeError> {
    let fault = |error: io::Error| EncodeError::Unreadable { path: path.to_path_buf(), reason: error };
    // Pictures are as large as they are; the decoder has a limit of its own.
    let bytes = files::read(path, u64::MAX - 1).map_err(fault)?;
    decode_picture(&bytes).map_err(fault)
}

/// The same of the bytes of a file.
pub fn decode_picture(bytes: &[u8]) -> io::Result<Picture> {
    if files::is_cut(bytes) {
        return Err(io::Error::new(ErrorKind::InvalidData, CUT));
    }
    let image = ImageReader::new(Cursor::new(bytes)).with_guessed_format()?.decode().map_err(in_words)?;
    let (width, height) = (image.width(), image.height());
    if !image.color().has_alpha() {
        return Ok(Picture::opaque(width, height, image.into_rgb8().into_raw()));
    }
    let pixels = DynamicImage::into_rgba8(image).into_raw();
    let pixels = pixels.as_chunks::<4>().0;
    let rgb = pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
    Ok(Picture { width, height, rgb, alpha: Some(pixels.iter().map(|pixel| pixel[3]).collect()) })
}

/// Why a picture is not read that ends too early.
const CUT: &str = "it ends before its picture does";

/// A decoder's error in words of our own.
fn in_words(error: ImageError) -> io::Error {
    let why = match error {
        ImageError::Unsupported(_) => "it is no picture of a format that is read",
        ImageError::Limits(_) => "it takes too much memory to decode",
        ImageError::IoError(_) => CUT,
        ImageError::Decoding(_) | ImageError::Encoding(_) | ImageError::Parameter(_) => {
            "its data cannot be decoded"
        }
    };
    io::Error::new(ErrorKind::InvalidData, why)
}
