//! Finds the frames of an earlier run that need not be made again.

use super::file_state::FileState;
use super::job::{EncodeJob, Existing};
use super::metadata::{StoredTextEntry, find_sample_counts};
use super::output::{Output, StillFormat};
use super::pattern::FramePattern;
use super::{exr, png};
use crate::base::cancel::Stop;
use crate::base::files::SpecialFile;
use crate::base::frame_set;
use crate::base::units::counted;
use rayon::ThreadPool;
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The frames of a job that need not be made again.
#[derive(Debug, Default)]
pub struct KeptFrames {
    /// For each frame in the job's list, whether it needs no film.
    pub frames: Vec<bool>,
    /// Which of these are drawn again, because only their annotations differ.
    pub redrawn: Vec<bool>,
    /// Why other existing files are not kept, one line each.
    pub notes: Vec<String>,
}

/// Bytes of files that are read at the same time, unless a single file is larger.
const MEMORY: u64 = 1 << 28;

impl EncodeJob {
    /// The stills from which all other formats of a frame can be made: PNGs of 8 bits per channel.
    pub(super) fn source(&self) -> Option<&FramePattern> {
        let plain = StillFormat::Png.has_identity(&self.formats) && !self.formats.png.deep;
        self.outputs.iter().find_map(|output| match output {
            Output::Stills(StillFormat::Png, pattern) if plain => Some(pattern),
            _ => None,
        })
    }

    /// Whether a later run can keep frames: their files hold an identity, and files without one can be made from them.
    pub fn can_keep_frames(&self) -> bool {
        let identified = |output: &Output| self.has_identity(output);
        self.outputs.iter().any(identified)
            && (self.outputs.iter().all(identified) || self.source().is_some())
    }

    /// Checks all existing files on the threads of `pool`. After a stop request, the remaining files count as stale.
    pub(super) fn find_kept(&self, pool: &ThreadPool, stop: &Stop) -> KeptFrames {
        let none = vec![false; self.frames.len()];
        if !matches!(self.existing, Existing::Keep | Existing::Share) {
            return KeptFrames { frames: none, ..KeptFrames::default() };
        }
        if !self.can_keep_frames() {
            return KeptFrames { frames: none, notes: self.why_none_kept(), ..KeptFrames::default() };
        }
        let redraws = self.existing == Existing::Keep;
        let state = |index: usize| match stop.signal() {
            None => match self.frame_state(index) {
                FileState::Stale if redraws && self.can_redraw(index) => FileState::Redrawable,
                state => state,
            },
            Some(_) => FileState::Stale,
        };
        // The size of a file, at most.
        let bytes = u64::from(self.size.0) * u64::from(self.size.1) * 32;
        let states: Vec<FileState> = if bytes.saturating_mul(pool.current_num_threads() as u64) <= MEMORY {
            pool.install(|| (0..self.frames.len()).into_par_iter().map(state).collect())
        } else {
            (0..self.frames.len()).map(state).collect()
        };
        let no_digest = states.iter().filter(|state| **state == FileState::NoDigest).count() as u64;
        let note = (no_digest > 0).then(|| {
            let frames = counted(no_digest, "frame");
            format!("{frames} of an earlier version hold no digest of their pixels and are made again")
        });
        KeptFrames {
            frames: states
                .iter()
                .map(|state| matches!(state, FileState::Current | FileState::Redrawable))
                .collect(),
            redrawn: states.iter().map(|state| *state == FileState::Redrawable).collect(),
            notes: note.into_iter().collect(),
        }
    }

    /// Whether any frame is complete and current.
    pub fn can_keep_any(&self) -> bool {
        self.can_keep_frames()
            && (0..self.frames.len()).any(|index| self.can_keep_frame(index) || self.can_redraw(index))
    }

    /// The metadata in each of a frame's files.
    pub(super) fn stored_metadata(&self, frame: u32) -> impl Iterator<Item = Vec<StoredTextEntry>> {
        self.outputs.iter().filter_map(move |output| match output {
            Output::Stills(StillFormat::Png, pattern) => Some(png::texts(&pattern.path(frame))),
            Output::Stills(StillFormat::Exr, pattern) => Some(exr::texts(&pattern.path(frame))),
            _ => None,
        })
    }

