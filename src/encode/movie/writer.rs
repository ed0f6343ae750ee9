//! The interface of animations that are written frame by frame.

use crate::encode::error::EncodeError;
use crate::encode::picture::Picture;
use std::path::PathBuf;

/// An animation that is being written. Its file appears when it is finished, and not at all if it is dropped before.
pub trait MovieWriter: Send {
    /// Adds the job's next frame.
    fn push(&mut self, picture: &Picture) -> Result<(), EncodeError>;

    /// Processor time that other threads have spent on this animation so far, in seconds.
    fn cpu(&self) -> f64 {
        0.0
    }

    /// Writes the remaining frames and commits the file.
    fn finish(self: Box<Self>) -> Result<(), EncodeError>;

    /// Renames the file to be, because it will hold only a part of the animation. Returns the new path, if it is a
    /// file.
    fn divert(&mut self) -> Option<PathBuf>;

    /// Closes the animation with the frames so far, as `part_NAME`. Returns the path, if it is a file.
    fn stop(mut self: Box<Self>) -> Result<Option<PathBuf>, EncodeError> {
        let path = self.divert();
        self.finish().map(|()| path)
    }
}
