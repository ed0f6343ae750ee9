//! Sets of frames to render, such as `0-47`, `0..48`, `7,9,20` or `1-40:2`.
//!
//! A set is parsed without the sequence. It stores ranges, so no text makes it large. [`FrameSet::frames`] expands it
//! for the length of a sequence.

mod error;
mod shard;
#[cfg(test)]
mod tests;

pub use error::FrameSetError;
pub use shard::Shard;
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::str::FromStr;

/// The maximum number of frames of one run: nearly five days at 24 frames per second.
pub const MAX_FRAMES: usize = 10_000_000;

/// A set of frame numbers, not checked against a sequence yet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameSet(Vec<Steps>);

/// `first`, `first + step`, …, `last`. The difference of `last` and `first` is a multiple of `step`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Steps {
    first: u32,
    last: u32,
    step: u32,
}

impl FrameSet {
    /// Every frame of a sequence of `count` frames; `None` if `count` is 0.
    pub fn whole(count: u32) -> Option<Self> {
        let last = count.checked_sub(1)?;
        Some(Self(vec![Steps { first: 0, last, step: 1 }]))
    }

    /// The frames of a sequence of `count` frames, in rising order and without duplicates.
    ///
    /// # Errors
    /// If the sequence lacks one of the frames, or the set has more than [`MAX_FRAMES`] frames.
    pub fn frames(&self, count: u32) -> Result<Vec<u32>, FrameSetError> {
        let last = self.0.iter().map(|steps| steps.last).max().ok_or(FrameSetError::Empty)?;
        if last >= count {
            return Err(FrameSetError::Beyond { frame: last, count });
        }
        // Merge the ranges, so that memory grows with the result only, however much they overlap.
        let mut heads: BinaryHeap<_> = self.0.iter().map(|&s| Reverse((s.first, s.last, s.step))).collect();
        let mut frames = Vec::new();
        while let Some(Reverse((frame, last, step))) = heads.pop() {
            if frames.last() != Some(&frame) {
                if frames.len() == MAX_FRAMES {
                    return Err(FrameSetError::TooMany { max: MAX_FRAMES });
                }
                frames.push(frame);
            }
            if frame < last {
                heads.push(Reverse((frame + step, last, step)));
            }
        }
        Ok(frames)
    }
}

impl FromStr for FrameSet {
    type Err = FrameSetError;

    fn from_str(text: &str) -> Result<Self, FrameSetError> {
        if text.trim().is_empty() {
            return Err(FrameSetError::Empty);
        }
        let mut ranges = text.split(',').map(|part| steps(part.trim())).collect::<Result<Vec<_>, _>>()?;
        // Duplicate ranges would be expanded twice.
        ranges.sort_unstable_by_key(|s| (s.first, s.last, s.step));
        ranges.dedup();
        Ok(Self(ranges))
    }
}

/// Frames in rising order as the text of a set: ranges, with a step if it is not 1.
pub fn text(frames: &[u32]) -> String {
    let mut parts = Vec::new();
    let mut rest = frames;
    while let [first, after @ ..] = rest {
        let step = after.first().map_or(1, |second| second - first);
        let count = 1 + rest.windows(2).take_while(|pair| pair[1] - pair[0] == step).count();
        // Two frames with a gap are listed, not written as a range.
        let count = if count == 2 && step > 1 { 1 } else { count };
        let last = rest[count - 1];
        parts.push(match (count, step) {
            (1, _) => first.to_string(),
            (_, 1) => format!("{first}-{last}"),
            _ => format!("{first}-{last}:{step}"),
        });
        rest = &rest[count..];
    }
    parts.join(",")
}

/// One part between commas: a frame, or a range with an optional step.
fn steps(part: &str) -> Result<Steps, FrameSetError> {
    let (range, step) = match part.split_once([':', 'x']) {
        Some((range, step)) => (range, Some(step)),
        None => (part, None),
    };
    let (first, end, exclusive) = match (range.split_once(".."), split_dash(range)) {
        (Some((first, end)), _) => (first, end, true),
        (None, Some((first, end))) => (first, end, false),
        (None, None) => {
            let frame = number(range, part)?;
            if step.is_some() {
                return Err(FrameSetError::StepWithoutRange(part.to_owned()));
            }
            return Ok(Steps { first: frame, last: frame, step: 1 });
        }
    };
    let (first, end) = (number(first, part)?, number(end, part)?);
    let step = step.map_or(Ok(1), |step| number(step, part))?;
    if step == 0 {
        return Err(FrameSetError::ZeroStep(part.to_owned()));
    }
    if end < first {
        return Err(FrameSetError::Backwards { part: part.to_owned(), first, end });
    }
    let last = if exclusive { end.checked_sub(1).filter(|&last| last >= first) } else { Some(end) };
    let last = last.ok_or_else(|| FrameSetError::NoFrames { part: part.to_owned(), frame: first })?;
    Ok(Steps { first, last: last - (last - first) % step, step })
}

/// Splits `3-7` at its dash. A leading dash is a sign.
fn split_dash(range: &str) -> Option<(&str, &str)> {
    range.split_once('-').filter(|(first, _)| !first.trim().is_empty())
}

fn number(digits: &str, part: &str) -> Result<u32, FrameSetError> {
    let digits = digits.trim();
    if digits.strip_prefix('-').is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit())) {
        return Err(FrameSetError::Negative(part.to_owned()));
    }
    // `parse` would accept a plus sign.
    if digits.is_empty() || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return Err(FrameSetError::Malformed(part.to_owned()));
    }
    digits.parse().map_err(|_| FrameSetError::TooLarge(digits.to_owned()))
}
