//! What an encoder is asked to do, and whether that can be done.

use super::about::About;
use super::atomic::NewFolders;
use super::caption::Caption;
use super::error::{EncodeError, JobError};
use super::identity::Seen;
use super::movie::{mp4, webp};
use super::output::{Moving, Output, Still};
use super::pattern::FramePattern;
use super::place::folder_of;
use super::settings::Formats;
use super::tonemap::Tonemap;
use super::{gif, jpeg};
use crate::base::color::Rgb;
use crate::base::files::{Channel, in_the_way, leaves};
use crate::base::time::Rate;
use std::path::Path;

/// What becomes of files of an earlier run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Existing {
    /// Frames that are there, whole and as they would be made now, are kept; all else is made, and replaced.
    #[default]
    Keep,
    /// All is made anew, and replaced.
    Replace,
    /// Nothing is made if a file is there.
    Refuse,
    /// As [`Existing::Keep`], while other processes make frames of the same job: each is claimed first. Frames must be
    /// in rising order, and all outputs stills that say what they show.
    Share,
}

/// What all outputs of one run share.
#[derive(Clone, Debug)]
pub struct Job {
    pub outputs: Vec<Output>,
    /// Whether outputs stay within the working directory, wherever links lead: those do that a sequence names, which may
    /// come from others.
    pub confined: bool,
    /// What is done about files that are there already.
    pub existing: Existing,
    /// The frame numbers that will come, in order.
    pub frames: Vec<u32>,
    /// What each of them looks like, to find and name those that are there; nothing if nobody has looked.
    pub seen: Vec<Seen>,
    /// Frames per second at which the frames play, one after the other, whatever their numbers are.
    pub rate: Rate,
    /// Width and height in pixels.
    pub size: (u32, u32),
    pub tonemap: Tonemap,
    /// Whether films tell what hides the background, so that pictures have alpha.
    pub transparent: bool,
    /// What pictures without alpha show where the background is left out.
    pub matte: Rgb,
    /// What is written into every picture.
    pub caption: Option<Caption>,
    pub formats: Formats,
    pub about: About,
}

impl Job {
    /// Finds what contradicts itself, without touching any file.
    ///
    /// # Errors
    /// Sizes that a format does not have, several outputs for one file, files that may not be replaced, pipes and devices
    /// that do not take a format, and places that may not be written to.
    pub fn check(&self) -> Result<(), JobError> {
        if self.frames.is_empty() || self.size.0 == 0 || self.size.1 == 0 {
            return Err(JobError::Empty);
        }
        let mut distinct = self.frames.clone();
        distinct.sort_unstable();
        distinct.dedup();
        for output in &self.outputs {
            if let Some(pattern) = output.pattern()
                && output.needs_place(distinct.len())
            {
                return Err(JobError::NoPlace {
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

    /// Only what says what it shows can be told from what another process has not made yet.
    fn check_shared(&self) -> Result<(), JobError> {
        let silent = self.outputs.iter().find(|output| !self.is_said(output));
        match silent.filter(|_| self.existing == Existing::Share) {
            Some(output) => Err(JobError::NotShared { output: output.to_string() }),
            None => Ok(()),
        }
    }

    fn first(&self) -> u32 {
        self.frames.first().copied().unwrap_or(0)
    }

    /// No file may be written by two outputs.
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

    /// No folder may stand where a file goes, and no file where a folder is or none is to be replaced.
    fn check_place(&self, output: &Output, frames: &[u32]) -> Result<(), JobError> {
        if output.is_stream() {
            return Ok(());
        }
        check_folder(&output.path(self.first()))?;
        if self.confined {
            check_within(&output.path(self.first()))?;
        }
        for path in output.present(frames) {
            if path.is_dir() {
                return Err(JobError::IsFolder { path });
            }
            if let Some(channel) = Channel::at(&path) {
                // It is not replaced, nor does its folder say where a link leads.
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

    /// Creates the folders that are missing, and proves that all can be written to.
    pub(super) fn prepare_folders(&self) -> Result<NewFolders, EncodeError> {
        let mut folders = NewFolders::default();
        let files = self.outputs.iter().filter(|output| !output.is_stream());
        for output in files {
            let path = output.path(self.first());
            let numbered = output.pattern().is_some_and(FramePattern::has_place);
            // Where nothing but a pipe or a device is written into, its folder need not take files.
            if numbered || Channel::at(&path).is_none() {
                folders.prepare(folder_of(&path))?;
            }
        }
        Ok(folders)
    }
}

/// A pipe or a device takes what is written from its beginning to its end.
fn check_channel(output: &Output, path: &Path, channel: Channel) -> Result<(), JobError> {
    if channel != Channel::Socket && output.is_sequential() {
        return Ok(());
    }
    Err(JobError::Channel { path: path.to_owned(), channel })
}

/// What a sequence names may not lead out of the working directory.
pub fn check_within(path: &Path) -> Result<(), JobError> {
    leaves(path).map_or(Ok(()), |to| Err(JobError::Leaves { path: path.to_owned(), to }))
}

/// No file may stand where the path has a folder.
fn check_folder(path: &Path) -> Result<(), JobError> {
    in_the_way(folder_of(path))
        .map_or(Ok(()), |file| Err(JobError::IsFile { path: path.to_owned(), file: file.to_owned() }))
}

/// Proves that a single picture can be written. Folders that are made for it go with the result, unless something is in
/// them by then.
pub fn prepare_picture(output: &Output) -> Result<NewFolders, EncodeError> {
    let path = output.path(0);
    check_folder(&path)?;
    if path.is_dir() {
        return Err(JobError::IsFolder { path }.into());
    }
    let mut folders = NewFolders::default();
    if let Some(channel) = Channel::at(&path) {
        check_channel(output, &path, channel)?;
        return Ok(folders);
    }
    folders.prepare(folder_of(&path))?;
    Ok(folders)
}

/// Refuses pictures that are larger than an output's format takes; `frame` is the first of them.
pub fn check_size(output: &Output, frame: u32, size: (u32, u32)) -> Result<(), JobError> {
    let limit = match output {
        Output::Stills(Still::Jpeg, _) => jpeg::limit(size),
        Output::Movie(Moving::Gif, _) => gif::limit(size),
        Output::Movie(Moving::Webp, _) => webp::limit(size),
        Output::Movie(Moving::Mp4, _) => mp4::limit(size),
        _ => None,
    };
    limit.map_or(Ok(()), |limit| Err(JobError::TooLarge { path: output.path(frame), size, limit }))
}
