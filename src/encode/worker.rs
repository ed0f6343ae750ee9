//! The encoding thread's work: one film after the other, then the animations.

use super::atomic::NewFolders;
use super::develop::ToneTable;
use super::error::EncodeError;
use super::exr;
use super::gif::Animation;
use super::job::Job;
use super::output::Output;
use super::png;
use super::ppm;
use super::store::Store;
use super::{Message, Report};
use crate::film::Film;
use rayon::ThreadPool;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::time::Instant;

pub struct Worker {
    job: Arc<Job>,
    pool: Arc<ThreadPool>,
    table: ToneTable,
    animations: Vec<Animation>,
    /// There if there are animations.
    store: Option<Store>,
    /// Films so far.
    done: usize,
    report: Report,
    /// The first frame with pixels that are not numbers.
    first_nan: Option<u32>,
    /// Last, so that what lies in the folders has vanished when they are looked at.
    folders: NewFolders,
}

impl Worker {
    /// Checks the job and prepares all places. Nothing stays behind if this fails.
    pub fn new(job: Arc<Job>, pool: Arc<ThreadPool>) -> Result<Self, EncodeError> {
        job.check()?;
        let gifs = job.outputs.iter().filter_map(|output| match output {
            Output::Gif(path) => Some(path),
            Output::Png(_) | Output::Ppm(_) | Output::Exr(_) => None,
        });
        let animations = gifs.clone().map(|path| Animation::new(path, &job)).collect::<Result<_, _>>()?;
        let folders = job.prepare_folders()?;
        let own = job.outputs.iter().find_map(|output| match output {
            Output::Png(pattern) => Some(Store::Own { pattern: pattern.clone(), frames: job.frames.clone() }),
            // Radiance is no picture yet; and one kind of file that is read back is enough.
            Output::Ppm(_) | Output::Exr(_) | Output::Gif(_) => None,
        });
        let store = match (own, gifs.clone().next()) {
            (_, None) => None,
            (Some(own), _) => Some(own),
            (None, Some(path)) => Some(Store::spool_for(path)?),
        };
        let table = ToneTable::new(job.tonemap);
        let report = Report::default();
        Ok(Self { job, pool, table, animations, store, done: 0, report, first_nan: None, folders })
    }

    /// Works until all is written. If the other side leaves without a word, nothing more is.
    pub fn run(mut self, messages: Receiver<Message>) -> Result<Report, EncodeError> {
        loop {
            let message = messages.recv();
            let start = Instant::now();
            match message {
                Ok(Message::Film(frame, film)) => self.film(frame, film)?,
                Ok(Message::Finish) => {
                    self.finish()?;
                    self.report.busy += start.elapsed();
                    return Ok(self.report);
                }
                Err(_) => return Err(EncodeError::Stopped(None)),
            }
            self.report.busy += start.elapsed();
        }
    }

    fn film(&mut self, frame: u32, film: Film) -> Result<(), EncodeError> {
        let (picture, nan_pixels) = self.table.develop(&film);
        self.report.nan_pixels += nan_pixels;
        if nan_pixels > 0 {
            self.first_nan.get_or_insert(frame);
        }
        for output in &self.job.outputs {
            match output {
                Output::Png(pattern) => png::write(&pattern.path(frame), &picture)?,
                Output::Ppm(pattern) => ppm::write(&pattern.path(frame), &picture)?,
                Output::Exr(pattern) => exr::write(&pattern.path(frame), &film)?,
                Output::Gif(_) => {}
            }
        }
        drop(film);
        let index = self.done;
        self.done += 1;
        let mut shows = false;
        for animation in self.animations.iter_mut().filter(|animation| animation.shows(index)) {
            animation.count(&picture);
            shows = true;
        }
        match &self.store {
            Some(store) if shows => store.put(index, &picture),
            _ => Ok(()),
        }
    }

    fn finish(&mut self) -> Result<(), EncodeError> {
        self.note();
        if let Some(store) = self.store.take() {
            for animation in self.animations.drain(..) {
                self.pool.install(|| animation.write(|index| store.get(index)))?;
            }
        }
        self.report.files = self.job.outputs.iter().map(|o| PathBuf::from(o.to_string())).collect();
        self.folders.keep();
        Ok(())
    }

    fn note(&mut self) {
        let total = self.job.frames.len();
        for animation in self.animations.iter().filter(|animation| animation.dropped() > 0) {
            self.report.notes.push(format!(
                "{} plays at 50 frames per second and shows {} of {total} frames: viewers slow GIFs down that \
                 are faster (here {})",
                animation.path().display(),
                total - animation.dropped(),
                self.job.rate,
            ));
        }
        if let Some(first) = self.first_nan {
            let pixels = self.report.nan_pixels;
            let kept = self.job.outputs.iter().any(|output| matches!(output, Output::Exr(_)));
            let kept = if kept { "; EXR files keep them" } else { "" };
            self.report.notes.push(format!(
                "{pixels} pixels were not numbers and are shown as 0, the first in frame {first}{kept}"
            ));
        }
    }
}
