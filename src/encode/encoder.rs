//! The encoder: takes films in order and hands them to its thread.

use super::error::{EncodeError, FilmsError};
use super::job::{EncodeJob, Existing};
use super::keep::KeptFrames;
use super::lease::{self, Lease, LeaseHolder, Leases};
use super::message::{self, Message};
use super::report::Report;
use super::worker::Worker;
use crate::base::cancel::Stop;
use crate::base::digest::Digest;
use crate::base::machine::thread_cpu_time;
use crate::film::Film;
use rayon::ThreadPool;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::{self, JoinHandle};

/// Films that may wait in the queue, besides the film that the encoder works on.
const QUEUE_LENGTH: usize = 2;

/// The answer to [`Encoder::lease_frames`].
#[derive(Debug, PartialEq, Eq)]
pub enum FrameLease {
    /// This process holds the lease. These frames are missing, and the caller must push them next.
    Acquired(Vec<u32>),
    /// All frames are complete.
    Done,
    /// Another process holds the lease.
    HeldBy(LeaseHolder),
}

/// The handle of the encoding thread. If it is dropped before [`Encoder::finish`], encoding stops: stills that are
/// complete stay, no animation appears, and temporary files are removed.
pub struct Encoder {
    job: Arc<EncodeJob>,
    /// Frames passed to the thread so far, kept frames included.
    pushed: usize,
    /// For each frame of the job, whether it needs no film.
    kept: Vec<bool>,
    /// Nanoseconds of processor time of the thread; None if the system does not report them.
    cpu: Option<Arc<AtomicU64>>,
    /// The leases of this process, if several processes share the job.
    shared: Option<Shared>,
    /// None after the thread has failed or finished.
    running: Option<Running>,
}

/// The state of a job whose frames several processes make, in any order.
struct Shared {
    leases: Leases,
    /// The lease of the frames that are being pushed.
    current: Option<Arc<Lease>>,
}

struct Running {
    messages: SyncSender<Message>,
    thread: JoinHandle<Result<Report, EncodeError>>,
}

impl Encoder {
    /// Checks the job, creates its folders, tests that they are writable, and starts the thread. If this fails, no
    /// file is written and new folders are removed.
    ///
    /// The threads of `pool` check the frames of an earlier run and compress GIF frames. When `stop` is requested,
    /// the check ends early, and the encoder stops waiting for the readers of pipes.
    pub fn start(job: EncodeJob, pool: Arc<ThreadPool>, stop: &Stop) -> Result<Self, EncodeError> {
        let job = Arc::new(job);
        let mut worker = Worker::new(Arc::clone(&job), Arc::clone(&pool), stop)?;
        let cpu = thread_cpu_time().map(|_| worker.cpu());
        let KeptFrames { frames: kept, redrawn, notes } = job.find_kept(&pool, stop);
        worker.add_notes(notes);
        worker.set_redrawn(redrawn);
        worker.add_notes(job.extra_frame_notes());
        let shared =
            (job.existing == Existing::Share).then(|| Shared { leases: Leases::new(), current: None });
        let (messages, receiver) = sync_channel(QUEUE_LENGTH);
        let thread = thread::Builder::new().name("encode".into()).spawn(move || worker.run(receiver));
        let thread = thread.map_err(|e| EncodeError::Stopped(Some(e)))?;
        Ok(Self { job, pushed: 0, kept, shared, cpu, running: Some(Running { messages, thread }) })
    }

    /// Processor time of encoding so far in seconds, if the system reports it.
    pub fn cpu(&self) -> Option<f64> {
        self.cpu.as_ref().map(|nanoseconds| nanoseconds.load(Relaxed) as f64 * 1e-9)
    }

    /// The frames whose films are still to be pushed, in order. Kept frames are not among them.
    pub fn missing(&self) -> Vec<u32> {
        let frames = self.job.frames.iter().zip(&self.kept).skip(self.pushed);
        frames.filter(|(_, kept)| !**kept).map(|(frame, _)| *frame).collect()
    }

    /// Requests the lease of a film's frames, so that only one process makes them. The lease is held until the
    /// frames' files are in place.
    pub fn lease_frames(&mut self, film: Digest, frames: &[u32]) -> Result<FrameLease, EncodeError> {
        let indices: Vec<usize> = frames.iter().filter_map(|&frame| self.index_of(frame)).collect();
        let missing =
            |kept: &[bool]| indices.iter().copied().filter(|&index| !kept[index]).collect::<Vec<_>>();
        let Some(shared) = &mut self.shared else { return Ok(FrameLease::Acquired(frames.to_vec())) };
        // Films that were pushed before hold their own reference to the lease.
        shared.current = None;
        let Some(output) = self.job.outputs.first().filter(|_| !missing(&self.kept).is_empty()) else {
            return Ok(FrameLease::Done);
        };
        let lease = match shared.leases.acquire(&lease::path_of(output, film))? {
            Ok(lease) => lease,
            Err(holder) => return Ok(FrameLease::HeldBy(holder)),
        };
        // The previous holder may have made the frames since they were checked.
        for index in missing(&self.kept) {
            self.kept[index] = self.job.can_keep_frame(index);
        }
        let missing = missing(&self.kept);
        if missing.is_empty() {
            return Ok(FrameLease::Done);
        }
        shared.current = Some(Arc::new(lease));
        Ok(FrameLease::Acquired(missing.into_iter().map(|index| self.job.frames[index]).collect()))
    }

