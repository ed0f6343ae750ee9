//! The encoding thread: writes one film after the other, then the animations.

use super::animations::Animations;
use super::annotation_layer::AnnotationLayer;
use super::atomic::{AtomicFile, part_of};
use super::commits::Commits;
use super::develop::ToneTable;
use super::error::EncodeError;
use super::frame_bytes::{DevelopedFrame, DrawnPicture, identity, metadata, still, without_alpha};
use super::info::FrameInfo;
use super::job::EncodeJob;
use super::lease::Lease;
use super::message::Message;
use super::metadata::find_noise;
use super::new_folders::NewFolders;
use super::output::{Output, StillFormat, StreamFormat};
use super::pattern::FramePattern;
use super::report::Report;
use super::store::Store;
use super::{exr, png};
use crate::base::cancel::Stop;
use crate::base::escape;
use crate::base::machine::thread_cpu_time;
use crate::base::stats::FRAME_EVENTS;
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
use tracing::{debug_span, info, info_span};

pub struct Worker {
    job: Arc<EncodeJob>,
    pool: Arc<ThreadPool>,
    table: ToneTable,
    /// None after they are finished.
    animations: Option<Animations>,
    commits: Commits,
    report: Report,
    /// Number of films written, and how many of them are unfinished because the run was stopped.
    done: usize,
    unfinished: usize,
    /// For each frame of the job, whether it is drawn again over the picture of its PNG.
    redrawn: Vec<bool>,
    /// Ends the wait for a pipe's reader.
    stop: Stop,
    /// Nanoseconds of processor time so far.
    cpu: Arc<AtomicU64>,
    /// The first frame with a NaN pixel.
    first_nan: Option<u32>,
    /// Number of values that exceeded the half floats of EXR files, and the first frame with such a value.
    clipped: u64,
    first_clipped: Option<u32>,
    /// Bytes of pictures so far, EXR files and animations excluded.
    bytes: u64,
    /// The last field, so that it is dropped after the temporary files in the folders are removed.
    folders: NewFolders,
}

