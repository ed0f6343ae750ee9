//! Finds frames that share samples because their cameras are at one point.

use super::frame_state::{FrameState, FrameViews, ViewObstacle};
use crate::base::digest::Digest;
use crate::sequence::Sequence;
use crate::trace::{MAX_VIEWS, SamplePlan, SharedViews, View};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;
use std::sync::Arc;

/// Consecutive frames of one scene from one point.
struct ViewSpan {
    frames: RangeInclusive<u32>,
    viewpoint: Digest,
    random: bool,
    /// The different views of the frames.
    views: Vec<View>,
}

/// Makes frames of the sequence share samples. `all` holds all frames, so that the samples of a frame do not depend on
/// which frames are requested.
pub fn share_views(sequence: &Sequence, all: &BTreeMap<u32, FrameState>, states: &mut [FrameState]) {
    let requested: BTreeSet<u32> = states.iter().map(|state| state.frame).collect();
    let wanted = |span: &ViewSpan| requested.range(span.frames.clone()).next().is_some();
    let shared = |span: ViewSpan| {
        let plan = SamplePlan::new(sequence.output.size, &sequence.quality, span.random);
        let views = match span.views.len() {
            1 => Err(ViewObstacle::Neighbors),
            _ if plan.filter.width < 1.0 => Err(ViewObstacle::Filter),
            _ => SharedViews::new(span.views, &plan).map(Arc::new).ok_or(ViewObstacle::Gain),
        };
        (span.frames, views)
    };
    // In the order of frames.
    let shared: Vec<_> = spans(all).into_iter().filter(wanted).map(shared).collect();
    for state in states {
        let index = shared.partition_point(|(frames, _)| *frames.end() < state.frame);
        let views = shared.get(index).filter(|(frames, _)| frames.contains(&state.frame));
        let (Some((_, views)), Some((_, view))) = (views, state.viewpoint) else { continue };
        match views {
            Ok(views) => {
                if let Some(own) = views.place(&view) {
                    state.share_views(views.digest(), FrameViews { all: Arc::clone(views), own });
                }
            }
            Err(obstacle) => state.view_obstacle = Some(*obstacle),
        }
    }
}

/// Divides frames into spans. Spans with too many views are cut, which depends on their first frame only.
fn spans(all: &BTreeMap<u32, FrameState>) -> Vec<ViewSpan> {
    let mut spans: Vec<ViewSpan> = Vec::new();
    for (&frame, state) in all {
        let Some((viewpoint, view)) = state.viewpoint.filter(|_| state.fault.is_none()) else { continue };
        match spans.last_mut() {
            Some(span)
                if span.viewpoint == viewpoint
                    && *span.frames.end() + 1 == frame
                    && (span.views.len() < MAX_VIEWS || span.views.contains(&view)) =>
            {
                span.frames = *span.frames.start()..=frame;
                if !span.views.contains(&view) {
                    span.views.push(view);
                }
            }
            _ => spans.push(ViewSpan {
                frames: frame..=frame,
                viewpoint,
                random: state.random,
                views: vec![view],
            }),
        }
    }
    spans
}
