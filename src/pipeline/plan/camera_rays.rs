//! The number of camera rays of films.

use crate::film::LayerId;
use crate::pipeline::schedule::{FadedView, FrameState};
use crate::sequence::Sequence;
use crate::trace::MIN_SAMPLES;

/// Camera rays of a film. With a target error, this is the minimum.
pub fn camera_rays(sequence: &Sequence, state: &FrameState) -> u64 {
    match &state.faded {
        _ if state.fault.is_some() => 0,
        Some(views) => views.iter().map(|view| rays_of_view(sequence, view.random)).sum(),
        None => rays_of_view(sequence, state.random),
    }
}

/// Camera rays of films with these layers that are traced in this order. A camera of a cross-fade that shows the same as
/// in the film before is not traced again, unless films are sampled until they reach a target error.
pub fn camera_rays_in_order<'a, L: AsRef<[LayerId]>>(
    sequence: &Sequence,
    films: impl Iterator<Item = (&'a FrameState, L)>,
) -> u64 {
    let mut before: Option<(&[FadedView; 2], L)> = None;
    let mut all = 0;
    for (state, lit) in films {
        let is_known = |view: &&FadedView| {
            let same = |(views, layers): &(&[FadedView; 2], L)| {
                let shown = views.iter().any(|other| other.scene_hash == view.scene_hash);
                shown && layers.as_ref() == lit.as_ref()
            };
            sequence.quality.noise.is_none() && before.as_ref().is_some_and(same)
        };
        let known = state.faded.iter().flatten().filter(is_known);
        let known: u64 = known.map(|view| rays_of_view(sequence, view.random)).sum();
        all += camera_rays(sequence, state).saturating_sub(known);
        before = state.faded.as_ref().map(|views| (views, lit));
    }
    all
}

/// Camera rays of what one camera shows.
fn rays_of_view(sequence: &Sequence, random: bool) -> u64 {
    let (width, height) = sequence.output.size;
    let quality = &sequence.quality;
    let each = match quality.noise {
        _ if !random => quality.antialias * quality.antialias,
        Some(target) => quality.traced_samples(target.most.min(MIN_SAMPLES)),
        None => quality.traced_samples(quality.samples),
    };
    u64::from(width) * u64::from(height) * u64::from(each)
}
