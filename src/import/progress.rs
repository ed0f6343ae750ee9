//! The progress of loading, which another thread displays. It does not affect the result.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

/// The current step of loading and its progress in bytes.
#[derive(Debug, Default)]
pub struct LoadProgress {
    what: Mutex<String>,
    done: AtomicU64,
    total: AtomicU64,
}

impl LoadProgress {
    /// Starts the next step, such as "loading bunny.ply". It has `total` bytes; 0 if their number is unknown.
    pub fn start(&self, what: String, total: u64) {
        *self.what.lock().unwrap_or_else(PoisonError::into_inner) = what;
        self.done.store(0, Relaxed);
        self.total.store(total, Relaxed);
    }

    pub fn advance(&self, bytes: u64) {
        self.done.fetch_add(bytes, Relaxed);
    }

    /// The current step; empty before the first one.
    pub fn what(&self) -> String {
        self.what.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Bytes done and total bytes; `None` if the total is unknown.
    pub fn bytes(&self) -> Option<(u64, u64)> {
        let (done, total) = (self.done.load(Relaxed), self.total.load(Relaxed));
        (total > 0).then_some((done.min(total), total))
    }
}
