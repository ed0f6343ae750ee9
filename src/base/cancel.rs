//! A request to stop: the user presses Ctrl-C, or the system shuts down.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// The signal that requests a stop, or 0 before one has arrived. Work checks it between frames.
#[derive(Clone, Debug, Default)]
pub struct Stop(Arc<AtomicUsize>);

impl Stop {
    /// The number of the signal, for a signal handler to set.
    pub fn flag(&self) -> &Arc<AtomicUsize> {
        &self.0
    }

    /// The signal, if one has arrived.
    pub fn signal(&self) -> Option<usize> {
        Some(self.0.load(Relaxed)).filter(|signal| *signal > 0)
    }
}
