//! Frames of an earlier run that need not be made again.

use super::job::{Existing, Job};
use super::output::{Output, Still};
use super::pattern::FramePattern;
use super::record::{self, Told};
use super::{exr, png};
use crate::base::cancel::Stop;
use crate::base::files::Channel;
use crate::base::frame_set;
use crate::base::units::counted;
use rayon::ThreadPool;
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// What there is of a job.
#[derive(Debug, Default)]
pub struct Kept {
    /// Of each frame in the job's list, whether its files are there, whole and as they would be made now.
    pub frames: Vec<bool>,
    /// Why files that are there are not kept, a line each.
    pub notes: Vec<String>,
}

/// What there is of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Held {
    /// It is there, whole and as it would be made now.
    Right,
    /// So it says, but without a digest of its bytes, as versions before wrote it: nobody knows what its pixels are.
    Unsealed,
    /// It is missing, damaged, or would be made otherwise now.
    Stale,
}

/// Bytes of the files that are read at the same time, if that allows more than one.
const MEMORY: u64 = 1 << 28;

impl Job {
    /// The stills of which all other pictures of a frame can be made: PNGs of 8 bits.
    pub(super) fn source(&self) -> Option<&FramePattern> {
        let plain = Still::Png.is_said(&self.formats) && !self.formats.png.deep;
        self.outputs.iter().find_map(|output| match output {
            Output::Stills(Still::Png, pattern) if plain => Some(pattern),
            _ => None,
        })
    }

    /// Whether frames are kept by a next run: their files say what they show, and what does not can be made of them.
    pub fn keeps(&self) -> bool {
        let said = |output: &Output| self.is_said(output);
        self.outputs.iter().any(said) && (self.outputs.iter().all(said) || self.source().is_some())
    }

    /// Whether an output's files say what they show.
    pub(super) fn is_said(&self, output: &Output) -> bool {
        matches!(output, Output::Stills(format, _) if format.is_said(&self.formats))
    }

    /// Looks at all files that are there. Where a stop is asked for, the rest is not looked at.
    pub(super) fn kept(&self, pool: &ThreadPool, stop: &Stop) -> Kept {
        let none = vec![false; self.frames.len()];
        if !matches!(self.existing, Existing::Keep | Existing::Share) {
            return Kept { frames: none, ..Kept::default() };
        }
        if !self.keeps() {
            return Kept { frames: none, notes: self.why_not() };
        }
        let held = |index: usize| match stop.signal() {
            None => self.held(index),
            Some(_) => Held::Stale,
        };
        // A file's bytes, at most.
        let bytes = u64::from(self.size.0) * u64::from(self.size.1) * 32;
        let held: Vec<Held> = if bytes.saturating_mul(pool.current_num_threads() as u64) <= MEMORY {
            pool.install(|| (0..self.frames.len()).into_par_iter().map(held).collect())
        } else {
            (0..self.frames.len()).map(held).collect()
        };
        let unsealed = held.iter().filter(|held| **held == Held::Unsealed).count() as u64;
        let note = (unsealed > 0).then(|| {
            let frames = counted(unsealed, "frame");
            format!("{frames} of a version before hold no digest of their pixels, and are made anew")
        });
        Kept {
            frames: held.into_iter().map(|held| held == Held::Right).collect(),
            notes: note.into_iter().collect(),
        }
    }

    /// Whether a frame is there, whole and as it would be made now.
    pub fn keeps_any(&self) -> bool {
        self.keeps() && (0..self.frames.len()).any(|index| self.keeps_frame(index))
    }

    /// What the files of a frame tell in words.
    pub(super) fn told(&self, frame: u32) -> impl Iterator<Item = Vec<Told>> {
        self.outputs.iter().filter_map(move |output| match output {
            Output::Stills(Still::Png, pattern) => Some(png::texts(&pattern.path(frame))),
            Output::Stills(Still::Exr, pattern) => Some(exr::texts(&pattern.path(frame))),
            _ => None,
        })
    }

    /// The samples that this job's limit of time has settled for frames that are there, where they are random and along
    /// each side of a grid: what most frames have comes first.
    pub fn settled(&self) -> Vec<(u32, u32)> {
        let Some(limit) = &self.about.time_limit else { return Vec::new() };
        let mut found: BTreeMap<(u32, u32), usize> = BTreeMap::new();
        for &frame in &self.frames {
            for counts in self.told(frame).filter_map(|told| record::told_counts(&told, limit)) {
                *found.entry(counts).or_default() += 1;
            }
        }
        let mut all: Vec<_> = found.into_iter().collect();
        all.sort_by_key(|(_, frames)| Reverse(*frames));
        all.into_iter().map(|(counts, _)| counts).collect()
    }

    pub(super) fn keeps_frame(&self, index: usize) -> bool {
        self.held(index) == Held::Right
    }

    /// What there is of a frame, by the worst of its files.
    fn held(&self, index: usize) -> Held {
        let of = |output: &Output| {
            let Output::Stills(format, pattern) = output else { return Held::Right };
            let path = pattern.path(self.frames[index]);
            match (format, self.identity(*format, index)) {
                (Still::Png, Some(identity)) => png::holds(&path, identity, self),
                (Still::Exr, Some(identity)) => exr::holds(&path, identity, self),
                // What cannot tell is written again of what can.
                _ if format.is_said(&self.formats) => Held::Stale,
                _ => Held::Right,
            }
        };
        self.outputs.iter().map(of).max().unwrap_or(Held::Right)
    }

    /// What to tell about files of frames that the sequence does not have any more.
    pub fn beyond(&self) -> Vec<String> {
        let count = self.about.frames;
        let note = |output: &Output| {
            let there = output.pattern().filter(|pattern| pattern.has_place())?.numbers().ok()?;
            let beyond = &there[there.partition_point(|number| *number < count)..];
            (!beyond.is_empty()).then(|| {
                format!(
                    "{output}: frames {} are there, and the sequence has {}; they are left as they are",
                    frame_set::text(beyond),
                    counted(count.into(), "frame")
                )
            })
        };
        self.outputs.iter().filter(|_| count > 0).filter_map(note).collect()
    }

    /// What to tell about files that are there, and of which none can be kept.
    fn why_not(&self) -> Vec<String> {
        let mut frames = self.frames.clone();
        frames.sort_unstable();
        let stills = self.outputs.iter().filter(|output| !output.is_animation());
        // A pipe or a device is no frame that was there.
        let is_file = |path: &PathBuf| Channel::at(path).is_none();
        let there: Vec<&Output> =
            stills.filter(|output| output.present(&frames).iter().any(is_file)).collect();
        let said = there.iter().any(|output| self.is_said(output));
        let reason = match there.first() {
            None => return Vec::new(),
            Some(_) if said => {
                "other outputs are made of frames as PNGs of 8 bits, and there are none".to_owned()
            }
            Some(Output::Stills(Still::Png, _)) => {
                "PNGs without metadata do not say what they show".to_owned()
            }
            Some(output) => format!("{output} has no room to say what it shows"),
        };
        vec![format!("no frame that was there could be kept: {reason}")]
    }
}
