//! What is done to files, one operation at a time, so that tests can let any of them fail.

use std::io;
use std::path::Path;

/// What may fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    CreateFolder,
    Create,
    Write,
    Seek,
    /// Until the bytes are stored.
    Sync,
    Rename,
    Read,
}

/// Does something to a file or folder. In tests, what they ask for fails instead.
pub fn attempt<T>(operation: Operation, path: &Path, act: impl FnOnce() -> io::Result<T>) -> io::Result<T> {
    #[cfg(test)]
    faults::check(operation, path)?;
    #[cfg(not(test))]
    let _ = (operation, path);
    act()
}

#[cfg(test)]
pub mod faults {
    //! Faults that tests ask for, each in a folder of its own, as tests run beside each other.

    use super::Operation;
    use std::io;
    use std::path::{Path, PathBuf};
    use std::sync::{Mutex, MutexGuard};

    /// From which operation on a folder has faults.
    struct Plan {
        folder: PathBuf,
        first: usize,
        /// Whether everything after the first fails as well, but for reading.
        lasts: bool,
        seen: Vec<Operation>,
    }

    static PLANS: Mutex<Vec<Plan>> = Mutex::new(Vec::new());

    fn plans() -> MutexGuard<'static, Vec<Plan>> {
        PLANS.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    /// Lets the operation of this place in a folder fail, counted from now on.
    pub fn plan(folder: &Path, first: usize, lasts: bool) {
        plans().push(Plan { folder: folder.to_owned(), first, lasts, seen: Vec::new() });
    }

    /// Ends the faults of a folder; returns the operations that there were.
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
