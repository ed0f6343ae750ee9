//! Film → files: develops films into pictures and writes them on a thread of its own.
//!
//! ```text
//! Film ─┬─ exr ▶ atomic ▶ frame_0000.exr …
//!       └─ develop ▶ Picture ▶ caption ─┬─ png, jpeg, ppm ▶ atomic ▶ frame_0000.png …
//!                                       ├─ movie: apng, webp, mp4, y4m ▶ atomic ▶ out.mp4
//!                                       ├─ store (the PNGs, or a spool) ──┐
//!                                       └─ gif: histogram ▶ palette ──────┴▶ dither ▶ delta ▶ atomic ▶ out.gif
//! ```

mod about;
mod animations;
mod assembly;
mod atomic;
mod caption;
mod channel;
mod claim;
mod commits;
mod develop;
mod disk;
mod error;
mod exr;
#[cfg(test)]
mod fault_tests;
mod found;
mod gif;
mod identity;
mod inspect;
mod job;
mod jpeg;
mod keep;
mod movie;
mod output;
mod pattern;
mod picture;
mod place;
mod png;
mod ppm;
mod record;
mod settings;
mod sheet;
mod store;
mod text;
#[cfg(test)]
mod tests;
mod tonemap;
mod worker;

pub use about::{About, Shown, TimeLimit};
pub use assembly::{Assembly, read_picture};
pub use atomic::{NewFolders, write as write_file};
pub use caption::{Caption, CaptionError, Corner, Template};
pub use claim::{Claim, Holder};
pub use develop::{ToneTable, displayed};
pub use error::{EncodeError, FilmsError, JobError};
pub use exr::{ALBEDO, NORMAL};
pub use found::{Found, found, in_hand};
pub use identity::Seen;
pub use inspect::{Flaw, Inspected, inspect, inspect_job};
pub use job::{Existing, Job, check_size, check_within, prepare_picture};
pub use output::{Moving, Output, OutputError, Still, Streamed};
pub use pattern::{FramePattern, PatternError};
pub use picture::Picture;
pub use place::same_file;
pub use png::texts as frame_texts;
pub use settings::{
    ExrLayers, ExrSettings, Formats, GifSettings, JpegSettings, MATTE, Mp4Settings, Plays, PngSettings,
    PpmSettings, Y4mSettings,
};
pub use sheet::{Sheet, columns as sheet_columns};
pub use text::FONT_FILE;
pub use tonemap::Tonemap;

use crate::base::cancel::Stop;
use crate::base::digest::Digest;
use crate::base::machine::thread_time;
use crate::film::{Film, Noise};
use atomic::Aside;
use claim::Claims;
use keep::Kept;
use rayon::ThreadPool;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::mpsc::{SyncSender, TrySendError, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;
use worker::Worker;

/// Writes a picture of no frame in particular, such as a filmstrip, as a still of 8 bits.
pub fn write_picture(output: &Output, picture: &Picture, formats: Formats) -> Result<(), EncodeError> {
    let bytes = match output {
        Output::Stills(Still::Png, _) => png::encode(picture, &[]),
        Output::Stills(Still::Jpeg, _) => jpeg::encode(picture, formats.jpeg.quality),
        Output::Stills(Still::Ppm, _) => ppm::encode(picture, formats.ppm.ascii),
        Output::Stills(Still::Exr, _) | Output::Movie(..) | Output::Stream(_) => {
            return Err(JobError::NoPicture { output: output.to_string() }.into());
        }
    };
    holding(&output.path(0), bytes, &Stop::default())?.commit()
}

/// Writes a picture as a PNG, whole or not at all.
pub fn write_png(path: &Path, picture: &Picture) -> Result<(), EncodeError> {
    holding(path, png::encode(picture, &[]), &Stop::default())?.commit()
}

/// A file of these bytes aside, for the place `path`.
fn holding(path: &Path, bytes: io::Result<Vec<u8>>, stop: &Stop) -> Result<Aside, EncodeError> {
    let bytes = bytes.map_err(|error| EncodeError::write(path, error))?;
    Aside::holding(path, &bytes, stop)
}

/// A picture as a PNG in memory.
pub fn png_bytes(picture: &Picture) -> std::io::Result<Vec<u8>> {
    png::encode(picture, &[])
}

/// Films that wait for the encoder at most, besides the one it works on.
const WAITING: usize = 2;

/// How long a thread of the pool rests that has nothing to do but wait for the encoder.
const PAUSE: Duration = Duration::from_millis(1);

/// What was written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// One per output, in the job's order: the pattern of stills as the user wrote it, or the file.
    pub files: Vec<PathBuf>,
    /// Frames that were there, and were left as they are.
    pub kept: u32,
    /// How good the frames are that were sampled until they were good enough, kept ones among them.
    pub noise: Vec<(u32, Noise)>,
    /// What the user should know, a line each.
    pub notes: Vec<String>,
    /// Pixels of all films with a component that is not a number; such components are written as 0.
    pub nan_pixels: u64,
    /// Time the encoder was at work.
    pub busy: Duration,
}