    /// The numbers of samples that this job's time limit led to for existing frames: random samples per pixel, and
    /// samples along each side of a pixel's grid. The most frequent pair comes first.
    pub fn earlier_sample_counts(&self) -> Vec<(u32, u32)> {
        let Some(limit) = &self.info.time_limit else { return Vec::new() };
        let mut found: BTreeMap<(u32, u32), usize> = BTreeMap::new();
        for &frame in &self.frames {
            for counts in
                self.stored_metadata(frame).filter_map(|entries| find_sample_counts(&entries, limit))
            {
                *found.entry(counts).or_default() += 1;
            }
        }
        let mut all: Vec<_> = found.into_iter().collect();
        all.sort_by_key(|(_, frames)| Reverse(*frames));
        all.into_iter().map(|(counts, _)| counts).collect()
    }

    /// Whether a frame is complete and current, by its index in the job's list.
    pub(super) fn can_keep_frame(&self, index: usize) -> bool {
        self.frame_state(index) == FileState::Current
    }

    /// The state of a frame: that of its worst file.
    fn frame_state(&self, index: usize) -> FileState {
        let of = |output: &Output| self.file_state(output, index);
        self.outputs.iter().map(of).max().unwrap_or(FileState::Current)
    }

    /// Whether an output's file of a frame is complete and current.
    pub(super) fn is_current(&self, output: &Output, index: usize) -> bool {
        self.file_state(output, index) == FileState::Current
    }

    fn file_state(&self, output: &Output, index: usize) -> FileState {
        let Output::Stills(format, pattern) = output else { return FileState::Current };
        let path = pattern.path(self.frames[index]);
        match (format, self.identity(*format, index)) {
            (StillFormat::Png, Some(identity)) => png::state(&path, identity, self.size),
            (StillFormat::Exr, Some(identity)) => {
                exr::state(&path, identity, self.size, self.info.layers.len())
            }
            // Files without an identity are made again from the others.
            _ if format.has_identity(&self.formats) => FileState::Stale,
            _ => FileState::Current,
        }
    }

    /// Notes about files of frames beyond the end of the sequence.
    pub fn extra_frame_notes(&self) -> Vec<String> {
        let count = self.info.frames;
        let note = |output: &Output| {
            let there = output.pattern().filter(|pattern| pattern.has_placeholder())?.numbers().ok()?;
            let beyond = &there[there.partition_point(|number| *number < count)..];
            (!beyond.is_empty()).then(|| {
                format!(
                    "{output}: frames {} exist, but the sequence has {}; they are left as they are",
                    frame_set::text(beyond),
                    counted(count.into(), "frame")
                )
            })
        };
        self.outputs.iter().filter(|_| count > 0).filter_map(note).collect()
    }

    /// Notes about existing files if none of them can be kept.
    fn why_none_kept(&self) -> Vec<String> {
        let mut frames = self.frames.clone();
        frames.sort_unstable();
        let stills = self.outputs.iter().filter(|output| !output.is_animation());
        // A pipe or a device is not a frame of an earlier run.
        let is_file = |path: &PathBuf| SpecialFile::at(path).is_none();
        let there: Vec<&Output> =
            stills.filter(|output| output.existing_files(&frames).iter().any(is_file)).collect();
        let identified = there.iter().any(|output| self.has_identity(output));
        let reason = match there.first() {
            None => return Vec::new(),
            Some(_) if identified => {
                "other outputs are made from PNGs of 8 bits, and no output is such a PNG".to_owned()
            }
            Some(Output::Stills(StillFormat::Png, _)) => {
                "PNGs without metadata do not identify their frames".to_owned()
            }
            Some(output) => format!("{output} cannot hold metadata that identifies its frame"),
        };
        vec![format!("no existing frame could be kept: {reason}")]
    }
}
