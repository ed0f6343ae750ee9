//! Files that appear whole or not at all: written aside in the same folder, then renamed. A link in their place is
//! replaced, and what it leads to stays as it is. Pipes and devices are written into, as they cannot be replaced.

use super::channel;
use super::claim;
use super::disk::{Operation, attempt};
use super::error::EncodeError;
use super::output::prefixed;
use super::place::folder_of;
use crate::base::cancel::Stop;
use crate::base::files::{self, Channel};
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use tempfile::{NamedTempFile, TempDir};

/// A file in the making. Dropped before [`Aside::commit`], it vanishes and the old file stays.
#[must_use]
pub struct Aside {
    path: PathBuf,
    file: BufWriter<Target>,
}

/// What it is written to.
enum Target {
    Temporary(NamedTempFile),
    /// A pipe or a device, at once.
    Channel(PathBuf, File),
}

impl Target {
    fn file(&self) -> (&Path, &File) {
        match self {
            Self::Temporary(file) => (file.path(), file.as_file()),
            Self::Channel(path, file) => (path, file),
        }
    }
}

impl Write for Target {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let (path, mut file) = self.file();
        attempt(Operation::Write, path, || file.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Target {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let (path, mut file) = self.file();
        attempt(Operation::Seek, path, || file.seek(to))
    }
}

impl Aside {
    /// Starts a file that will be `path`, and creates the folders above it. For a pipe, waits until somebody reads it.
    pub fn create(path: &Path) -> Result<Self, EncodeError> {
        Self::create_until(path, &Stop::default())
    }

    /// The same, but that a pipe is not waited for any longer when a stop is asked for.
    pub fn create_until(path: &Path, stop: &Stop) -> Result<Self, EncodeError> {
        let target = match Channel::at(path) {
            Some(channel) => Target::Channel(path.to_owned(), channel::open(path, channel, stop)?),
            None => Target::Temporary(Self::temporary(path)?),
        };
        Ok(Self { path: path.to_path_buf(), file: BufWriter::with_capacity(1 << 16, target) })
    }

    fn temporary(path: &Path) -> Result<NamedTempFile, EncodeError> {
        let folder = folder_of(path);
        let created = attempt(Operation::CreateFolder, folder, || fs::create_dir_all(folder));
        created.map_err(|e| EncodeError::write(folder, e))?;
        let mut builder = tempfile::Builder::new();
        builder.prefix(PREFIX).suffix(".part");
        // A temporary is private by default; what it becomes should be as open as the umask lets it.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let file = attempt(Operation::Create, path, || builder.tempfile_in(folder));
        let file = file.map_err(|e| EncodeError::write(path, e))?;
        mark(file.as_file());
        Ok(file)
    }

    /// A file with these bytes.
    pub fn holding(path: &Path, bytes: &[u8], stop: &Stop) -> Result<Self, EncodeError> {
        let mut aside = Self::create_until(path, stop)?;
        aside.write_all(bytes).map_err(|e| EncodeError::write(path, e))?;
        Ok(aside)
    }

    /// The file will be a part of what it was to be, beside its place; returns where. What has gone into a pipe or a
    /// device is there.
    pub fn divert(&mut self) -> PathBuf {
        if let Target::Temporary(_) = self.file.get_ref() {
            self.path = part_of(&self.path);
        }
        self.path.clone()
    }

