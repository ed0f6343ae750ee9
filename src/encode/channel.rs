//! Pipes and devices, opened to be written into.

use super::disk::{Operation, attempt};
use super::error::EncodeError;
use crate::base::cancel::Stop;
use crate::base::files::Channel;
use std::fs::{File, OpenOptions};
use std::io;
use std::path::Path;

/// Opens what is at `path`. For a pipe, waits until somebody reads it or a stop is requested.
pub fn open(path: &Path, channel: Channel, stop: &Stop) -> Result<File, EncodeError> {
    let opened = match channel {
        Channel::Pipe => attempt(Operation::Create, path, || wait(path, stop)),
        _ => attempt(Operation::Create, path, || plainly(path)).map(Ok),
    };
    opened
        .map_err(|error| EncodeError::write(path, error))?
        .map_err(|signal| EncodeError::Interrupted { signal, done: 0 })
}

fn plainly(path: &Path) -> io::Result<File> {
    OpenOptions::new().write(true).open(path)
}

/// The open pipe, or the signal that came first.
#[cfg(unix)]
fn wait(path: &Path, stop: &Stop) -> io::Result<Result<File, usize>> {
    use rustix::fs::{Mode, OFlags, fcntl_getfl, fcntl_setfl, open};
    use rustix::io::Errno;

    /// How often it is looked for a reader.
    const PAUSE: std::time::Duration = std::time::Duration::from_millis(10);
    // A blocking open would go on after a signal.
    let flags = OFlags::WRONLY | OFlags::NONBLOCK | OFlags::CLOEXEC;
    loop {
        match open(path, flags, Mode::empty()) {
            Ok(pipe) => {
                // What is written waits for the reader again.
                fcntl_setfl(&pipe, fcntl_getfl(&pipe)? - OFlags::NONBLOCK)?;
                return Ok(Ok(pipe.into()));
            }
            // Nobody reads it yet.
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
