//! Lossless frames on disk between the two passes of a GIF.

use super::disk::{Operation, attempt};
use super::error::EncodeError;
use super::pattern::FramePattern;
use super::picture::Picture;
use super::png;
use super::temporary::spool;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Frames on disk, by their index in the job's list.
pub enum Store {
    /// The run's own PNG files.
    Own { pattern: FramePattern, frames: Vec<u32> },
    /// A hidden folder, which is removed when this value is dropped.
    Spool { folder: TempDir, _lock: File },
}

impl Store {
    /// Creates a spool folder beside the file `path` of the animation. The system's temporary folder is not used,
    /// because it is often in memory.
    pub fn spool_for(path: &Path) -> Result<Self, EncodeError> {
        let (folder, lock) = spool(path)?;
        Ok(Self::Spool { folder, _lock: lock })
    }

    /// Stores a frame. Does nothing if the run's own files are the store.
    pub fn put(&self, index: usize, picture: &Picture) -> Result<(), EncodeError> {
        match self {
            Self::Own { .. } => Ok(()),
            Self::Spool { .. } => {
                let path = self.path(index);
                let stored = png::encode(picture, &[])
                    .and_then(|bytes| attempt(Operation::Write, &path, || fs::write(&path, bytes)));
                stored.map_err(|e| EncodeError::write(&path, e))
            }
        }
    }

    pub fn get(&self, index: usize) -> Result<Picture, EncodeError> {
        png::read(&self.path(index))
    }

    fn path(&self, index: usize) -> PathBuf {
        match self {
            Self::Own { pattern, frames } => pattern.path(frames[index]),
            Self::Spool { folder, .. } => folder.path().join(format!("{index}.png")),
        }
    }
}
