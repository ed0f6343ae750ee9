//! Atomic file writes: a file is written under a temporary name in the same folder, then renamed into place. It appears
//! complete or not at all. If a link has the file's name, the link is replaced and its target stays as it is. Pipes and
//! devices cannot be replaced, so they are written directly.

use super::channel;
use super::disk::{Operation, attempt};
use super::error::EncodeError;
use super::output::prefixed;
use super::place::folder_of;
use super::temporary;
use crate::base::cancel::Stop;
use crate::base::files::SpecialFile;
use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file that is being written. If it is dropped before [`AtomicFile::commit`], it is removed and an older file of the
/// same name stays.
#[must_use]
pub struct AtomicFile {
    path: PathBuf,
    file: BufWriter<Target>,
}

/// Where the bytes go.
enum Target {
    Temporary(NamedTempFile),
    /// A pipe or a device, written directly.
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

impl AtomicFile {
    /// Starts the file `path` and creates missing parent folders. If the path is a pipe, waits for its reader.
    pub fn create(path: &Path) -> Result<Self, EncodeError> {
        Self::create_until(path, &Stop::default())
    }

    /// Like [`AtomicFile::create`], but stops waiting for a pipe's reader when `stop` is requested.
    pub fn create_until(path: &Path, stop: &Stop) -> Result<Self, EncodeError> {
        let target = match SpecialFile::at(path) {
            Some(channel) => Target::Channel(path.to_owned(), channel::open(path, channel, stop)?),
            None => Target::Temporary(Self::temporary(path)?),
        };
        Ok(Self { path: path.to_path_buf(), file: BufWriter::with_capacity(1 << 16, target) })
    }

    fn temporary(path: &Path) -> Result<NamedTempFile, EncodeError> {
        let folder = folder_of(path);
        let created = attempt(Operation::CreateFolder, folder, || fs::create_dir_all(folder));
        created.map_err(|e| EncodeError::write(folder, e))?;
        #[cfg_attr(not(unix), expect(unused_mut, reason = "only Unix has permissions to change"))]
        let mut builder = temporary::builder();
        // Temporary files are private by default. The finished file should have the permissions that the umask allows.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let file = attempt(Operation::Create, path, || builder.tempfile_in(folder));
        let file = file.map_err(|e| EncodeError::write(path, e))?;
        temporary::mark(file.as_file());
        Ok(file)
    }

    /// Starts a file and writes these bytes to it.
    pub fn with_bytes(path: &Path, bytes: &[u8], stop: &Stop) -> Result<Self, EncodeError> {
        let mut file = Self::create_until(path, stop)?;
        file.write_all(bytes).map_err(|e| EncodeError::write(path, e))?;
        Ok(file)
    }

    /// Like [`AtomicFile::with_bytes`], for the result of an encoder.
    pub fn with_encoded(path: &Path, bytes: io::Result<Vec<u8>>, stop: &Stop) -> Result<Self, EncodeError> {
        let bytes = bytes.map_err(|error| EncodeError::write(path, error))?;
        Self::with_bytes(path, &bytes, stop)
    }

    /// Renames the file to be, because it will hold only a part of the animation; returns the new path. Pipes and
    /// devices keep their path, because earlier bytes have reached them already.
    pub fn divert(&mut self) -> PathBuf {
        if let Target::Temporary(_) = self.file.get_ref() {
            self.path = part_of(&self.path);
        }
        self.path.clone()
    }

    /// Syncs the file to disk and renames it into place.
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

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for AtomicFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// Reads written bytes back. Seek first: the seek flushes the buffer.
impl Read for AtomicFile {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let (path, mut file) = self.file.get_ref().file();
        attempt(Operation::Read, path, || file.read(buffer))
    }
}

/// Writes `bytes` to the file `path`, completely or not at all.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), EncodeError> {
    AtomicFile::with_bytes(path, bytes, &Stop::default())?.commit()
}

/// The path of an incomplete version of the file `path`, whose name says so.
pub fn part_of(path: &Path) -> PathBuf {
    prefixed(path, "part_")
}

#[cfg(test)]
mod tests {
    use super::*;
    #[cfg(unix)]
    use crate::encode::leftovers::FRESH;
    #[cfg(unix)]
    use crate::encode::new_folders::NewFolders;
    #[cfg(unix)]
    use crate::encode::temporary::{LOCK, spool};

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
    fn uncommitted_files_leave_the_old_file() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("c.bin");
        write(&path, b"old").expect("written");
        let mut file = AtomicFile::create(&path).expect("begun");
        file.write_all(&[1; 100_000]).expect("buffered");
        assert_eq!(names(dir.path()).len(), 2);
        drop(file);
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
    fn only_stale_temporary_files_are_removed() {
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
        let live = AtomicFile::create(&dir.path().join("a.gif")).expect("begun");
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
}
