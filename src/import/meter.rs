//! How far loading has come, for whoever watches from another thread. Nothing is decided by it.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

/// What is being loaded, and how far that is.
#[derive(Debug, Default)]
pub struct LoadMeter {
    what: Mutex<String>,
    done: AtomicU64,
    total: AtomicU64,
}

impl LoadMeter {
    /// Starts on the next thing, such as "loading bunny.ply", which has `total` bytes; 0 if nobody knows.
    pub fn start(&self, what: String, total: u64) {
        *self.what.lock().unwrap_or_else(PoisonError::into_inner) = what;
        self.done.store(0, Relaxed);
        self.total.store(total, Relaxed);
    }

    pub fn advance(&self, bytes: u64) {
        self.done.fetch_add(bytes, Relaxed);
    }

    /// What is being done; empty before anything is.
    pub fn what(&self) -> String {
        self.what.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Bytes done and bytes there are; none if nobody knows how many there are.
    pub fn share(&self) -> Option<(u64, u64)> {
        let (done, total) = (self.done.load(Relaxed), self.total.load(Relaxed));
        (total > 0).then_some((done.min(total), total))
    }
}
