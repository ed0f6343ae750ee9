//! The number of camera rays of films.

use crate::film::LayerId;
use crate::pipeline::schedule::{FadedView, FrameState, KnownSamples, SampledState};
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

/// Camera rays of each of these films with these layers, traced in this order. A camera of a cross-fade that shows the same
/// as in the film before is not traced again, unless films are sampled until they reach a target error. Samples of
/// neighbours are known while they are neighbours of the next film, too.
pub fn camera_rays_in_order<'a, L: AsRef<[LayerId]>>(
    sequence: &Sequence,
    films: impl Iterator<Item = (&'a FrameState, L)>,
) -> Vec<u64> {
    let mut before: Option<(&[FadedView; 2], L)> = None;
    let (mut all, mut sampled) = (Vec::new(), KnownSamples::default());
    for (state, lit) in films {
        if let Some(neighbors) = &state.neighbors {
            all.push(rays_among_neighbors(sequence, neighbors, lit.as_ref(), &mut sampled));
            before = None;
            continue;
        }
        let is_known = |view: &&FadedView| {
            let same = |(views, layers): &(&[FadedView; 2], L)| {
                let shown = views.iter().any(|other| other.scene_hash == view.scene_hash);
                shown && layers.as_ref() == lit.as_ref()
            };
            sequence.quality.noise.is_none() && before.as_ref().is_some_and(same)
        };
        let known = state.faded.iter().flatten().filter(is_known);
        let known: u64 = known.map(|view| rays_of_view(sequence, view.random)).sum();
        all.push(camera_rays(sequence, state).saturating_sub(known));
        before = state.faded.as_ref().map(|views| (views, lit));
    }
    all
}

/// Camera rays of a film, of which the first entry of `frames` is the frame itself.
fn rays_among_neighbors(
    sequence: &Sequence,
    frames: &[SampledState],
    lit: &[LayerId],
    known: &mut KnownSamples<()>,
) -> u64 {
    known.keep_for(frames);
    let mut traced = 0;
    for frame in frames {
        if known.find(frame, lit).is_none() {
            known.insert(frame, frame.layers_with(lit), ());
            traced += 1;
        }
    }
    let quality = &sequence.quality;
    // The frame itself has audits besides.
    let picture = quality.samples.next_multiple_of(2);
    let audits = quality.traced_samples(quality.samples) - picture;
    pixels(sequence) * (u64::from(picture) * traced + u64::from(audits))
}

/// Camera rays of what one camera shows.
fn rays_of_view(sequence: &Sequence, random: bool) -> u64 {
    let quality = &sequence.quality;
    let each = match quality.noise {
        _ if !random => quality.antialias * quality.antialias,
        Some(target) => quality.traced_samples(target.most.min(MIN_SAMPLES)),
        None => quality.traced_samples(quality.samples),
    };
    pixels(sequence) * u64::from(each)
}

fn pixels(sequence: &Sequence) -> u64 {
    let (width, height) = sequence.output.size;
    u64::from(width) * u64::from(height)
}
