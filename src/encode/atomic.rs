//! Files that appear whole or not at all: written aside in the same folder, then renamed.

use super::error::EncodeError;
use std::fs;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file in the making. Dropped before [`Aside::commit`], it vanishes and the old file stays.
pub struct Aside {
    path: PathBuf,
    file: BufWriter<NamedTempFile>,
}

impl Aside {
    /// Starts a file that will be `path`; folders above it are created.
    pub fn create(path: &Path) -> Result<Self, EncodeError> {
        let folder = folder_of(path);
        fs::create_dir_all(folder).map_err(|e| EncodeError::write(folder, e))?;
        let mut builder = tempfile::Builder::new();
        builder.prefix(".kinora-").suffix(".part");
        // A temporary is private by default; what it becomes should be as open as the umask lets it.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let file = builder.tempfile_in(folder).map_err(|e| EncodeError::write(path, e))?;
        Ok(Self { path: path.to_path_buf(), file: BufWriter::with_capacity(1 << 16, file) })
    }

    /// Puts the file in its place, once all of it is stored.
    pub fn commit(self) -> Result<(), EncodeError> {
        let Self { path, file } = self;
        let fault = |e| EncodeError::write(&path, e);
        let file = file.into_inner().map_err(|e| fault(e.into_error()))?;
        file.as_file().sync_data().map_err(fault)?;
        file.persist(&path).map_err(|e| fault(e.error))?;
        Ok(())
    }
}

impl Write for Aside {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for Aside {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// Writes `bytes` as the file `path`, whole or not at all.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), EncodeError> {
    let mut aside = Aside::create(path)?;
    aside.write_all(bytes).map_err(|e| EncodeError::write(path, e))?;
    aside.commit()
}

/// The folder that holds `path`; the working directory if it names none.
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Folders created for a run that may still come to nothing. Dropped before [`NewFolders::keep`], it
/// removes those of them that are empty.
#[derive(Debug, Default)]
pub struct NewFolders {
    created: Vec<PathBuf>,
}

impl NewFolders {
    /// Creates `folder` with all above it, and proves that files can be made in it.
    pub fn prepare(&mut self, folder: &Path) -> Result<(), EncodeError> {
        let missing = folder.ancestors().take_while(|path| !path.as_os_str().is_empty() && !path.exists());
        for path in missing.collect::<Vec<_>>().into_iter().rev() {
            match fs::create_dir(path) {
                Ok(()) => self.created.push(path.to_path_buf()),
                // `new/..` is there as soon as `new` is; or someone else was faster.
                Err(_) if path.is_dir() => {}
                Err(e) => return Err(EncodeError::write(path, e)),
            }
        }
        let probe = tempfile::Builder::new().prefix(".kinora-").tempfile_in(folder);
        probe.map(drop).map_err(|e| EncodeError::write(folder, e))
    }

    pub fn keep(&mut self) {
        self.created.clear();
    }
}

impl Drop for NewFolders {
    fn drop(&mut self) {
        for folder in self.created.drain(..).rev() {
            // Folders that hold something are not removed, and that is right.
            let _ = fs::remove_dir(folder);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("a folder");
        let mut names: Vec<_> =
            entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_appears_whole_with_its_folders() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("a/b/c.bin");
        write(&path, b"old").expect("written");
        write(&path, b"new").expect("replaced");
        assert_eq!(fs::read(&path).expect("read"), b"new");
        assert_eq!(names(&dir.path().join("a/b")), ["c.bin"]);
    }

    #[test]
    fn what_is_not_committed_leaves_the_old_file_and_no_trace() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("c.bin");
        write(&path, b"old").expect("written");
        let mut aside = Aside::create(&path).expect("begun");
        aside.write_all(&[1; 100_000]).expect("buffered");
        assert_eq!(names(dir.path()).len(), 2);
        drop(aside);
        assert_eq!(names(dir.path()), ["c.bin"]);
        assert_eq!(fs::read(&path).expect("read"), b"old");
    }

    #[test]
    fn an_error_names_the_path_and_leaves_no_trace() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("taken");
        fs::create_dir_all(path.join("inside")).expect("a folder");
        let message = write(&path, b"new").expect_err("a folder stands there").to_string();
        assert!(message.contains(&path.display().to_string()), "{message}");
        assert_eq!(names(dir.path()), ["taken"]);
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
