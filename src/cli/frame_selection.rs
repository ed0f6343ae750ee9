//! The frames that `--frames` selects.

use super::failure::Failure;
use crate::base::frame_set::FrameSet;
use crate::sequence::Sequence;

/// The frames of a set, or all frames.
pub fn selected_frames(wanted: Option<&FrameSet>, sequence: &Sequence) -> Result<Vec<u32>, Failure> {
    let count = sequence.timeline.frames;
    let (set, option) = match wanted {
        Some(set) => (Some(set.clone()), "--frames: "),
        None => (FrameSet::whole(count), ""),
    };
    let set = set.ok_or_else(|| Failure::Bad("the sequence has no frames".to_owned()))?;
    set.frames(count).map_err(|error| Failure::Bad(format!("{option}{error}")))
}
