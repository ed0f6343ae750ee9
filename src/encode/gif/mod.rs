//! In: pictures, first one by one, then again by their index. Out: an animated GIF file.
//!
//! The first pass runs during rendering: every frame that the GIF shows is counted into a histogram of fixed size, and
//! the caller stores it without loss. The second pass reads the stored frames, a few at a time, maps them to one
//! palette and writes the changes. So memory does not grow with the number of frames.

mod annotated;
mod delta;
mod dither;
mod file;
mod fit;
mod histogram;
mod mapper;
mod oklab;
mod palette;
#[cfg(test)]
mod tests;
mod threshold;
mod timing;

use super::atomic::part_of;
use super::error::{EncodeError, JobError};
use super::job::EncodeJob;
use super::limits::GIF_LIMIT;
use super::picture::Picture;
use super::settings::GifSettings;
use crate::base::escape;
use crate::drawing::Drawing;
use annotated::{CoveredPixels, reserved_colors};
use dither::Mixer;
use file::{FinishedGif, GifFile};
use fit::GifQuality;
use histogram::Histogram;
use mapper::Mapper;
use palette::Palette;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use timing::TimedFrame;

/// Reads a stored frame by its index in the job's list.
type LoadFrame<'a> = dyn Fn(usize) -> Result<Picture, EncodeError> + Sync + 'a;

/// From this palette size on, one index for transparency saves more than a colour is worth.
const TRANSPARENT_FROM: usize = 16;
/// Maximum number of frames in memory in the second pass. The number is one per thread if that is less.
const MAX_BATCH: usize = 8;
/// Bytes of pictures in memory in the second pass, unless a single picture is larger.
const MEMORY: usize = 1 << 28;

/// The state of the first pass.
pub struct Animation {
    path: PathBuf,
    size: (u16, u16),
    settings: GifSettings,
    frames: Vec<TimedFrame>,
    /// Number of the job's frames that are not shown.
    dropped: usize,
    /// Whether pixels may be transparent.
    clear: bool,
    histogram: Histogram,
    /// What is drawn over each of the job's frames; empty if there are no annotations.
    drawings: Vec<Arc<Drawing>>,
}

