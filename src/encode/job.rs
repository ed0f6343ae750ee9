//! A job of the encoder, and the checks that it can be done.

use super::error::{EncodeError, JobError};
use super::frame_key::FrameKey;
use super::info::{FrameInfo, SequenceInfo};
use super::limits::check_size;
use super::new_folders::NewFolders;
use super::output::Output;
use super::pattern::FramePattern;
use super::picture::{Code, Picture};
use super::place::folder_of;
use super::settings::Formats;
use super::tonemap::Tonemap;
use crate::base::color::Rgb;
use crate::base::files::{SpecialFile, blocking_file, outside_target};
use crate::base::time::Rate;
use crate::drawing::Drawing;
use std::path::Path;
use std::sync::Arc;

/// How a run treats the files of an earlier run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[warn(missing_docs)]
pub enum Existing {
    /// Keep frames that are complete and current. Make all others and replace their files.
    #[default]
    Keep,
    /// Make all frames and replace all files.
    Replace,
    /// Fail if a file exists.
    Refuse,
    /// Like [`Existing::Keep`], but other processes make frames of the same job, so each film is leased first. Frames
    /// must be in ascending order, and all outputs must be stills that hold their identity.
    Share,
}

/// The outputs of one run, and what they share.
#[derive(Clone, Debug)]
pub struct EncodeJob {
    pub outputs: Vec<Output>,
    /// Whether outputs must stay within the working directory, links included. This holds for outputs that a sequence
    /// names, because the sequence may come from somebody else.
    pub confined: bool,
    /// How existing files are treated.
    pub existing: Existing,
    /// The numbers of the frames, in the order in which their films are pushed.
    pub frames: Vec<u32>,
    /// The key of each frame, by which files are identified. Empty if the keys are unknown.
    pub frame_keys: Vec<FrameKey>,
    /// Frames per second. The frames play one after the other, whatever their numbers are.
    pub rate: Rate,
    /// Width and height in pixels.
    pub size: (u32, u32),
    pub tonemap: Tonemap,
    /// Whether films record coverage, so that pictures have alpha.
    pub transparent: bool,
    /// The background colour of formats without alpha where the film is transparent; linear.
    pub background_color: Rgb,
    /// What is drawn over each frame. Empty if there are no annotations.
    pub drawings: Vec<Arc<Drawing>>,
    pub formats: Formats,
    pub info: SequenceInfo,
}

impl EncodeJob {
    /// What is drawn over the frame of an index, unless it is nothing.
    pub(super) fn drawing(&self, index: usize) -> Option<&Drawing> {
        self.drawings.get(index).map(Arc::as_ref).filter(|drawing| !drawing.is_empty())
    }

