//! Opening pipes and devices for writing.

use super::disk::{Operation, attempt};
use super::error::EncodeError;
use crate::base::cancel::Stop;
use crate::base::files::SpecialFile;
use std::fs::{File, OpenOptions};
use std::io;
use std::path::Path;

/// Opens the pipe or device at `path`. For a pipe, waits for a reader or for a stop request.
pub fn open(path: &Path, channel: SpecialFile, stop: &Stop) -> Result<File, EncodeError> {
    let opened = match channel {
        SpecialFile::Pipe => attempt(Operation::Create, path, || wait(path, stop)),
        _ => attempt(Operation::Create, path, || plainly(path)).map(Ok),
    };
    opened
        .map_err(|error| EncodeError::write(path, error))?
        .map_err(|signal| EncodeError::Interrupted { signal, done: 0 })
}

fn plainly(path: &Path) -> io::Result<File> {
    OpenOptions::new().write(true).open(path)
}

/// The open pipe, or the signal that ended the wait.
#[cfg(unix)]
fn wait(path: &Path, stop: &Stop) -> io::Result<Result<File, usize>> {
    use rustix::fs::{Mode, OFlags, fcntl_getfl, fcntl_setfl, open};
    use rustix::io::Errno;

    /// Interval of the checks for a reader.
    const PAUSE: std::time::Duration = std::time::Duration::from_millis(10);
    // A blocking open would continue after a signal.
    let flags = OFlags::WRONLY | OFlags::NONBLOCK | OFlags::CLOEXEC;
    let _span = tracing::debug_span!("wait for a reader", path = %crate::base::escape::path(path)).entered();
    loop {
        match open(path, flags, Mode::empty()) {
            Ok(pipe) => {
                // Writes may block again.
                fcntl_setfl(&pipe, fcntl_getfl(&pipe)? - OFlags::NONBLOCK)?;
                return Ok(Ok(pipe.into()));
            }
            // The pipe has no reader yet.
            Err(Errno::NXIO) => {}
            Err(error) => return Err(error.into()),
        }
        if let Some(signal) = stop.signal() {
            return Ok(Err(signal));
        }
        std::thread::sleep(PAUSE);
    }
}

#[cfg(not(unix))]
fn wait(path: &Path, _: &Stop) -> io::Result<Result<File, usize>> {
    plainly(path).map(Ok)
}
