//! The encoding thread's work: one film after the other, then the animations.

use super::about::Shown;
use super::animations::Animations;
use super::atomic::{NewFolders, part_of};
use super::claim::Claim;
use super::commits::Commits;
use super::develop::{ToneTable, develop_deep};
use super::error::EncodeError;
use super::job::Job;
use super::output::{Output, Still, Streamed};
use super::pattern::FramePattern;
use super::picture::Picture;
use super::record::{self, Text};
use super::store::Store;
use super::{Message, Report, exr, holding, jpeg, png, ppm};
use crate::base::cancel::Stop;
use crate::base::digest::Digest;
use crate::base::escape;
use crate::base::machine::thread_time;
use crate::base::units::counted;
use crate::film::Film;
use rayon::ThreadPool;
use std::fs;
use std::io::{self, Write};
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
    /// Films that were written, and those of them that a stopped run has not finished.
    done: usize,
    unfinished: usize,
    /// Ends waiting for who reads a pipe.
    stop: Stop,
    /// Nanoseconds on a processor so far.
    cpu: Arc<AtomicU64>,
    /// The first frame with pixels that are not numbers.
    first_nan: Option<u32>,
    /// Numbers that were too large for the floats of EXR files, and the first frame with any.
    clipped: u64,
    first_clipped: Option<u32>,
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
    pub fn new(job: Arc<Job>, pool: Arc<ThreadPool>, stop: &Stop) -> Result<Self, EncodeError> {
        job.check()?;
        let folders = job.prepare_folders()?;
        let animations = Some(Animations::start(&job, own_store(&job), &pool, stop)?);
        let table = ToneTable::new(job.tonemap);
        let (commits, report, cpu) = Default::default();
        Ok(Self {
            job,
            pool,
            table,
            animations,
            commits,
            report,
            done: 0,
            unfinished: 0,
            stop: stop.clone(),
            cpu,
            first_nan: None,
            clipped: 0,
            first_clipped: None,
            folders,
        })
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
                Ok(Message::Film(place, film, claim)) => self.next_film(place, film, claim.as_ref())?,
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

    /// Writes a film. If that is interrupted, the error says how many films were finished before.
    fn next_film(&mut self, index: usize, film: Film, claim: Option<&Arc<Claim>>) -> Result<(), EncodeError> {
        self.film(index, film, claim).map_err(|error| match error {
            EncodeError::Interrupted { signal, .. } => EncodeError::Interrupted { signal, done: self.done },
            error => error,
        })?;
        self.done += 1;
        Ok(())
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
            if film.unfinished && output.is_stream() {
                continue;
            }
            let path = if film.unfinished { part_of(&output.path(frame)) } else { output.path(frame) };
            if let Output::Stills(Still::Exr, _) = output {
                self.exr(&path, &developed, claim)?;
            } else if let Some(bytes) = still(&job, output, &developed) {
                self.put(&path, output, bytes, claim)?;
            }
        }
        self.unfinished += usize::from(film.unfinished);
        match &mut self.animations {
            // Those that are made of PNGs have only whole ones.
            Some(animations) if !(film.unfinished && job.source().is_some()) => {
                animations.push(&picture, matte)
            }
            _ => Ok(()),
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
            let bytes = match output {
                // As it is there.
                Output::Stream(Streamed::Png) => Some(fs::read(pattern.path(frame))),
                _ => without_alpha(&job, output, &matte),
            };
            if let Some(bytes) = bytes {
                self.put(&output.path(frame), output, bytes, None)?;
            }
        }
        match &mut self.animations {
            Some(animations) => animations.push(&picture, &matte),
            None => Ok(()),
        }
    }

    /// Puts a frame's bytes where the output says: aside, or on the standard output.
    fn put(
        &mut self,
        path: &Path,
        output: &Output,
        bytes: io::Result<Vec<u8>>,
        claim: Option<&Arc<Claim>>,
    ) -> Result<(), EncodeError> {
        if !output.is_stream() {
            return self.commits.push(holding(path, bytes, &self.stop)?, claim.cloned());
        }
        let mut stdout = io::stdout().lock();
        let put = bytes.and_then(|bytes| stdout.write_all(&bytes)).and_then(|()| stdout.flush());
        put.map_err(|error| EncodeError::write("the standard output", error))
    }

    /// Writes a frame's EXR file aside, and counts what its floats cannot hold.
    fn exr(&mut self, path: &Path, frame: &Developed, claim: Option<&Arc<Claim>>) -> Result<(), EncodeError> {
        let job = Arc::clone(&self.job);
        let words =
            exr::Words { identity: identity(&job, Still::Exr, frame), texts: texts(&job, Still::Exr, frame) };
        let (file, clipped) = exr::write(path, frame.film, job.formats.exr, &job.about.layers, &words)?;
        self.clipped += clipped;
        if clipped > 0 {
            self.first_clipped.get_or_insert(frame.shown.frame);
        }
        self.commits.push(file, claim.cloned())
    }

    fn finish(&mut self) -> Result<(), EncodeError> {
        self.commits.wait()?;
        if let Some(animations) = self.animations.take() {
            self.report.notes.extend(animations.finish(&self.job, &self.pool)?);
        }
        self.note();
        self.report.files = self.job.outputs.iter().map(|output| output.name().to_owned()).collect();
        self.report.notes.extend(self.job.outputs.iter().filter_map(left_parts));
        self.folders.keep();
        Ok(())
    }

    /// Closes what there is.
    fn stop(&mut self) -> Result<(), EncodeError> {
        self.commits.wait()?;
        let Some(animations) = self.animations.take() else { return Ok(()) };
        if animations.is_empty() && self.unfinished == 0 {
            // Nothing was written, and the folders go as they came.
            return Ok(());
        }
        let stills = self.job.outputs.iter().filter(|output| !output.is_animation());
        let names: Vec<&Path> = stills.map(Output::name).collect();
        if self.done > self.unfinished {
            self.report.files.extend(names.iter().map(|name| name.to_path_buf()));
        }
        if self.unfinished > 0 {
            let files = self.job.outputs.iter().filter(|output| matches!(output, Output::Stills(..)));
            self.report.files.extend(files.map(|output| part_of(output.name())));
        }
        if !animations.is_empty() {
            self.report.files.extend(animations.stop(&self.pool)?);
        }
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
        if let Some(first) = self.first_clipped {
            let numbers = counted(self.clipped, "number");
            self.report.notes.push(format!(
                "{numbers} above 65504, the most that EXR files of `precision: Half` hold, are written as that, the first \
                 in frame {first}; `precision: Float` keeps them"
            ));
        }
    }
}

