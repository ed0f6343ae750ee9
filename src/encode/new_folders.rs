//! Folders that a run creates for its outputs.

use super::disk::{Operation, attempt};
use super::error::EncodeError;
use super::leftovers::sweep;
use super::temporary::PREFIX;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The folders that a run has created. If it is dropped before [`NewFolders::keep`], those that are empty are removed.
#[derive(Debug, Default)]
pub struct NewFolders {
    created: Vec<PathBuf>,
}

impl NewFolders {
    /// Creates `folder` and its missing parents, and tests that files can be created in it. Leftovers of killed runs
    /// are removed from it.
    pub fn prepare(&mut self, folder: &Path) -> Result<(), EncodeError> {
        let missing = folder.ancestors().take_while(|path| !path.as_os_str().is_empty() && !path.exists());
        for path in missing.collect::<Vec<_>>().into_iter().rev() {
            match attempt(Operation::CreateFolder, path, || fs::create_dir(path)) {
                Ok(()) => self.created.push(path.to_path_buf()),
                // `new/..` exists as soon as `new` does, or another process has created the folder meanwhile.
                Err(_) if path.is_dir() => {}
                Err(e) => return Err(EncodeError::write(path, e)),
            }
        }
        let probe = || tempfile::Builder::new().prefix(PREFIX).tempfile_in(folder);
        let probe = attempt(Operation::Create, folder, probe);
        probe.map(drop).map_err(|error| match error.kind() {
            // The folder exists, but its file system takes no files; that will not change.
            ErrorKind::NotFound if folder.is_dir() => EncodeError::no_files(folder, &error),
            _ => EncodeError::write(folder, error),
        })?;
        sweep(folder);
        Ok(())
    }

    pub fn keep(&mut self) {
        self.created.clear();
    }
}

impl Drop for NewFolders {
    fn drop(&mut self) {
        for folder in self.created.drain(..).rev() {
            // This fails for folders that hold something, and they should stay.
            let _ = fs::remove_dir(folder);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encode::atomic::write;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("a folder").flatten();
        let mut names: Vec<_> =
            entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    #[test]
    fn new_folders_vanish_unless_kept_or_used() {
        let dir = tempfile::tempdir().expect("a folder");
        let mut folders = NewFolders::default();
        folders.prepare(&dir.path().join("a/b")).expect("writable");
        folders.prepare(&dir.path().join("c")).expect("writable");
        write(&dir.path().join("c/file"), b"").expect("written");
        drop(folders);
        assert_eq!(names(dir.path()), ["c"]);
        let mut folders = NewFolders::default();
        folders.prepare(&dir.path().join("a/b")).expect("writable");
        folders.keep();
        drop(folders);
        assert_eq!(names(dir.path()), ["a", "c"]);
    }
}
