//! Work on a thread of its own, while Python stays responsive: to Ctrl-C, to other threads, and to a progress bar.

use kinora::ProgressMeter;
use kinora::base::cancel::Stop;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// How often Python may handle signals and show progress.
const INTERVAL: Duration = Duration::from_millis(50);

/// The number of the signal that an exception of Python stands for: SIGINT.
const INTERRUPTED: usize = 2;

/// What a run shows while it works.
pub struct Watched<'a, 'py> {
    /// Called with the number of finished frames and of all frames, whenever the first one has changed.
    pub progress: Option<&'a Bound<'py, PyAny>>,
    pub frames: usize,
    /// Whether an exception waits until the work has ended, because it writes files. A second exception does not.
    pub settles: bool,
}

/// Runs `work`. An exception, of a signal or of the callback, requests a stop and is raised.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    watched: Watched<'_, '_>,
    work: impl FnOnce(&Arc<ProgressMeter>, &Stop) -> T + Send + 'static,
) -> PyResult<T> {
    let (stop, meter) = (Stop::default(), Arc::new(ProgressMeter::default()));
    let (sender, mut receiver) = channel();
    let (of_work, meter_of_work) = (stop.clone(), Arc::clone(&meter));
    // Nobody receives the result of an interrupted run.
    let work = move || {
        let _ = sender.send(work(&meter_of_work, &of_work));
    };
    thread::Builder::new().name("kinora".to_owned()).spawn(work)?;
    let mut shown = None;
    let mut show = |done: usize| match watched.progress {
        Some(progress) if shown != Some(done) => {
            shown = Some(done);
            progress.call1((done, watched.frames)).map(|_| ())
        }
        _ => Ok(()),
    };
    let mut raised: Option<PyErr> = None;
    loop {
        // A receiver may move to other threads, but not be shared by them.
        let waiting = &mut receiver;
        let received = py.detach(move || waiting.recv_timeout(INTERVAL));
        match (received, raised.take()) {
            (Ok(_), Some(error)) => return Err(error),
            (Ok(result), None) => {
                // A run that failed has not finished its frames.
                return py.check_signals().and_then(|()| show(done(&meter))).map(|()| result);
            }
            (Err(RecvTimeoutError::Disconnected), _) => {
                return Err(PyRuntimeError::new_err("a thread of Kinora has ended with an internal error"));
            }
            (Err(RecvTimeoutError::Timeout), Some(error)) => {
                py.check_signals()?;
                raised = Some(error);
            }
            (Err(RecvTimeoutError::Timeout), None) => {
                if let Err(error) = py.check_signals().and_then(|()| show(done(&meter))) {
                    stop.flag().store(INTERRUPTED, Relaxed);
                    if !watched.settles {
                        return Err(error);
                    }
                    raised = Some(error);
                }
            }
        }
    }
}

fn done(meter: &ProgressMeter) -> usize {
    meter.frames.load(Relaxed) as usize
}