/// What the encoder's thread is told of frames, by their places in the job's list.
enum Message {
    /// With the claim that holds until the frame's files are there.
    Film(usize, Film, Option<Arc<Claim>>),
    /// The frame's files are there.
    Kept(usize),
    Finish,
    /// No more frames come, though more were announced.
    Stop,
}

/// What came of asking for frames that others may make, too.
#[derive(Debug, PartialEq, Eq)]
pub enum Asked {
    /// These of them are missing, and are to be pushed next.
    Mine(Vec<u32>),
    /// All of them are there.
    Done,
    /// Somebody has them in hand.
    Theirs(Holder),
}

/// The encoding thread. Dropped before [`Encoder::finish`], it stops: stills that are written stay, a GIF
/// does not appear, and temporaries vanish.
pub struct Encoder {
    job: Arc<Job>,
    /// Frames taken so far, with those that are kept.
    pushed: usize,
    /// Which of the job's frames need no film.
    kept: Vec<bool>,
    /// Nanoseconds that the thread has worked on a processor; none where the system does not tell.
    cpu: Option<Arc<AtomicU64>>,
    /// What this process makes, where others make frames of the job, too.
    shared: Option<Shared>,
    /// None once the thread has failed or finished.
    running: Option<Running>,
}

/// A job's frames that several processes make, in any order.
struct Shared {
    claims: Claims,
    /// The claim of the frames that are pushed now.
    now: Option<Arc<Claim>>,
}

struct Running {
    messages: SyncSender<Message>,
    thread: JoinHandle<Result<Report, EncodeError>>,
}

impl Encoder {
    /// Checks the job, creates and probes the folders it writes to, and starts the thread. If this fails,
    /// nothing was written and no folder is left behind.
    ///
    /// Frames of an earlier run are looked at, on the threads of `pool`, which also compress those of a GIF. Where
    /// `stop` asks for it, the rest is not looked at, and pipes are not waited for any longer that nobody reads.
    pub fn start(job: Job, pool: Arc<ThreadPool>, stop: &Stop) -> Result<Self, EncodeError> {
        let job = Arc::new(job);
        let mut worker = Worker::new(Arc::clone(&job), Arc::clone(&pool), stop)?;
        let cpu = thread_time().map(|_| worker.cpu());
        let Kept { frames: kept, notes } = job.kept(&pool, stop);
        worker.tell(notes);
        worker.tell(job.beyond());
        let shared = (job.existing == Existing::Share).then(|| Shared { claims: Claims::new(), now: None });
        let (messages, receiver) = sync_channel(WAITING);
        let thread = thread::Builder::new().name("encode".into()).spawn(move || worker.run(receiver));
        let thread = thread.map_err(|e| EncodeError::Stopped(Some(e)))?;
        Ok(Self { job, pushed: 0, kept, shared, cpu, running: Some(Running { messages, thread }) })
    }

    /// Seconds that encoding has taken of a processor so far, where the system tells.
    pub fn cpu(&self) -> Option<f64> {
        self.cpu.as_ref().map(|nanoseconds| nanoseconds.load(Relaxed) as f64 * 1e-9)
    }

    /// The frames of which films are still to come, in order: those that are not kept.
    pub fn missing(&self) -> Vec<u32> {
        let frames = self.job.frames.iter().zip(&self.kept).skip(self.pushed);
        frames.filter(|(_, kept)| !**kept).map(|(frame, _)| *frame).collect()
    }

    /// Asks for the frames of a film, which one process should make. If that is this one, they are claimed until their
    /// files are there.
    pub fn ask(&mut self, film: Digest, frames: &[u32]) -> Result<Asked, EncodeError> {
        let places: Vec<usize> = frames.iter().filter_map(|&frame| self.place(frame)).collect();
        let missing =
            |kept: &[bool]| places.iter().copied().filter(|&place| !kept[place]).collect::<Vec<_>>();
        let Some(shared) = &mut self.shared else { return Ok(Asked::Mine(frames.to_vec())) };
        // The films before have theirs.
        shared.now = None;
        let Some(output) = self.job.outputs.first().filter(|_| !missing(&self.kept).is_empty()) else {
            return Ok(Asked::Done);
        };
        let claim = match shared.claims.claim(&claim::path_of(output, film))? {
            Ok(claim) => claim,
            Err(holder) => return Ok(Asked::Theirs(holder)),
        };
        // Whoever had them until now may have made them.
        for place in missing(&self.kept) {
            self.kept[place] = self.job.keeps_frame(place);
        }
        let missing = missing(&self.kept);
        if missing.is_empty() {
            return Ok(Asked::Done);
        }
        shared.now = Some(Arc::new(claim));
        Ok(Asked::Mine(missing.into_iter().map(|place| self.job.frames[place]).collect()))
    }

