//! Commits files in background threads. Without them, the encoder would wait for the disk after every file, and small
//! frames take longer to sync than to encode.

use super::atomic::AtomicFile;
use super::error::EncodeError;
use super::lease::Lease;
use std::collections::VecDeque;
use std::sync::Arc;
use std::thread::{self, JoinHandle};

/// Files that are committed at the same time. Disks sync a few files in hardly more time than one.
const MAX_IN_FLIGHT: usize = 4;

/// The commits in flight, the oldest first. Dropping it waits for all of them.
#[derive(Debug, Default)]
pub struct Commits {
    in_flight: VecDeque<JoinHandle<Result<(), EncodeError>>>,
}

impl Commits {
    /// Commits a file and then releases its lease. Returns the error of an earlier commit, if one failed.
    pub fn push(&mut self, file: AtomicFile, lease: Option<Arc<Lease>>) -> Result<(), EncodeError> {
        if self.in_flight.len() >= MAX_IN_FLIGHT {
            self.wait_for_first()?;
        }
        let thread = thread::Builder::new().name("store".into()).spawn(move || {
            let _span = tracing::debug_span!("store").entered();
            let done = file.commit();
            drop(lease);
            done
        });
        self.in_flight.push_back(thread.map_err(|error| EncodeError::Stopped(Some(error)))?);
        Ok(())
    }

    /// Waits for all commits.
    pub fn wait(&mut self) -> Result<(), EncodeError> {
        while !self.in_flight.is_empty() {
            self.wait_for_first()?;
        }
        Ok(())
    }

    fn wait_for_first(&mut self) -> Result<(), EncodeError> {
        let Some(thread) = self.in_flight.pop_front() else { return Ok(()) };
        let _span = tracing::debug_span!("wait for the disk").entered();
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

impl Drop for Commits {
    fn drop(&mut self) {
        for thread in self.in_flight.drain(..) {
            // A failed commit leaves the old file, and the caller already handles an earlier error.
            let _ = thread.join();
        }
    }
}
