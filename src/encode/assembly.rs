//! Animations of pictures that are there already.

use super::Report;
use super::animations::Animations;
use super::atomic::NewFolders;
use super::error::{EncodeError, FilmsError};
use super::job::Job;
use super::picture::Picture;
use crate::files;
use image::{DynamicImage, ImageReader};
use rayon::ThreadPool;
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};
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
        let animations = Animations::start(&job, None, &pool)?;
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
        let files = self.job.outputs.iter().map(|output| PathBuf::from(output.to_string())).collect();
        Ok(Report { files, notes, ..Report::default() })
    }
}

/// A picture from a file of any format that is read; 16 bits become 8.
pub fn read_picture(path: &Path) -> Result<Picture, EncodeError> {
    let fault = |error: io::Error| EncodeError::Unreadable { path: path.to_path_buf(), reason: error };
    // Pictures are as large as they are; the reader has a limit of its own.
    let (file, _) = files::open(path, u64::MAX).map_err(fault)?;
    let reader = ImageReader::new(BufReader::new(file)).with_guessed_format().map_err(fault)?;
    let image = reader.decode().map_err(|error| fault(io::Error::other(error)))?;
    let (width, height) = (image.width(), image.height());
    if !image.color().has_alpha() {
        return Ok(Picture::opaque(width, height, image.into_rgb8().into_raw()));
    }
    let pixels = DynamicImage::into_rgba8(image).into_raw();
    let pixels = pixels.as_chunks::<4>().0;
    let rgb = pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
    Ok(Picture { width, height, rgb, alpha: Some(pixels.iter().map(|pixel| pixel[3]).collect()) })
}
