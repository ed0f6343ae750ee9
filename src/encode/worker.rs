//! The encoding thread's work: one film after the other, then the animations.

use super::about::Shown;
use super::animations::Animations;
use super::atomic::{Aside, NewFolders};
use super::claim::Claim;
use super::commits::Commits;
use super::develop::{ToneTable, develop_deep};
use super::error::EncodeError;
use super::job::Job;
use super::output::{Output, Still};
use super::picture::Picture;
use super::record;
use super::store::Store;
use super::{Message, Report, exr, jpeg, png, ppm};
use crate::film::Film;
use crate::machine::thread_time;
use rayon::ThreadPool;
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::mpsc::Receiver;
use std::time::Instant;

pub struct Worker {
    job: Arc<Job>,
    pool: Arc<ThreadPool>,
    table: ToneTable,
    /// None once they are finished.
    animations: Option<Animations>,
    commits: Commits,
    report: Report,
    /// Nanoseconds on a processor so far.
    cpu: Arc<AtomicU64>,
    /// The first frame with pixels that are not numbers.
    first_nan: Option<u32>,
    /// Last, so that what lies in the folders has vanished when they are looked at.
    folders: NewFolders,
}

/// A frame as it is written.
struct Developed<'a> {
    /// Its place in the job's list.
    index: usize,
    shown: Shown<'a>,
    film: &'a Film,
    picture: &'a Picture,
    /// The picture without alpha.
    matte: &'a Picture,
}

impl Worker {
    /// Checks the job and prepares all places. Nothing stays behind if this fails.
    pub fn new(job: Arc<Job>, pool: Arc<ThreadPool>) -> Result<Self, EncodeError> {
        job.check()?;
        let folders = job.prepare_folders()?;
        let animations = Some(Animations::start(&job, own_store(&job), &pool)?);
        let table = ToneTable::new(job.tonemap);
        let (commits, report, cpu) = Default::default();
        Ok(Self { job, pool, table, animations, commits, report, cpu, first_nan: None, folders })
    }

    /// Where the time is told that it has worked.
    pub fn cpu(&self) -> Arc<AtomicU64> {
        Arc::clone(&self.cpu)
    }

    /// Adds notes to what the user should know.
    pub fn tell(&mut self, notes: Vec<String>) {
        self.report.notes.extend(notes);
    }

    /// Works until all is written. If the other side leaves without a word, nothing more is.
    pub fn run(mut self, messages: Receiver<Message>) -> Result<Report, EncodeError> {
        loop {
            let message = messages.recv();
            let start = Instant::now();
            match message {
                Ok(Message::Film(place, film, claim)) => self.film(place, film, claim.as_ref())?,
                Ok(Message::Kept(place)) => self.kept(place)?,
                Ok(Message::Finish) => {
                    self.finish()?;
                    self.report.busy += start.elapsed();
                    return Ok(self.report);
                }
                Ok(Message::Stop) => {
                    self.stop()?;
                    return Ok(self.report);
                }
                Err(_) => return Err(EncodeError::Stopped(None)),
            }
            self.report.busy += start.elapsed();
            let others = self.animations.as_ref().map_or(0.0, Animations::cpu);
            self.cpu.store(((thread_time().unwrap_or(0.0) + others) * 1e9) as u64, Relaxed);
        }
    }

    fn film(&mut self, index: usize, film: Film, claim: Option<&Arc<Claim>>) -> Result<(), EncodeError> {
        let job = Arc::clone(&self.job);
        let frame = job.frames[index];
        let shown = Shown { about: &job.about, frame, rate: job.rate };
        self.report.noise.extend(film.noise.map(|noise| (frame, noise)));
        let (mut picture, nan_pixels) = self.table.develop(&film);
        self.report.nan_pixels += nan_pixels;
        if nan_pixels > 0 {
            self.first_nan.get_or_insert(frame);
        }
        if let Some(caption) = &job.caption {
            caption.draw(&mut picture, &shown);
        }
        let over = picture.alpha.is_some().then(|| picture.over(job.matte));
        let matte = over.as_ref().unwrap_or(&picture);
        let developed = Developed { index, shown, film: &film, picture: &picture, matte };
        for output in &job.outputs {
            if let Output::Stills(format, pattern) = output {
                let file = still(&job, *format, &pattern.path(frame), &developed)?;
                self.commits.push(file, claim.cloned())?;
            }
        }
        match &mut self.animations {
            Some(animations) => animations.push(&picture, matte),
            None => Ok(()),
        }
    }