impl Animation {
    /// The animation of a job's frames as the GIF file `path`.
    pub fn new(path: &Path, job: &EncodeJob) -> Result<Self, JobError> {
        let (Ok(width), Ok(height)) = (u16::try_from(job.size.0), u16::try_from(job.size.1)) else {
            return Err(JobError::TooLarge { path: path.to_path_buf(), size: job.size, limit: GIF_LIMIT });
        };
        let Some(frames) = timing::timed_frames(job.frames.len(), job.rate) else {
            return Err(JobError::TooLong { path: path.to_path_buf() });
        };
        Ok(Self {
            path: path.to_path_buf(),
            size: (width, height),
            settings: job.formats.gif,
            dropped: job.frames.len() - frames.len(),
            frames,
            clear: job.transparent,
            histogram: Histogram::new(usize::from(job.formats.gif.colors)),
            drawings: job.drawings.clone(),
        })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The animation of the job's first `count` frames, under the name of a partial file.
    pub fn truncated(mut self, count: usize) -> Self {
        self.frames.retain(|frame| frame.index < count);
        self.path = part_of(&self.path);
        self
    }

    /// A note if frames are dropped to stay at [`timing::MAX_RATE`].
    pub fn dropped_note(&self, job: &EncodeJob) -> Option<String> {
        let total = job.frames.len();
        (self.dropped > 0).then(|| {
            format!(
                "{} plays at 50 frames per second and shows {} of {total} frames, because viewers slow down faster \
                 GIFs (the sequence has {})",
                escape::path(&self.path),
                total - self.dropped,
                job.rate,
            )
        })
    }

    /// Whether the frame of this index in the job's list is shown.
    pub fn shows(&self, index: usize) -> bool {
        self.frames.binary_search_by_key(&index, |frame| frame.index).is_ok()
    }

    /// Counts the colours of a shown frame.
    pub fn count(&mut self, picture: &Picture) {
        self.histogram.add(picture);
    }

    /// The second pass: reads every shown frame with `load`, by its index in the job's list, and writes the file.
    /// Frames are mapped and compressed on rayon's pool. The bytes do not depend on the number of threads.
    ///
    /// Returns a note if quality was reduced to stay within the maximum size.
    pub fn write(
        self,
        load: impl Fn(usize) -> Result<Picture, EncodeError> + Sync,
    ) -> Result<Option<String>, EncodeError> {
        fit::write(&self.path, self.size, &self.settings, |quality| self.encode(quality, &load))
    }

    /// Encodes the file in a quality, without committing it.
    fn encode(&self, quality: &GifQuality, load: &LoadFrame) -> Result<FinishedGif, EncodeError> {
        let size = quality.size(self.size);
        let load = |index| load(index).map(|picture| quality.scaled(picture));
        let shown = quality.thinned(&self.frames);
        let (palette, transparent) = match quality.scale < 1.0 {
            true => {
                let mut histogram = Histogram::new(usize::from(quality.colors));
                for frame in &shown {
                    histogram.add(&load(frame.index)?);
                }
                palette(&histogram, quality.colors, (shown.len(), self.clear), &[])
            }
            false => {
                let drawings = shown.iter().filter_map(|frame| self.drawings.get(frame.index));
                let kept = reserved_colors(drawings, usize::from(quality.colors));
                palette(&self.histogram, quality.colors, (shown.len(), self.clear), &kept)
            }
        };
        let mixer = Mixer::new(palette, self.settings.dither);
        let clear = transparent.filter(|_| self.clear);
        let batch_size = self.batch_size();
        let mut mappers: Vec<_> = (0..batch_size).map(|_| Mapper::new(&mixer)).collect();
        let mut table = mixer.palette().colors().as_flattened().to_vec();
        table.extend(transparent.map(|_| [0; 3]).iter().flatten());
        let mut file = GifFile::create(&self.path, size, &table, self.settings.loop_count)?;
        let mut last: Option<Vec<u8>> = None;
        for batch in shown.chunks(batch_size) {
            let map = |(mapper, frame): (&mut Mapper, &TimedFrame)| {
                let flat = self.flat_pixels(quality, frame.index);
                Ok(mapper.map(&load(frame.index)?, clear, flat.as_deref()))
            };
            let indices: Vec<Vec<u8>> =
                mappers.par_iter_mut().zip(batch).map(map).collect::<Result<_, EncodeError>>()?;
            let frame = |i: usize| {
                let old = if i == 0 { last.as_deref() } else { Some(indices[i - 1].as_slice()) };
                match clear {
                    Some(clear) => delta::replacement(old, &indices[i], size, clear),
                    None => delta::delta(old, &indices[i], size, transparent),
                }
            };
            let frames: Vec<_> = (0..indices.len()).into_par_iter().map(frame).collect();
            for ((frame, timed), indices) in frames.into_iter().zip(batch).zip(&indices) {
                file.push(frame, timed.delay, indices.first().copied().unwrap_or(0))?;
            }
            last = indices.into_iter().next_back();
        }
        file.finish()
    }

    /// The pixels of a frame that annotations cover. Smaller pictures mix them with what is around.
    fn flat_pixels(&self, quality: &GifQuality, index: usize) -> Option<Vec<bool>> {
        let drawing = self.drawings.get(index).filter(|_| quality.scale >= 1.0)?;
        CoveredPixels::of(drawing, (self.size.0.into(), self.size.1.into()))
    }

    /// The number of frames that are encoded at the same time.
    fn batch_size(&self) -> usize {
        // A picture, its indices, and two compressed versions of them.
        let bytes = usize::from(self.size.0) * usize::from(self.size.1) * 6;
        (MEMORY / bytes.max(1)).clamp(1, rayon::current_num_threads().clamp(1, MAX_BATCH))
    }
}

/// A palette of at most `colors` colours, and the index after them that is transparent. An animation needs it if pixels
/// may be transparent. Otherwise it marks unchanged pixels, if that saves more than a colour is worth. The palette
/// contains the colours of `kept`.
fn palette(
    histogram: &Histogram,
    colors: u16,
    (frames, clear): (usize, bool),
    kept: &[[u8; 3]],
) -> (Palette, Option<u8>) {
    let size = usize::from(colors).clamp(2, 256);
    let reserved = match histogram.distinct() {
        Some(distinct) if distinct <= size => distinct < size,
        _ => size >= TRANSPARENT_FROM,
    };
    let reserved = clear || reserved && frames > 1;
    let free = size - usize::from(reserved);
    let palette = match histogram.distinct() {
        // All colours are in it anyway.
        Some(distinct) if distinct <= free => histogram.palette(free),
        _ if kept.is_empty() => histogram.palette(free),
        _ => histogram.palette(free - kept.len()).with(kept),
    };
    let transparent = reserved.then_some(palette.colors().len() as u8);
    (palette, transparent)
}