    /// Hands over the next frame that is missing; waits while the encoder is behind, so that memory stays bounded.
    ///
    /// Returns the error of an earlier frame as soon as there is one.
    pub fn push(&mut self, frame: u32, film: Film) -> Result<(), EncodeError> {
        if self.shared.is_none() {
            self.pass_kept()?;
        }
        let place = self.check(frame, &film)?;
        let claim = self.shared.as_ref().and_then(|shared| shared.now.clone());
        if self.shared.is_some() {
            self.kept[place] = true;
        }
        self.send(Message::Film(place, film, claim))
    }

    /// Lets the encoder know of kept frames up to the next that is missing.
    fn pass_kept(&mut self) -> Result<(), EncodeError> {
        while self.kept.get(self.pushed) == Some(&true) {
            self.send(Message::Kept(self.pushed))?;
        }
        Ok(())
    }

    /// Tells of the next frame.
    fn send(&mut self, message: Message) -> Result<(), EncodeError> {
        let Some(running) = &self.running else { return Err(EncodeError::Stopped(None)) };
        if !hand_over(&running.messages, message) {
            return self.join().and(Err(EncodeError::Stopped(None)));
        }
        self.pushed += 1;
        Ok(())
    }

    /// Waits for everything to be written.
    pub fn finish(mut self) -> Result<Report, EncodeError> {
        match self.shared.take() {
            // What this process has not made, others have.
            Some(_) if self.kept.iter().all(|kept| *kept) => {
                let others = self.kept.len() - self.pushed;
                (0..others).try_for_each(|place| self.send(Message::Kept(place)))?;
            }
            Some(_) => {}
            None => self.pass_kept()?,
        }
        if let Some(running) = &self.running {
            if self.pushed < self.job.frames.len() && !running.thread.is_finished() {
                let (expected, got) = (self.job.frames.len(), self.pushed);
                return Err(FilmsError::Missing { expected, got }.into());
            }
            // If the thread has failed and does not listen, joining it tells why.
            let _ = running.messages.send(Message::Finish);
        }
        self.join()
    }

    /// Ends before the last frame: stills stay, and animations are closed with the frames that came, as
    /// `part_NAME`. The report names what was written.
    pub fn stop(mut self) -> Result<Report, EncodeError> {
        if let Some(running) = &self.running {
            let _ = running.messages.send(Message::Stop);
        }
        self.join()
    }

    /// A frame's place in the job's list.
    fn place(&self, frame: u32) -> Option<usize> {
        self.job.frames.binary_search(&frame).ok()
    }

    /// Whether the film is one that the job announced; gives its place.
    fn check(&self, frame: u32, film: &Film) -> Result<usize, FilmsError> {
        let (place, expected) = match &self.shared {
            Some(_) => (self.place(frame).filter(|&place| !self.kept[place]), None),
            None => {
                let expected = self.job.frames.get(self.pushed).copied();
                (Some(self.pushed).filter(|_| expected == Some(frame)), expected)
            }
        };
        let Some(place) = place else { return Err(FilmsError::Order { expected, got: frame }) };
        let got = (film.width, film.height);
        if got != self.job.size {
            return Err(FilmsError::Size { frame, expected: self.job.size, got });
        }
        Ok(place)
    }

    /// Gives up the claim of what will not be pushed any more; what was pushed has its part in it. Folders that were
    /// made for nothing can go then.
    fn give_up(&mut self) {
        if let Some(shared) = &mut self.shared {
            shared.now = None;
        }
    }

    /// Lets the thread end and returns what it has to say.
    fn join(&mut self) -> Result<Report, EncodeError> {
        let Some(Running { messages, thread }) = self.running.take() else {
            return Err(EncodeError::Stopped(None));
        };
        self.give_up();
        drop(messages);
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

/// Sends a message; false if the encoder's thread has ended.
///
/// The encoder may wait for jobs of the pool that this thread belongs to. So this thread works on them while there is no
/// room for the message: a pool of one thread would wait forever.
fn hand_over(messages: &SyncSender<Message>, mut message: Message) -> bool {
    loop {
        match messages.try_send(message) {
            Ok(()) => return true,
            Err(TrySendError::Disconnected(_)) => return false,
            Err(TrySendError::Full(back)) => message = back,
        }
        match rayon::yield_now() {
            Some(rayon::Yield::Executed) => {}
            Some(rayon::Yield::Idle) => thread::sleep(PAUSE),
            // A thread of no pool.
            None => return messages.send(message).is_ok(),
        }
    }
}

impl Drop for Encoder {
    fn drop(&mut self) {
        self.give_up();
        if let Some(Running { messages, thread }) = self.running.take() {
            drop(messages);
            // An error or a panic of abandoned work has no one to go to.
            let _ = thread.join();
        }
    }
}
