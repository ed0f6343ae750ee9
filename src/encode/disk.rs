//! File operations, one at a time, so that tests can make any of them fail.

use std::io;
use std::path::Path;

/// A kind of file operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    CreateFolder,
    Create,
    Write,
    Seek,
    /// Waiting until the bytes are on disk.
    Sync,
    Rename,
    Read,
}

/// Runs an operation on a file or folder. In tests, planned faults make it fail instead.
pub fn attempt<T>(operation: Operation, path: &Path, act: impl FnOnce() -> io::Result<T>) -> io::Result<T> {
    #[cfg(test)]
    faults::check(operation, path)?;
    #[cfg(not(test))]
    let _ = (operation, path);
    act()
}

#[cfg(test)]
pub mod faults {
    //! Planned faults. Each plan is for one folder, because tests run in parallel.

    use super::Operation;
    use std::io;
    use std::path::{Path, PathBuf};
    use std::sync::{Mutex, MutexGuard};

    /// Which operations in a folder fail.
    struct FaultPlan {
        folder: PathBuf,
        first: usize,
        /// Whether all later operations fail too, except reads.
        lasts: bool,
        seen: Vec<Operation>,
    }

    static PLANS: Mutex<Vec<FaultPlan>> = Mutex::new(Vec::new());

    fn plans() -> MutexGuard<'static, Vec<FaultPlan>> {
        PLANS.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    /// Makes the operation of this index in a folder fail, counted from now on.
    pub fn plan(folder: &Path, first: usize, lasts: bool) {
        plans().push(FaultPlan { folder: folder.to_owned(), first, lasts, seen: Vec::new() });
    }

    /// Ends the faults of a folder and returns the operations so far.
    pub fn end(folder: &Path) -> Vec<Operation> {
        let mut plans = plans();
        let place = plans.iter().position(|plan| plan.folder == folder);
        place.map_or_else(Vec::new, |place| plans.remove(place).seen)
    }

    pub fn check(operation: Operation, path: &Path) -> io::Result<()> {
        let mut plans = plans();
        let Some(plan) = plans.iter_mut().find(|plan| path.starts_with(&plan.folder)) else { return Ok(()) };
        let place = plan.seen.len();
        plan.seen.push(operation);
        let still = plan.lasts && place > plan.first && operation != Operation::Read;
        if place == plan.first || still { Err(io::ErrorKind::StorageFull.into()) } else { Ok(()) }
    }
}
