//! Stored frames → an animated GIF, in two passes.
//!
//! The first pass goes along with the run: every frame that will show is counted into a histogram of fixed
//! size and stored losslessly by the caller. The second reads the stored frames, a few at a time, maps them
//! to the one palette and writes what changes. So memory does not grow with the number of frames.

mod delta;
mod dither;
mod file;
mod fit;
mod histogram;
mod mapper;
mod palette;
#[cfg(test)]
mod tests;
mod threshold;
mod timing;

use super::atomic::part_of;
use super::error::{EncodeError, JobError};
use super::job::Job;
use super::picture::Picture;
use super::settings::GifSettings;
use crate::base::escape;
use dither::Mixer;
use file::{Finished, GifFile};
use fit::{Load, Plan};
use histogram::Histogram;
use mapper::Mapper;
use palette::Palette;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use timing::Shot;

/// From this palette size on, one colour is better spent on transparency.
const TRANSPARENT_FROM: usize = 16;
/// Frames of the second pass that are in memory at a time, at most; one per thread otherwise.
const MOST_AT_A_TIME: usize = 8;
/// Bytes of pictures in memory at a time in the second pass, if that allows more than one.
const MEMORY: usize = 1 << 28;

/// The first pass: what is known about the animation so far.
pub struct Animation {
    path: PathBuf,
    size: (u16, u16),
    settings: GifSettings,
    shots: Vec<Shot>,
    /// Frames of the job that do not show.
    dropped: usize,
    /// Whether pixels may be clear.
    clear: bool,
    histogram: Histogram,
}

const LIMIT: &str = "a GIF ends at 65535x65535";

/// What keeps pictures of this size from being GIFs.
pub fn limit((width, height): (u32, u32)) -> Option<&'static str> {
    (width.max(height) > u16::MAX.into()).then_some(LIMIT)
}

impl Animation {
    /// The animation of a job's frames as the GIF file `path`.
    pub fn new(path: &Path, job: &Job) -> Result<Self, JobError> {
        let (Ok(width), Ok(height)) = (u16::try_from(job.size.0), u16::try_from(job.size.1)) else {
            return Err(JobError::TooLarge { path: path.to_path_buf(), size: job.size, limit: LIMIT });
        };
        let Some(shots) = timing::shots(job.frames.len(), job.rate) else {
            return Err(JobError::TooLong { path: path.to_path_buf() });
        };
        Ok(Self {
            path: path.to_path_buf(),
            size: (width, height),
            settings: job.formats.gif,
            dropped: job.frames.len() - shots.len(),
            shots,
            clear: job.transparent,
            histogram: Histogram::new(usize::from(job.formats.gif.colors)),
        })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The animation of the job's first frames alone, beside the whole one's place.
    pub fn cut(mut self, frames: usize) -> Self {
        self.shots.retain(|shot| shot.index < frames);
        self.path = part_of(&self.path);
        self
    }

    /// What to tell if frames are left out to stay at [`timing::FASTEST`].
    pub fn dropped_note(&self, job: &Job) -> Option<String> {
        let total = job.frames.len();
        (self.dropped > 0).then(|| {
            format!(
                "{} plays at 50 frames per second and shows {} of {total} frames: viewers slow GIFs down that are \
                 faster (here {})",
                escape::path(&self.path),
                total - self.dropped,
                job.rate,
            )
        })
    }

    /// Whether the frame of this index in the job's list shows.
    pub fn shows(&self, index: usize) -> bool {
        self.shots.binary_search_by_key(&index, |shot| shot.index).is_ok()
    }

    /// Counts a frame that shows.
    pub fn count(&mut self, picture: &Picture) {
        self.histogram.add(picture);
    }

    /// The second pass: reads every shown frame through `load`, by its index in the job's list, and writes the
    /// file. Frames are mapped and compressed on rayon's pool; the bytes do not depend on how many threads.
    ///
    /// Returns what to tell if the file has lost something to stay as small as it should.
    pub fn write(
        self,
        load: impl Fn(usize) -> Result<Picture, EncodeError> + Sync,
    ) -> Result<Option<String>, EncodeError> {
        fit::write(&self, &load)
    }

    /// Writes the file as a plan has it, without putting it in its place yet.
    fn attempt(&self, plan: &Plan, load: &Load) -> Result<Finished, EncodeError> {
        let size = plan.size(self.size);
        let load = |index| load(index).map(|picture| plan.scaled(picture));
        let shots = plan.thinned(&self.shots);
        let (palette, transparent) = match plan.scale < 1.0 {
            true => {
                let mut histogram = Histogram::new(usize::from(plan.colors));
                for shot in &shots {
                    histogram.add(&load(shot.index)?);
                }
                palette(&histogram, plan.colors, shots.len(), self.clear)
            }
            false => palette(&self.histogram, plan.colors, shots.len(), self.clear),
        };
        let mixer = Mixer::new(palette, self.settings.dither);
        let clear = transparent.filter(|_| self.clear);
        let at_a_time = self.at_a_time();
        let mut mappers: Vec<_> = (0..at_a_time).map(|_| Mapper::new(&mixer)).collect();
        let mut table = mixer.palette().colors().as_flattened().to_vec();
        table.extend(transparent.map(|_| [0; 3]).iter().flatten());
        let mut file = GifFile::create(&self.path, size, &table, self.settings.plays)?;
        let mut last: Option<Vec<u8>> = None;
        for shots in shots.chunks(at_a_time) {
            let map = |(mapper, shot): (&mut Mapper, &Shot)| Ok(mapper.map(&load(shot.index)?, clear));
            let indices: Vec<Vec<u8>> =
                mappers.par_iter_mut().zip(shots).map(map).collect::<Result<_, EncodeError>>()?;
            let frame = |i: usize| {
                let old = if i == 0 { last.as_deref() } else { Some(indices[i - 1].as_slice()) };
                match clear {
                    Some(clear) => delta::alone(old, &indices[i], size, clear),
                    None => delta::delta(old, &indices[i], size, transparent),
                }
            };
            let frames: Vec<_> = (0..indices.len()).into_par_iter().map(frame).collect();
            for ((frame, shot), indices) in frames.into_iter().zip(shots).zip(&indices) {
                file.push(frame, shot.delay, indices.first().copied().unwrap_or(0))?;
            }
            last = indices.into_iter().next_back();
        }
        file.finish()
    }

    fn at_a_time(&self) -> usize {
        // A picture, its indices, and two codings of them.
        let bytes = usize::from(self.size.0) * usize::from(self.size.1) * 6;
        (MEMORY / bytes.max(1)).clamp(1, rayon::current_num_threads().clamp(1, MOST_AT_A_TIME))
    }
}

/// A palette of at most so many colours, and the index after it that is transparent: needed where pixels may be clear, and
/// else for what is as before, if that is worth its place.
fn palette(histogram: &Histogram, colors: u16, shots: usize, clear: bool) -> (Palette, Option<u8>) {
    let size = usize::from(colors).clamp(2, 256);
    let reserved = match histogram.distinct() {
        Some(distinct) if distinct <= size => distinct < size,
        _ => size >= TRANSPARENT_FROM,
    };
    let reserved = clear || reserved && shots > 1;
    let palette = histogram.palette(size - usize::from(reserved));
    let transparent = reserved.then_some(palette.colors().len() as u8);
    (palette, transparent)
}