    /// Puts the file in its place, once all of it is stored.
    pub fn commit(self) -> Result<(), EncodeError> {
        let Self { path, file } = self;
        let fault = |e| EncodeError::write(&path, e);
        let Target::Temporary(file) = file.into_inner().map_err(|e| fault(e.into_error()))? else {
            return Ok(());
        };
        attempt(Operation::Sync, &path, || file.as_file().sync_data()).map_err(fault)?;
        attempt(Operation::Rename, &path, || file.persist(&path).map_err(|e| e.error)).map_err(fault)?;
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

/// Reads back what was written, after seeking to it.
impl Read for Aside {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let (path, mut file) = self.file.get_ref().file();
        attempt(Operation::Read, path, || file.read(buffer))
    }
}

/// Writes `bytes` as the file `path`, whole or not at all.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), EncodeError> {
    Aside::holding(path, bytes, &Stop::default())?.commit()
}

/// Where a part of the file `path` goes, so that it is not taken for the whole.
pub fn part_of(path: &Path) -> PathBuf {
    prefixed(path, "part_")
}

/// What temporaries of any run are called.
pub const PREFIX: &str = ".kinora-";
/// Temporaries that were touched less than this ago are left alone: someone may be about to lock them.
#[cfg(unix)]
const FRESH: std::time::Duration = std::time::Duration::from_secs(20);

/// Tells other runs that this file is in use. The system forgets it when the process ends, however that happens; and
/// where it cannot lock, temporaries are just never taken for left over.
fn mark(file: &fs::File) {
    #[cfg(unix)]
    let _ = file.try_lock();
    #[cfg(not(unix))]
    let _ = file;
}

/// A hidden folder beside the file `path`, marked as in use for as long as the lock lives.
pub fn spool(path: &Path) -> Result<(TempDir, fs::File), EncodeError> {
    let folder = folder_of(path);
    let fault = |e| EncodeError::write(folder, e);
    let prefix = format!("{PREFIX}spool-");
    let make = || tempfile::Builder::new().prefix(&prefix).tempdir_in(folder);
    let spool = attempt(Operation::CreateFolder, folder, make).map_err(fault)?;
    let lock = spool.path().join(LOCK);
    let lock = attempt(Operation::Create, &lock, || fs::File::create(&lock)).map_err(fault)?;
    mark(&lock);
    Ok((spool, lock))
}

/// The file that marks a spool.
const LOCK: &str = "lock";

/// Removes what killed runs have left in a folder. What a live process has marked stays, and so does whatever cannot
/// be told; nothing of it stops a run.
#[cfg(unix)]
fn sweep(folder: &Path) {
    for entry in folder.read_dir().into_iter().flatten().flatten() {
        let (name, path) = (entry.file_name(), entry.path());
        let name = name.to_string_lossy();
        if claim::is_claim(&name) {
            claim::sweep(&path);
        } else if name.starts_with(PREFIX) {
            // Pipes would be waited for, and links lead elsewhere.
            let Ok(what) = entry.file_type() else { continue };
            let is_spool = what.is_dir();
            if !is_spool && !what.is_file() {
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
fn sweep(_: &Path) {}

#[cfg(unix)]
fn is_left_over(marked: &Path) -> bool {
    let Ok((file, _)) = files::open(marked, u64::MAX) else { return false };
    let age = file.metadata().and_then(|found| found.modified()).ok().and_then(|time| time.elapsed().ok());
    age.is_some_and(|age| age >= FRESH) && file.try_lock().is_ok()
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
            match attempt(Operation::CreateFolder, path, || fs::create_dir(path)) {
                Ok(()) => self.created.push(path.to_path_buf()),
                // `new/..` is there as soon as `new` is; or someone else was faster.
                Err(_) if path.is_dir() => {}
                Err(e) => return Err(EncodeError::write(path, e)),
            }
        }
        let probe = || tempfile::Builder::new().prefix(PREFIX).tempfile_in(folder);
        let probe = attempt(Operation::Create, folder, probe);
        probe.map(drop).map_err(|error| match error.kind() {
            // The folder is there, and takes no files: that does not change.
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
        assert!(message.contains(&*path.to_string_lossy()), "{message}");
        assert_eq!(names(dir.path()), ["taken"]);
    }

    #[cfg(unix)]
    #[test]
    fn what_a_killed_run_left_is_removed_and_what_is_in_use_is_not() {
        let dir = tempfile::tempdir().expect("a folder");
        let old = std::time::SystemTime::now() - 2 * FRESH;
        let aged = |path: &Path| {
            fs::File::options().write(true).open(path).and_then(|file| file.set_modified(old)).expect("aged");
        };
        for name in [".kinora-dead.part", ".kinora-new.part", "mine.part"] {
            fs::write(dir.path().join(name), "").expect("a disk");
        }
        fs::create_dir(dir.path().join(".kinora-spool-dead")).expect("a disk");
        fs::write(dir.path().join(".kinora-spool-dead/lock"), "").expect("a disk");
        for name in [".kinora-dead.part", "mine.part", ".kinora-spool-dead/lock"] {
            aged(&dir.path().join(name));
        }
        let live = Aside::create(&dir.path().join("a.gif")).expect("begun");
        let (live_spool, _lock) = spool(&dir.path().join("a.gif")).expect("begun");
        aged(live.file.get_ref().file().0);
        aged(&live_spool.path().join(LOCK));
        NewFolders::default().prepare(dir.path()).expect("writable");
        let name = |path: &Path| path.file_name().expect("a name").to_string_lossy().into_owned();
        let mut expected =
            vec![".kinora-new.part".to_owned(), "mine.part".to_owned(), name(live.file.get_ref().file().0)];
        expected.push(name(live_spool.path()));
        expected.sort();
        assert_eq!(names(dir.path()), expected);
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
