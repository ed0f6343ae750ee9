//! Being asked to stop: by whoever presses Ctrl-C, or by the system that shuts down.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Looked at between frames. Holds the number of the signal that has come; 0 while none has.
#[derive(Clone, Debug, Default)]
pub struct Stop(Arc<AtomicUsize>);

impl Stop {
    /// Where the number is put.
    pub fn flag(&self) -> &Arc<AtomicUsize> {
        &self.0
    }

    /// The signal, if there was one.
    pub fn signal(&self) -> Option<usize> {
        Some(self.0.load(Relaxed)).filter(|signal| *signal > 0)
    }
}
