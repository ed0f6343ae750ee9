//! What an encoder is asked to do, and whether that can be done.

use super::atomic::{NewFolders, folder_of};
use super::error::{EncodeError, JobError};
use super::output::Output;
use super::tonemap::Tonemap;
use crate::time::Rate;
use std::collections::{HashMap, HashSet};
use std::path::PathBuf;

/// How animations are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GifSettings {
    /// How often the animation plays; for ever if absent.
    pub plays: Option<u16>,
    /// Size of the palette, 2..=256.
    pub colors: u16,
    pub dither: bool,
}

impl Default for GifSettings {
    fn default() -> Self {
        Self { plays: None, colors: 256, dither: true }
    }
}

/// What all outputs of one run share.
#[derive(Clone, Debug)]
pub struct Job {
    pub outputs: Vec<Output>,
    /// The frame numbers that will come, in order.
    pub frames: Vec<u32>,
    /// Frames per second at which the frames play, one after the other, whatever their numbers are.
    pub rate: Rate,
    /// Width and height in pixels.
    pub size: (u32, u32),
    pub tonemap: Tonemap,
    pub gif: GifSettings,
}

impl Job {
    /// Finds what contradicts itself, without touching any file.
    pub(super) fn check(&self) -> Result<(), JobError> {
        if self.frames.is_empty() || self.size.0 == 0 || self.size.1 == 0 {
            return Err(JobError::Empty);
        }
        let distinct: HashSet<u32> = self.frames.iter().copied().collect();
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
        self.check_paths(&distinct)
    }

    fn check_paths(&self, frames: &HashSet<u32>) -> Result<(), JobError> {
        let mut owners: HashMap<PathBuf, usize> = HashMap::new();
        let mut sorted: Vec<u32> = frames.iter().copied().collect();
        sorted.sort_unstable();
        for (owner, output) in self.outputs.iter().enumerate() {
            for &frame in &sorted {
                let path = output.path(frame);
                // Tells `a.png` and `./a.png` the same; a path for which that fails stands for itself.
                let key = std::path::absolute(&path).unwrap_or_else(|_| path.clone());
                if *owners.entry(key).or_insert(owner) != owner {
                    return Err(JobError::Duplicate { path });
                }
                if path.is_dir() {
                    return Err(JobError::IsFolder { path });
                }
            }
        }
        Ok(())
    }

    /// Creates the folders that are missing, and proves that all can be written to.
    pub(super) fn prepare_folders(&self) -> Result<NewFolders, EncodeError> {
        let mut folders = NewFolders::default();
        for output in &self.outputs {
            let first = self.frames.first().copied().unwrap_or(0);
            folders.prepare(folder_of(&output.path(first)))?;
        }
        Ok(folders)
    }
}
