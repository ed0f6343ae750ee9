//! Files on their way into their places, while the next frames are made: until the disk has stored a file, the encoder
//! would only wait, and small frames would take longer to store than to make.

use super::atomic::Aside;
use super::claim::Claim;
use super::error::EncodeError;
use std::collections::VecDeque;
use std::sync::Arc;
use std::thread::{self, JoinHandle};

/// Files that are stored at the same time. Disks store a few together in hardly more time than one.
const TOGETHER: usize = 4;

/// The oldest first. Dropped, it waits for all of them.
#[derive(Debug, Default)]
pub struct Commits {
    under_way: VecDeque<JoinHandle<Result<(), EncodeError>>>,
}

impl Commits {
    /// Lets a file come into its place, until when its claim holds. Returns the error of an earlier one, if there is one.
    pub fn push(&mut self, file: Aside, claim: Option<Arc<Claim>>) -> Result<(), EncodeError> {
        if self.under_way.len() >= TOGETHER {
            self.wait_for_first()?;
        }
        let thread = thread::Builder::new().name("store".into()).spawn(move || {
            let done = file.commit();
            drop(claim);
            done
        });
        self.under_way.push_back(thread.map_err(|error| EncodeError::Stopped(Some(error)))?);
        Ok(())
    }

    /// Waits until all are in their places.
    pub fn wait(&mut self) -> Result<(), EncodeError> {
        while !self.under_way.is_empty() {
            self.wait_for_first()?;
        }
        Ok(())
    }

    fn wait_for_first(&mut self) -> Result<(), EncodeError> {
        let Some(thread) = self.under_way.pop_front() else { return Ok(()) };
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

impl Drop for Commits {
    fn drop(&mut self) {
        for thread in self.under_way.drain(..) {
            // One that failed has left its place as it was, and an earlier error is being told.
            let _ = thread.join();
        }
    }
}
