//! The queue between the renderer and the encoder's thread.

use super::lease::Lease;
use crate::film::Film;
use std::sync::Arc;
use std::sync::mpsc::{SyncSender, TrySendError};
use std::thread;
use std::time::Duration;

/// A message to the encoder's thread. Frames are given by their index in the job's list.
pub enum Message {
    /// A film to encode. The lease is held until the frame's files are in place.
    Film(usize, Film, Option<Arc<Lease>>),
    /// The frame's files already exist.
    Kept(usize),
    Finish,
    /// No more frames follow, although the job announced more.
    Stop,
}

/// Pause of a pool's thread that has no other work while the queue is full.
const PAUSE: Duration = Duration::from_millis(1);

/// Sends a message. Returns false if the encoder's thread has ended.
///
/// The encoder may wait for tasks of the pool that the calling thread belongs to. So this function runs such tasks
/// while the queue is full. Without that, a pool of one thread would deadlock.
pub fn send(messages: &SyncSender<Message>, mut message: Message) -> bool {
    let mut waiting = None;
    loop {
        match messages.try_send(message) {
            Ok(()) => return true,
            Err(TrySendError::Disconnected(_)) => return false,
            Err(TrySendError::Full(back)) => message = back,
        }
        waiting.get_or_insert_with(|| tracing::debug_span!("wait for the encoder").entered());
        match rayon::yield_now() {
            Some(rayon::Yield::Executed) => {}
            Some(rayon::Yield::Idle) => thread::sleep(PAUSE),
            // The calling thread belongs to no pool.
            None => return messages.send(message).is_ok(),
        }
    }
}
