//! Removal of temporary files that killed runs have left behind.

#[cfg(unix)]
use super::lease;
#[cfg(unix)]
use super::temporary::{LOCK, PREFIX};
#[cfg(unix)]
use crate::base::files;
#[cfg(unix)]
use std::fs;
use std::path::Path;
#[cfg(unix)]
use std::time::Duration;

/// Temporary files modified less than this ago are left alone, because their process may be about to lock them.
#[cfg(unix)]
pub const FRESH: Duration = Duration::from_secs(20);

/// Removes leftovers of killed runs from a folder. Files that a live process has locked stay, and so do files whose
/// state is unknown. Errors are ignored, because leftovers must not stop a run.
#[cfg(unix)]
pub fn sweep(folder: &Path) {
    for entry in folder.read_dir().into_iter().flatten().flatten() {
        let (name, path) = (entry.file_name(), entry.path());
        let name = name.to_string_lossy();
        if lease::is_lease(&name) {
            lease::sweep(&path);
        } else if name.starts_with(PREFIX) {
            // Opening a pipe would block, and a link leads elsewhere.
            let Ok(kind) = entry.file_type() else { continue };
            let is_spool = kind.is_dir();
            if !is_spool && !kind.is_file() {
                continue;
            }
            let marked = if is_spool { path.join(LOCK) } else { path.clone() };
            if is_left_over(&marked) {
                let _ = if is_spool { fs::remove_dir_all(&path) } else { fs::remove_file(&path) };
            }
        }
    }
}

#[cfg(not(unix))]
pub fn sweep(_: &Path) {}

#[cfg(unix)]
fn is_left_over(marked: &Path) -> bool {
    let Ok((file, _)) = files::open(marked, u64::MAX) else { return false };
    let age = file.metadata().and_then(|found| found.modified()).ok().and_then(|time| time.elapsed().ok());
    age.is_some_and(|age| age >= FRESH) && file.try_lock().is_ok()
}