impl Worker {
    /// Checks the job and prepares its folders. If this fails, new folders are removed.
    pub fn new(job: Arc<EncodeJob>, pool: Arc<ThreadPool>, stop: &Stop) -> Result<Self, EncodeError> {
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
            redrawn: Vec::new(),
            stop: stop.clone(),
            cpu,
            first_nan: None,
            clipped: 0,
            first_clipped: None,
            bytes: 0,
            folders,
        })
    }

    /// The counter of its processor time in nanoseconds.
    pub fn cpu(&self) -> Arc<AtomicU64> {
        Arc::clone(&self.cpu)
    }

    /// Sets which of the frames that need no film get new annotations.
    pub fn set_redrawn(&mut self, redrawn: Vec<bool>) {
        let count = redrawn.iter().filter(|redrawn| **redrawn).count() as u64;
        if count > 0 {
            let frames = counted(count, "frame");
            self.report.notes.push(format!(
                "{frames} of an earlier run got other annotations; their light is the same, so it was not traced again"
            ));
        }
        self.redrawn = redrawn;
    }

    /// Adds notes to the report.
    pub fn add_notes(&mut self, notes: Vec<String>) {
        self.report.notes.extend(notes);
    }

    /// Runs until everything is written. If the encoder is dropped, the thread stops with an error.
    pub fn run(mut self, messages: Receiver<Message>) -> Result<Report, EncodeError> {
        loop {
            let message = match messages.try_recv() {
                Ok(message) => Ok(message),
                Err(_) => debug_span!("wait for a film").in_scope(|| messages.recv()),
            };
            let start = Instant::now();
            match message {
                Ok(Message::Film(index, film, lease)) => self.next_film(index, film, lease.as_ref())?,
                Ok(Message::Kept(index)) => self.kept(index)?,
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
            self.cpu.store(((thread_cpu_time().unwrap_or(0.0) + others) * 1e9) as u64, Relaxed);
        }
    }

    /// Writes a film. If this is interrupted, the error gives the number of films that were finished before.
    fn next_film(&mut self, index: usize, film: Film, lease: Option<&Arc<Lease>>) -> Result<(), EncodeError> {
        let frame = self.job.frames[index];
        let _span = info_span!("encode", frame).entered();
        let noise = film.noise.map(|noise| noise.error);
        let denoised = film.noise.and_then(|noise| noise.denoised);
        let (start, before) = (Instant::now(), self.bytes);
        self.film(index, film, lease).map_err(|error| match error {
            EncodeError::Interrupted { signal, .. } => EncodeError::Interrupted { signal, done: self.done },
            error => error,
        })?;
        self.done += 1;
        info!(
            target: FRAME_EVENTS,
            frame,
            encode_s = start.elapsed().as_secs_f64(),
            bytes = self.bytes - before,
            noise,
            denoised,
            "encoded"
        );
        Ok(())
    }

    fn film(&mut self, index: usize, film: Film, lease: Option<&Arc<Lease>>) -> Result<(), EncodeError> {
        let job = Arc::clone(&self.job);
        let frame = job.frames[index];
        let info = FrameInfo { sequence: &job.info, frame, rate: job.rate };
        self.report.noise.extend(film.noise.map(|noise| (frame, noise)));
        let (picture, nan_pixels) = debug_span!("develop").in_scope(|| self.table.develop(&film));
        self.report.nan_pixels += nan_pixels;
        if nan_pixels > 0 {
            self.first_nan.get_or_insert(frame);
        }
        let drawn = DrawnPicture::new(&job, index, picture);
        let picture = &drawn.picture;
        let over = picture.alpha.is_some().then(|| picture.over(job.background_color));
        let opaque = over.as_ref().unwrap_or(picture);
        let developed = DevelopedFrame { index, info, film: &film, drawn: &drawn, opaque };
        for output in &job.outputs {
            if film.unfinished && output.is_stream() {
                continue;
            }
            let path = if film.unfinished { part_of(&output.path(frame)) } else { output.path(frame) };
            if let Output::Stills(StillFormat::Exr, _) = output {
                self.exr(&path, &developed, lease)?;
            } else if let Some(bytes) = still(&job, output, &developed) {
                self.put(&path, output, bytes, lease)?;
            }
        }
        self.unfinished += usize::from(film.unfinished);
        match &mut self.animations {
            // Animations that can be made from PNGs later contain only finished frames.
            Some(animations) if !(film.unfinished && job.source().is_some()) => {
                debug_span!("animations").in_scope(|| animations.push(picture, opaque))
            }
            _ => Ok(()),
        }
    }

    /// Makes the missing files of a kept frame from its PNG.
    fn kept(&mut self, index: usize) -> Result<(), EncodeError> {
        let job = Arc::clone(&self.job);
        let frame = job.frames[index];
        let _span = info_span!("keep", frame).entered();
        self.report.kept += 1;
        let redrawn = self.redrawn.get(index).copied().unwrap_or(false);
        let film = if redrawn { "redrawn" } else { "kept" };
        info!(target: FRAME_EVENTS, frame, film, "kept");
        if job.info.noise.is_some() || job.info.denoised {
            let noise = job.stored_metadata(frame).find_map(|entries| find_noise(&entries));
            self.report.noise.extend(noise.map(|noise| (frame, noise)));
        }
        let unidentified = |output: &&Output| !job.has_identity(output);
        let others = job.outputs.iter().any(|output| unidentified(&output));
        let Some(pattern) = job.source().filter(|_| others || redrawn) else { return Ok(()) };
        let path = pattern.path(frame);
        let (picture, bytes) = match redrawn {
            true => {
                let (picture, bytes) = job.redraw(index)?;
                self.commits.push(AtomicFile::with_encoded(&path, Ok(bytes.clone()), &self.stop)?, None)?;
                (picture, Some(bytes))
            }
            false => (png::read(&path)?, None),
        };
        if (picture.width, picture.height) != job.size {
            let reason = io::Error::new(io::ErrorKind::InvalidData, "its size has changed");
            return Err(EncodeError::read(path, reason));
        }
        let opaque = picture.over(job.background_color);
        for output in job.outputs.iter().filter(unidentified) {
            let bytes = match output {
                // The stored file, unchanged.
                Output::Stream(StreamFormat::Png) => {
                    Some(bytes.clone().map_or_else(|| fs::read(pattern.path(frame)), Ok))
                }
                _ => without_alpha(&job, output, &opaque),
            };
            if let Some(bytes) = bytes {
                self.put(&output.path(frame), output, bytes, None)?;
            }
        }
        match &mut self.animations {
            Some(animations) => animations.push(&picture, &opaque),
            None => Ok(()),
        }
    }

    /// Writes a frame's bytes to its file or to the standard output.
    fn put(
        &mut self,
        path: &Path,
        output: &Output,
        bytes: io::Result<Vec<u8>>,
        lease: Option<&Arc<Lease>>,
    ) -> Result<(), EncodeError> {
        let _span = debug_span!("write", %output).entered();
        self.bytes += bytes.as_ref().map_or(0, |bytes| bytes.len() as u64);
        if !output.is_stream() {
            return self.commits.push(AtomicFile::with_encoded(path, bytes, &self.stop)?, lease.cloned());
        }
        let mut stdout = io::stdout().lock();
        let put = bytes.and_then(|bytes| stdout.write_all(&bytes)).and_then(|()| stdout.flush());
        put.map_err(|error| EncodeError::write("the standard output", error))
    }

    /// Writes a frame's EXR file and counts the values that its floats cannot hold.
    fn exr(
        &mut self,
        path: &Path,
        frame: &DevelopedFrame,
        lease: Option<&Arc<Lease>>,
    ) -> Result<(), EncodeError> {
        let job = Arc::clone(&self.job);
        let metadata = exr::ExrMetadata {
            identity: identity(&job, StillFormat::Exr, frame),
            entries: metadata(&job, StillFormat::Exr, frame),
        };
        let annotations = job.drawing(frame.index).map(|drawing| AnnotationLayer::new(drawing, job.size));
        let layers = (&job.info.layers[..], annotations.as_ref());
        let (file, clipped) = exr::write(path, frame.film, job.formats.exr, layers, &metadata)?;
        self.clipped += clipped;
        if clipped > 0 {
            self.first_clipped.get_or_insert(frame.info.frame);
        }
        self.commits.push(file, lease.cloned())
    }

    fn finish(&mut self) -> Result<(), EncodeError> {
        let _span = info_span!("finish files").entered();
        self.commits.wait()?;
        if let Some(animations) = self.animations.take() {
            self.report.notes.extend(animations.finish(&self.job, &self.pool)?);
        }
        self.note_bad_values();
        self.report.files = self.job.outputs.iter().map(|output| output.name().to_owned()).collect();
        self.report.notes.extend(self.job.outputs.iter().filter_map(left_parts));
        self.folders.keep();
        Ok(())
    }

    /// Closes the animations with the frames so far.
    fn stop(&mut self) -> Result<(), EncodeError> {
        self.commits.wait()?;
        let Some(animations) = self.animations.take() else { return Ok(()) };
        if animations.is_empty() && self.unfinished == 0 {
            // Nothing was written, so new folders are removed.
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

    /// Notes NaN pixels and clipped values.
    fn note_bad_values(&mut self) {
        if let Some(first) = self.first_nan {
            let pixels = self.report.nan_pixels;
            let kept =
                self.job.outputs.iter().any(|output| matches!(output, Output::Stills(StillFormat::Exr, _)));
            let kept = if kept { "; EXR files keep them" } else { "" };
            self.report.notes.push(format!(
                "{pixels} pixels are NaN and are shown as 0, the first in frame {first}{kept}"
            ));
        }
        if let Some(first) = self.first_clipped {
            let numbers = counted(self.clipped, "number");
            self.report.notes.push(format!(
                "{numbers} above 65504, the maximum of `precision: Half`, are written as 65504 to EXR files, the first \
                 in frame {first}; `precision: Float` keeps them"
            ));
        }
    }
}

/// A note about unfinished frames of an earlier run. They stay, because the user may want them.
fn left_parts(output: &Output) -> Option<String> {
    let parts = FramePattern::parse(part_of(output.pattern()?.name())).ok()?;
    let there =
        if parts.has_placeholder() { !parts.numbers().ok()?.is_empty() } else { parts.name().is_file() };
    there.then(|| {
        format!("{} holds unfinished frames of an earlier run and can be deleted", escape::path(parts.name()))
    })
}

/// The run's own PNG files as the store of GIF frames. They can serve if they have 8 bits per channel and no alpha.
fn own_store(job: &EncodeJob) -> Option<Store> {
    let plain = !job.formats.png.deep && !job.transparent;
    job.outputs.iter().filter(|_| plain).find_map(|output| match output {
        Output::Stills(StillFormat::Png, pattern) => {
            Some(Store::Own { pattern: pattern.clone(), frames: job.frames.clone() })
        }
        _ => None,
    })
}
