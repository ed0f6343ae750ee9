//! Renders the sequence while the preview goes on: the run of `kinora render`, with its bytes.

use super::session::request;
use crate::base::cancel::Stop;
use crate::base::escape;
use crate::base::stats::ProgressMeter;
use crate::pipeline::render::{RenderError, render_until};
use crate::sequence::Sequence;
use serde_json::{Value, json};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

/// A run on its own thread.
pub struct RenderTask {
    meter: Arc<ProgressMeter>,
    stop: Stop,
    frames: usize,
    outcome: Arc<Mutex<Option<Value>>>,
}

impl RenderTask {
    /// Renders all frames from number `from` on into the files that the sequence names. Frames that exist are kept.
    /// Calls `ended` at the end.
    pub fn start(
        sequence: Arc<Sequence>,
        from: u32,
        ended: impl FnOnce() + Send + 'static,
    ) -> Result<Self, String> {
        let (meter, stop, outcome) = (Arc::new(ProgressMeter::default()), Stop::default(), Arc::default());
        let mut request = request(&sequence);
        request.frames.retain(|frame| *frame >= from);
        let task =
            Self { meter: Arc::clone(&meter), stop: stop.clone(), frames: request.frames.len(), outcome };
        let outcome = Arc::clone(&task.outcome);
        let run = move || {
            let done = render_until(&sequence, &request, &meter, &stop);
            *outcome.lock().unwrap_or_else(PoisonError::into_inner) = Some(match done {
                Ok(summary) => json!({ "files": summary.files, "frames": summary.frames }),
                Err(RenderError::Stopped { done, .. }) => json!({ "stopped": done }),
                Err(error) => json!({ "error": escape::lines(&error.to_string()) }),
            });
            ended();
        };
        thread::Builder::new()
            .name("render".to_owned())
            .spawn(run)
            .map_err(|error| format!("cannot start a thread: {error}"))?;
        Ok(task)
    }

    /// Stops after the current frame; the frames so far stay.
    pub fn stop(&self) {
        self.stop.flag().store(1, std::sync::atomic::Ordering::Relaxed);
    }

    pub fn is_running(&self) -> bool {
        self.outcome.lock().unwrap_or_else(PoisonError::into_inner).is_none()
    }

    /// The progress, or the outcome.
    pub fn state(&self) -> Value {
        let outcome = self.outcome.lock().unwrap_or_else(PoisonError::into_inner).clone();
        json!({ "frames": self.frames, "done": self.meter.frames_done(), "outcome": outcome })
    }
}