    /// Facts about the frame of an index.
    pub(super) fn frame_info(&self, index: usize) -> FrameInfo<'_> {
        FrameInfo { sequence: &self.info, frame: self.frames[index], rate: self.rate }
    }

    /// Whether anything is drawn over the frame of an index.
    pub(super) fn is_annotated(&self, index: usize) -> bool {
        self.drawing(index).is_some()
    }

    /// Draws the annotations of the frame of an index.
    pub(super) fn annotate<C: Code>(&self, index: usize, picture: &mut Picture<C>) {
        if let Some(drawing) = self.drawing(index) {
            drawing.draw(picture);
        }
    }

    /// Checks the job without changing any file.
    ///
    /// # Errors
    /// Sizes that a format cannot hold, several outputs for one file, files that must not be replaced, formats that
    /// pipes and devices cannot take, and paths that must not be written.
    pub fn check(&self) -> Result<(), JobError> {
        if self.frames.is_empty() || self.size.0 == 0 || self.size.1 == 0 {
            return Err(JobError::Empty);
        }
        let mut distinct = self.frames.clone();
        distinct.sort_unstable();
        distinct.dedup();
        for output in &self.outputs {
            if let Some(pattern) = output.pattern()
                && output.needs_placeholder(distinct.len())
            {
                return Err(JobError::NoPlaceholder {
                    output: output.to_string(),
                    frames: distinct.len(),
                    suggestion: pattern.suggestion(),
                });
            }
        }
        self.outputs.iter().try_for_each(|output| check_size(output, self.first(), self.size))?;
        self.check_names(&distinct)?;
        self.check_shared()?;
        self.outputs.iter().try_for_each(|output| self.check_place(output, &distinct))
    }

    /// Processes can share outputs only if the files hold their identity. Otherwise no process knows which frames
    /// another one has made.
    fn check_shared(&self) -> Result<(), JobError> {
        let unidentified = self.outputs.iter().find(|output| !self.has_identity(output));
        match unidentified.filter(|_| self.existing == Existing::Share) {
            Some(output) => Err(JobError::NotShared { output: output.to_string() }),
            None => Ok(()),
        }
    }

    /// Whether an output's files hold the identity of their frames.
    pub(super) fn has_identity(&self, output: &Output) -> bool {
        matches!(output, Output::Stills(format, _) if format.has_identity(&self.formats))
    }

    fn first(&self) -> u32 {
        self.frames.first().copied().unwrap_or(0)
    }

    /// Refuses two outputs that write the same file.
    fn check_names(&self, frames: &[u32]) -> Result<(), JobError> {
        for (place, output) in self.outputs.iter().enumerate() {
            for other in &self.outputs[..place] {
                if let Some(path) = output.shared_with(other, frames) {
                    return Err(JobError::Duplicate { path });
                }
            }
        }
        Ok(())
    }

    /// Refuses paths where a folder blocks a file or a file blocks a folder, and files that must not be replaced.
    fn check_place(&self, output: &Output, frames: &[u32]) -> Result<(), JobError> {
        if output.is_stream() {
            return Ok(());
        }
        check_folder(&output.path(self.first()))?;
        if self.confined {
            check_within(&output.path(self.first()))?;
        }
        for path in output.existing_files(frames) {
            if path.is_dir() {
                return Err(JobError::IsFolder { path });
            }
            if let Some(channel) = SpecialFile::at(&path) {
                // It is written in place, so the target of a link has to be checked too.
                check_channel(output, &path, channel)?;
                if self.confined {
                    check_within(&path)?;
                }
            } else if self.existing == Existing::Refuse {
                return Err(JobError::Exists { path });
            }
        }
        Ok(())
    }

    /// Creates missing folders and tests that all folders are writable.
    pub(super) fn prepare_folders(&self) -> Result<NewFolders, EncodeError> {
        let mut folders = NewFolders::default();
        let files = self.outputs.iter().filter(|output| !output.is_stream());
        for output in files {
            let path = output.path(self.first());
            let numbered = output.pattern().is_some_and(FramePattern::has_placeholder);
            // If the output is a pipe or a device, its folder need not be writable.
            if numbered || SpecialFile::at(&path).is_none() {
                folders.prepare(folder_of(&path))?;
            }
        }
        Ok(folders)
    }
}

/// Refuses sockets, and formats that cannot be written sequentially to a pipe or a device.
fn check_channel(output: &Output, path: &Path, channel: SpecialFile) -> Result<(), JobError> {
    if channel != SpecialFile::Socket && output.is_sequential() {
        return Ok(());
    }
    Err(JobError::Channel { path: path.to_owned(), channel })
}

/// Refuses a path that leads out of the working directory.
pub fn check_within(path: &Path) -> Result<(), JobError> {
    outside_target(path).map_or(Ok(()), |to| Err(JobError::Leaves { path: path.to_owned(), to }))
}

/// Refuses a path that has a file where a folder should be.
fn check_folder(path: &Path) -> Result<(), JobError> {
    blocking_file(folder_of(path))
        .map_or(Ok(()), |file| Err(JobError::IsFile { path: path.to_owned(), file: file.to_owned() }))
}

/// Tests that a single picture can be written, and creates its folders. New folders that are still empty are removed
/// when the result is dropped.
pub fn prepare_picture(output: &Output) -> Result<NewFolders, EncodeError> {
    let path = output.path(0);
    check_folder(&path)?;
    if path.is_dir() {
        return Err(JobError::IsFolder { path }.into());
    }
    let mut folders = NewFolders::default();
    if let Some(channel) = SpecialFile::at(&path) {
        check_channel(output, &path, channel)?;
        return Ok(folders);
    }
    folders.prepare(folder_of(&path))?;
    Ok(folders)
}
