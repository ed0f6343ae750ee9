//! The number of camera rays of films.

use crate::pipeline::schedule::FrameState;
use crate::sequence::Sequence;
use crate::trace::MIN_SAMPLES;

/// Camera rays of a film. With a target error, this is the minimum; in cross-fades, the maximum.
pub fn camera_rays(sequence: &Sequence, state: &FrameState) -> u64 {
    let (width, height) = sequence.output.size;
    let quality = &sequence.quality;
    let each = match quality.noise {
        _ if !state.random => quality.antialias * quality.antialias,
        Some(target) => target.most.min(MIN_SAMPLES),
        None => quality.samples,
    };
    if state.fault.is_some() {
        0
    } else {
        u64::from(width) * u64::from(height) * u64::from(each * state.parts())
    }
}
