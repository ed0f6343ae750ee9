//! Leases: files by which a process reserves frames, so that other processes do not make them too.
//!
//! A lease covers all frames of one film, because the film has to be traced only once. It is a hidden file in the
//! folder of the frames, and its name is a digest of the film and of the frames' names. A process writes it under a
//! temporary name, then links or renames it into place if the name is free; only one process can succeed, so no lock is
//! needed. The process touches the file every few seconds. A lease is void when its process has ended, or when it was
//! not touched for [`EXPIRY`](holder::EXPIRY). All times come from the file system's clock: the time of a new file is
//! compared with the time of the lease.
//!
//! Leases only save work; the bytes of outputs do not depend on them. If a process is suspended for longer than the
//! expiry, two processes may make the same frame. Then both write the same file, completely.

mod holder;
#[cfg(test)]
mod tests;

#[cfg(any(unix, test))]
pub use holder::is_lease;
pub use holder::{LeaseHolder, holder, path_of};

use super::disk::{Operation, attempt};
use super::error::EncodeError;
use super::place::folder_of;
use super::temporary;
use crate::base::process::Process;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

/// How often a lease is touched.
const HEARTBEAT: Duration = Duration::from_secs(10);

/// The leases of a process.
#[derive(Debug)]
pub struct Leases {
    process: Process,
    held: Arc<OpenLeases>,
    /// Dropping it ends the heartbeat thread.
    _alive: Sender<()>,
}

/// The open files of the leases that the process holds.
type OpenLeases = Mutex<BTreeMap<PathBuf, File>>;

/// A lease that this process holds. Dropping it releases the lease.
#[derive(Debug)]
pub struct Lease {
    path: PathBuf,
    text: String,
    held: Arc<OpenLeases>,
}

impl Leases {
    /// Starts the heartbeat thread. No lease is held yet.
    pub fn new() -> Self {
        let held: Arc<OpenLeases> = Arc::default();
        let (alive, over) = channel();
        let touched = Arc::downgrade(&held);
        let beats = move || {
            while over.recv_timeout(HEARTBEAT) == Err(RecvTimeoutError::Timeout) {
                let Some(held) = touched.upgrade() else { return };
                for (path, file) in lock(&held).iter_mut() {
                    // A single failure does no harm, because further heartbeats follow.
                    let _ = attempt(Operation::Write, path, || touch(file));
                }
            }
        };
        // If the thread cannot start, leases expire early. That costs duplicate work, but no frame.
        let _ = thread::Builder::new().name("leases".into()).spawn(beats);
        Self { process: Process::this(), held, _alive: alive }
    }

    /// Acquires a lease, or returns the process that holds it.
    pub fn acquire(&self, path: &Path) -> Result<Result<Lease, LeaseHolder>, EncodeError> {
        let fault = |error| EncodeError::write(path, error);
        loop {
            if let Some(lease) = self.create(path).map_err(fault)? {
                return Ok(Ok(lease));
            }
            match holder(path).map_err(fault)? {
                // The holder has released it meanwhile.
                None => {}
                Some(holder) if holder.is_gone() => remove_void(path, &holder).map_err(fault)?,
                Some(holder) => return Ok(Err(holder)),
            }
        }
    }

    /// Creates the lease's file. `None` if the file already exists.
    fn create(&self, path: &Path) -> io::Result<Option<Lease>> {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let text = format!("{}\n{}\n", self.process, COUNT.fetch_add(1, Relaxed));
        let mut file =
            attempt(Operation::Create, path, || temporary::builder().tempfile_in(folder_of(path)))?;
        attempt(Operation::Write, path, || file.write_all(text.as_bytes()))?;
        let placed = attempt(Operation::Rename, path, || match file.persist_noclobber(path) {
            Ok(file) => Ok(Some(file)),
            // A file server may have linked the file although its answer was lost.
            Err(error) if error.error.kind() == ErrorKind::AlreadyExists && has_text(path, &text) => {
                error.file.as_file().try_clone().map(Some)
            }
            Err(error) if error.error.kind() == ErrorKind::AlreadyExists => Ok(None),
            Err(error) => Err(error.error),
        });
        Ok(placed?.map(|file| {
            lock(&self.held).insert(path.to_owned(), file);
            Lease { path: path.to_owned(), text, held: Arc::clone(&self.held) }
        }))
    }
}

/// Updates the file's modification time by writing the same text again.
fn touch(file: &mut File) -> io::Result<()> {
    let text = {
        let mut text = Vec::new();
        file.seek(SeekFrom::Start(0))?;
        io::Read::read_to_end(file, &mut text)?;
        text
    };
    file.seek(SeekFrom::Start(0))?;
    file.write_all(&text)
}

impl Drop for Lease {
    fn drop(&mut self) {
        lock(&self.held).remove(&self.path);
        // If the lease has expired, the file may be another process's by now.
        if has_text(&self.path, &self.text) {
            let _ = fs::remove_file(&self.path);
        }
    }
}

fn has_text(path: &Path, text: &str) -> bool {
    fs::read_to_string(path).is_ok_and(|found| found == text)
}

fn lock(held: &OpenLeases) -> MutexGuard<'_, BTreeMap<PathBuf, File>> {
    held.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes a void lease. If several processes try, one of them succeeds. A process that finds that it has moved
/// another process's valid lease puts it back.
fn remove_void(path: &Path, holder: &LeaseHolder) -> io::Result<()> {
    let taken = temporary::builder().tempfile_in(folder_of(path))?.into_temp_path();
    match attempt(Operation::Rename, path, || fs::rename(path, &taken)) {
        Ok(()) if has_text(&taken, &holder.text) => Ok(()),
        Ok(()) => match taken.persist_noclobber(path) {
            Err(error) if error.error.kind() != ErrorKind::AlreadyExists => Err(error.error),
            _ => Ok(()),
        },
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        Err(error) => Err(error),
    }
}

/// Removes a lease if it is void.
#[cfg(unix)]
pub fn sweep(path: &Path) {
    if let Ok(Some(holder)) = holder(path)
        && holder.is_gone()
    {
        let _ = remove_void(path, &holder);
    }
}
