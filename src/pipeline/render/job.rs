//! The encoder's job of a run.

use super::request::Request;
use crate::encode::{EncodeJob, Existing, FrameKey, Output, SequenceInfo, StillFormat};
use crate::film::AovSet;
use crate::pipeline::drawings::drawings;
use crate::pipeline::plan::{FrameStates, evaluate};
use crate::pipeline::schedule::FrameState;
use crate::sequence::Sequence;
use crate::sequence::quality::Denoise;
use crate::sequence::quality::{NoiseTarget, Quality};

/// The quality of frames that an earlier run with the same time limit rendered. None if no valid frame exists that
/// this quality would render identically.
pub fn existing_quality(sequence: &Sequence, request: &Request) -> Option<Quality> {
    if request.existing != Existing::Keep {
        return None;
    }
    let counts = job(sequence, request, &FrameStates::default()).earlier_sample_counts();
    let qualities = counts.into_iter().map(|(samples, antialias)| Quality {
        samples,
        antialias,
        noise: sequence.quality.noise.map(|target| NoiseTarget { most: samples, ..target }),
        ..sequence.quality
    });
    qualities.into_iter().find(|&quality| {
        let sequence = Sequence { quality, ..sequence.clone() };
        job(&sequence, request, &evaluate(&sequence, &request.frames)).can_keep_any()
    })
}

pub(crate) fn job(sequence: &Sequence, request: &Request, states: &FrameStates) -> EncodeJob {
    let output = &sequence.output;
    // Frame states identify existing frames.
    let frame_key = |state: &FrameState| FrameKey {
        image_hash: state.image_hash,
        film: state.film(),
        exposure: state.exposure,
        random: state.random,
    };
    EncodeJob {
        outputs: request.outputs.clone(),
        confined: request.confined,
        existing: request.existing,
        frames: request.frames.clone(),
        frame_keys: states.frames.iter().map(frame_key).collect(),
        rate: sequence.timeline.rate,
        size: output.size,
        tonemap: output.tonemap,
        transparent: output.transparent,
        background_color: output.background_color,
        // Without states, the job is only checked.
        drawings: if states.frames.is_empty() { Vec::new() } else { drawings(sequence, &request.frames) },
        formats: output.formats,
        info: SequenceInfo { time_limit: request.limit(), ..sequence.about() },
    }
}

/// The layers besides light that these outputs need.
pub(crate) fn requested_aovs(sequence: &Sequence, outputs: &[Output]) -> AovSet {
    let exr = outputs.iter().any(|output| matches!(output, Output::Stills(StillFormat::Exr, _)));
    let layers = sequence.output.formats.exr.layers;
    let samples = exr && layers.samples && sequence.quality.denoise != Denoise::Off;
    let features = exr && layers.need_features();
    AovSet { features, samples, ..AovSet::of_picture(sequence.output.transparent) }
}