/// Tells of unfinished frames that an earlier run has left. They may be wanted, and stay.
fn left_parts(output: &Output) -> Option<String> {
    let parts = FramePattern::parse(part_of(output.pattern()?.name())).ok()?;
    let there = if parts.has_place() { !parts.numbers().ok()?.is_empty() } else { parts.name().is_file() };
    there.then(|| {
        format!("{} holds unfinished frames of an earlier run, and may go", escape::path(parts.name()))
    })
}

/// What a frame is known again by; nothing if it is not what it should become.
fn identity(job: &Job, format: Still, frame: &Developed) -> Option<Digest> {
    job.identity(format, frame.index).filter(|_| !frame.film.unfinished)
}

/// What a frame's own file tells in words.
fn texts(job: &Job, format: Still, frame: &Developed) -> Vec<Text> {
    if !job.tells(format) {
        return Vec::new();
    }
    let mut texts = record::facts(&frame.shown, job.seen.get(frame.index));
    texts.extend(frame.film.noise.as_ref().map(record::error));
    texts
}

/// The bytes of a frame's own file; none of EXR, which is not made as a whole, and of what holds several frames.
fn still(job: &Job, output: &Output, frame: &Developed) -> Option<io::Result<Vec<u8>>> {
    match output {
        Output::Stills(Still::Png, _) | Output::Stream(Streamed::Png) => Some(png_bytes(job, frame)),
        _ => without_alpha(job, output, frame.matte),
    }
}

fn png_bytes(job: &Job, frame: &Developed) -> io::Result<Vec<u8>> {
    let (texts, identity) = (texts(job, Still::Png, frame), identity(job, Still::Png, frame));
    if !job.formats.png.deep {
        return png::sealed(frame.picture, texts, identity);
    }
    let mut deep = develop_deep(job.tonemap, frame.film);
    if let Some(caption) = &job.caption {
        caption.draw(&mut deep, &frame.shown);
    }
    png::sealed(&deep, texts, identity)
}

/// The bytes of a picture in a format without alpha that holds one.
fn without_alpha(job: &Job, output: &Output, matte: &Picture) -> Option<io::Result<Vec<u8>>> {
    let ascii = job.formats.ppm.ascii;
    match output {
        Output::Stills(Still::Jpeg, _) => Some(jpeg::encode(matte, job.formats.jpeg.quality)),
        Output::Stills(Still::Ppm, _) | Output::Stream(Streamed::Ppm) => Some(ppm::encode(matte, ascii)),
        Output::Stream(Streamed::AsciiPpm) => Some(ppm::encode(matte, true)),
        Output::Stills(Still::Png | Still::Exr, _)
        | Output::Stream(Streamed::Png | Streamed::Y4m)
        | Output::Movie(..) => None,
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
