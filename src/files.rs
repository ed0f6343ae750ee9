//! Files that are read: plain ones, up to a size.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

/// Why nothing can be read from where no file is.
pub const NO_FILE: &str = "there is no such file";

/// Opens a plain file of at most `most` bytes, and tells its size. What has no end, such as a device, and what
/// may wait for ever, such as a pipe, is refused before it is opened.
pub fn open(path: &Path, most: u64) -> io::Result<(File, u64)> {
    let what = fs::metadata(path)?;
    if what.is_dir() {
        // What reading one says differs between systems.
        return Err(ErrorKind::IsADirectory.into());
    }
    if !what.is_file() {
        return Err(io::Error::new(ErrorKind::InvalidInput, "it is no plain file, but a device or a pipe"));
    }
    if what.len() > most {
        return Err(too_large(most));
    }
    Ok((File::open(path)?, what.len()))
}

/// All bytes of a plain file, if those are at most `most`.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    read_at_most(open(path, most)?.0, most)
}

/// All bytes of anything, if those are at most `most`: also of what does not tell its size, or grows meanwhile.
pub fn read_at_most(input: impl Read, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    // One byte more than allowed tells what is too large.
    input.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(too_large(most)) } else { Ok(bytes) }
}

fn too_large(most: u64) -> io::Error {
    let most = match most >> 20 {
        mebibytes if mebibytes.is_multiple_of(1024) => format!("{} GiB", mebibytes >> 10),
        mebibytes => format!("{mebibytes} MiB"),
    };
    io::Error::new(ErrorKind::FileTooLarge, format!("it is larger than {most}"))
}

/// The one name among the many of a file. What does not exist keeps the name that it has.
pub fn one_name(path: PathBuf) -> PathBuf {
    path.canonicalize().unwrap_or(path)
}

/// What is wrong, the commonest in words that are the same on every system.
pub fn why(error: &io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => NO_FILE.to_owned(),
        ErrorKind::PermissionDenied => "it may not be read".to_owned(),
        ErrorKind::IsADirectory => "it is a folder".to_owned(),
        _ => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_plain_files_up_to_a_size_are_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("file");
        let told = |path: &Path| why(&read(path, 1 << 20).expect_err("not to be read"));
        assert_eq!(told(&path), "there is no such file");
        assert_eq!(told(folder.path()), "it is a folder");
        fs::write(&path, vec![7; 1 << 20]).expect("a disk");
        assert_eq!(read(&path, 1 << 20).expect("a plain file").len(), 1 << 20);
        fs::write(&path, vec![7; (1 << 20) + 1]).expect("a disk");
        assert_eq!(told(&path), "it is larger than 1 MiB");
    }

    #[test]
    fn what_does_not_tell_its_size_is_measured() {
        assert_eq!(read_at_most(&b"abc"[..], 3).expect("short enough"), b"abc");
        let error = read_at_most(io::repeat(0), 3 << 20).expect_err("endless");
        assert_eq!(why(&error), "it is larger than 3 MiB");
    }

    #[cfg(unix)]
    #[test]
    fn devices_are_refused() {
        let error = read(Path::new("/dev/zero"), 1 << 20).expect_err("endless");
        assert_eq!(why(&error), "it is no plain file, but a device or a pipe");
    }
}
