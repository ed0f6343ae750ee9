//! Temporary files and folders, and the locks that mark them as in use.

use super::disk::{Operation, attempt};
use super::error::EncodeError;
use super::place::folder_of;
use std::fs::File;
use std::path::Path;
use tempfile::TempDir;

/// How the name of every temporary file of every run begins.
pub const PREFIX: &str = ".kinora-";

/// The file in a spool folder whose lock marks the folder as in use.
pub const LOCK: &str = "lock";

/// Builds temporary files with the usual prefix and suffix.
pub fn builder() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(".part");
    builder
}

/// Locks a file to mark it as in use. The system releases the lock when the process ends, even after a crash. On
/// systems without locks, temporary files are never removed as leftovers.
pub fn mark(file: &File) {
    #[cfg(unix)]
    let _ = file.try_lock();
    #[cfg(not(unix))]
    let _ = file;
}

/// Creates a hidden folder beside the file `path`. It is marked as in use while the returned lock file is open.
pub fn spool(path: &Path) -> Result<(TempDir, File), EncodeError> {
    let folder = folder_of(path);
    let fault = |e| EncodeError::write(folder, e);
    let prefix = format!("{PREFIX}spool-");
    let make = || tempfile::Builder::new().prefix(&prefix).tempdir_in(folder);
    let spool = attempt(Operation::CreateFolder, folder, make).map_err(fault)?;
    let lock = spool.path().join(LOCK);
    let lock = attempt(Operation::Create, &lock, || File::create(&lock)).map_err(fault)?;
    mark(&lock);
    Ok((spool, lock))
}