    /// Passes the next missing frame to the thread. Waits while the queue is full, so that memory stays bounded.
    ///
    /// Returns the error of an earlier frame as soon as it is known.
    pub fn push(&mut self, frame: u32, film: Film) -> Result<(), EncodeError> {
        if self.shared.is_none() {
            self.send_kept()?;
        }
        let index = self.check(frame, &film)?;
        let lease = self.shared.as_ref().and_then(|shared| shared.current.clone());
        if self.shared.is_some() {
            self.kept[index] = true;
        }
        self.send(Message::Film(index, film, lease))
    }

    /// Reports kept frames to the thread, up to the next missing one.
    fn send_kept(&mut self) -> Result<(), EncodeError> {
        while self.kept.get(self.pushed) == Some(&true) {
            self.send(Message::Kept(self.pushed))?;
        }
        Ok(())
    }

    /// Sends the message of the next frame.
    fn send(&mut self, message: Message) -> Result<(), EncodeError> {
        let Some(running) = &self.running else { return Err(EncodeError::Stopped(None)) };
        if !message::send(&running.messages, message) {
            return self.join().and(Err(EncodeError::Stopped(None)));
        }
        self.pushed += 1;
        Ok(())
    }

    /// Waits until all files are written.
    pub fn finish(mut self) -> Result<Report, EncodeError> {
        match self.shared.take() {
            // Other processes have made the frames that this one has not.
            Some(_) if self.kept.iter().all(|kept| *kept) => {
                let others = self.kept.len() - self.pushed;
                (0..others).try_for_each(|index| self.send(Message::Kept(index)))?;
            }
            Some(_) => {}
            None => self.send_kept()?,
        }
        if let Some(running) = &self.running {
            if self.pushed < self.job.frames.len() && !running.thread.is_finished() {
                let (expected, got) = (self.job.frames.len(), self.pushed);
                return Err(FilmsError::Missing { expected, got }.into());
            }
            // The send fails only if the thread has failed, and then joining it returns the error.
            let _ = running.messages.send(Message::Finish);
        }
        self.join()
    }

    /// Ends before the last frame. Stills stay, and animations are closed with the frames so far, as `part_NAME`.
    /// The report names the files.
    pub fn stop(mut self) -> Result<Report, EncodeError> {
        if let Some(running) = &self.running {
            let _ = running.messages.send(Message::Stop);
        }
        self.join()
    }

    /// A frame's index in the job's list.
    fn index_of(&self, frame: u32) -> Option<usize> {
        self.job.frames.binary_search(&frame).ok()
    }

    /// Checks that the job expects this film now, and returns the frame's index.
    fn check(&self, frame: u32, film: &Film) -> Result<usize, FilmsError> {
        let (index, expected) = match &self.shared {
            Some(_) => (self.index_of(frame).filter(|&index| !self.kept[index]), None),
            None => {
                let expected = self.job.frames.get(self.pushed).copied();
                (Some(self.pushed).filter(|_| expected == Some(frame)), expected)
            }
        };
        let Some(index) = index else { return Err(FilmsError::Order { expected, got: frame }) };
        let got = (film.width, film.height);
        if got != self.job.size {
            return Err(FilmsError::Size { frame, expected: self.job.size, got });
        }
        Ok(index)
    }

    /// Releases this handle's reference to the lease. Films in the queue keep theirs until they are written. After
    /// the last reference is gone, empty new folders can be removed.
    fn release_lease(&mut self) {
        if let Some(shared) = &mut self.shared {
            shared.current = None;
        }
    }

    /// Lets the thread end and returns its result.
    fn join(&mut self) -> Result<Report, EncodeError> {
        let Some(Running { messages, thread }) = self.running.take() else {
            return Err(EncodeError::Stopped(None));
        };
        self.release_lease();
        drop(messages);
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

impl Drop for Encoder {
    fn drop(&mut self) {
        self.release_lease();
        if let Some(Running { messages, thread }) = self.running.take() {
            drop(messages);
            // The work was abandoned, so nobody can handle its error or panic.
            let _ = thread.join();
        }
    }
}