    /// Makes of a frame that is there what is not.
    fn kept(&mut self, index: usize) -> Result<(), EncodeError> {
        let job = Arc::clone(&self.job);
        let frame = job.frames[index];
        self.report.kept += 1;
        if job.about.noise.is_some() {
            self.report.noise.extend(
                job.told(frame).find_map(|told| record::told_error(&told)).map(|noise| (frame, noise)),
            );
        }
        let silent = |output: &&Output| !job.is_said(output);
        let (Some(pattern), Some(_)) = (job.source(), job.outputs.iter().find(silent)) else { return Ok(()) };
        let path = pattern.path(frame);
        let picture = png::read(&path)?;
        if (picture.width, picture.height) != job.size {
            let reason = io::Error::new(io::ErrorKind::InvalidData, "it has another size by now");
            return Err(EncodeError::read(path, reason));
        }
        let matte = picture.over(job.matte);
        for output in job.outputs.iter().filter(silent) {
            match output {
                Output::Stills(Still::Jpeg, pattern) => {
                    let path = pattern.path(frame);
                    self.commits.push(jpeg::write(&path, &matte, job.formats.jpeg.quality)?, None)?;
                }
                Output::Stills(Still::Ppm, pattern) => {
                    self.commits.push(ppm::write(&pattern.path(frame), &matte)?, None)?;
                }
                _ => {}
            }
        }
        match &mut self.animations {
            Some(animations) => animations.push(&picture, &matte),
            None => Ok(()),
        }
    }

    fn finish(&mut self) -> Result<(), EncodeError> {
        self.commits.wait()?;
        if let Some(animations) = self.animations.take() {
            self.report.notes.extend(animations.finish(&self.job, &self.pool)?);
        }
        self.note();
        self.report.files = self.job.outputs.iter().map(|output| output.name().to_owned()).collect();
        self.folders.keep();
        Ok(())
    }

    /// Closes what there is.
    fn stop(&mut self) -> Result<(), EncodeError> {
        self.commits.wait()?;
        let Some(animations) = self.animations.take() else { return Ok(()) };
        if animations.is_empty() {
            // Nothing was written, and the folders go as they came.
            return Ok(());
        }
        let stills = self.job.outputs.iter().filter(|output| !output.is_animation());
        self.report.files = stills.map(|output| output.name().to_owned()).collect();
        self.report.files.extend(animations.stop(&self.pool)?);
        self.folders.keep();
        Ok(())
    }

    fn note(&mut self) {
        if let Some(first) = self.first_nan {
            let pixels = self.report.nan_pixels;
            let kept = self.job.outputs.iter().any(|output| matches!(output, Output::Stills(Still::Exr, _)));
            let kept = if kept { "; EXR files keep them" } else { "" };
            self.report.notes.push(format!(
                "{pixels} pixels were not numbers and are shown as 0, the first in frame {first}{kept}"
            ));
        }
    }
}

/// Writes one frame's own file aside.
fn still(job: &Job, format: Still, path: &Path, frame: &Developed) -> Result<Aside, EncodeError> {
    let Developed { index, shown, film, picture, matte } = frame;
    let identity = job.identity(format, *index);
    let mut texts = Vec::new();
    if job.tells(format) {
        texts = record::facts(shown, job.seen.get(*index));
        texts.extend(film.noise.as_ref().map(record::error));
    }
    match format {
        Still::Png => {
            if !job.formats.png.deep {
                return png::write_frame(path, picture, texts, identity);
            }
            let mut deep = develop_deep(job.tonemap, film);
            if let Some(caption) = &job.caption {
                caption.draw(&mut deep, shown);
            }
            png::write_frame(path, &deep, texts, identity)
        }
        Still::Jpeg => jpeg::write(path, matte, job.formats.jpeg.quality),
        Still::Ppm => ppm::write(path, matte),
        Still::Exr => {
            let words = exr::Words { identity, texts };
            exr::write(path, film, job.formats.exr, &job.about.layers, &words)
        }
    }
}

/// The run's own files, if they hold what GIFs show: pictures of 8 bits without alpha or loss.
fn own_store(job: &Job) -> Option<Store> {
    let plain = !job.formats.png.deep && !job.transparent;
    job.outputs.iter().filter(|_| plain).find_map(|output| match output {
        Output::Stills(Still::Png, pattern) => {
            Some(Store::Own { pattern: pattern.clone(), frames: job.frames.clone() })
        }
        _ => None,
    })
}
