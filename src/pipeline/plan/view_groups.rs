//! Groups films whose views share samples.

use super::render_plan::{Plan, ViewGroup};
use crate::film::LayerId;
use crate::pipeline::schedule::FrameState;
use crate::sequence::Sequence;
use crate::trace::{MAX_VIEWS, SamplePlan, bytes_of_sums};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Groups consecutive films with the same views: as many as the film cache has room for, but at least one. Samples that
/// several groups need are traced for each.
pub fn view_groups(plan: &Plan, sequence: &Sequence) -> Vec<ViewGroup> {
    let free = plan.cache.budget.saturating_sub(plan.kept_bytes());
    let (mut groups, mut first) = (Vec::new(), 0);
    while first < plan.films.len() {
        let (count, bytes) = fitting(plan, first, free);
        if plan.state_of(first).views.is_some() {
            let films = first..first + count;
            let states: Vec<&FrameState> = films.clone().map(|film| plan.state_of(film)).collect();
            groups.push(ViewGroup { films, camera_rays: camera_rays(sequence, &states), bytes });
        }
        first += count;
    }
    groups
}

/// The number of films from number `first` on that have the same views and fit into `free` bytes, from 1 to
/// [`MAX_VIEWS`]; and their bytes.
fn fitting(plan: &Plan, first: usize, free: u64) -> (usize, u64) {
    let views = |film: usize| plan.state_of(film).views.as_ref().map(|views| Arc::as_ptr(&views.all));
    let mut lit: BTreeSet<LayerId> = BTreeSet::new();
    let (mut count, mut all) = (0, 0);
    for film in first..plan.films.len() {
        lit.extend(&plan.films[film].lit);
        let layers = lit.len() as u64 + plan.cache.aovs;
        let each = plan.cache.bytes(lit.len()).saturating_add(bytes_of_sums(plan.cache.pixels, layers));
        let bytes = each.saturating_mul(count as u64 + 1);
        let is_alike = views(film).is_some() && views(film) == views(first);
        if count > 0 && (!is_alike || bytes > free || count == MAX_VIEWS) {
            break;
        }
        (count, all) = (count + 1, bytes);
    }
    (count, all)
}

/// The number of camera rays of films that share samples of the same views.
fn camera_rays(sequence: &Sequence, states: &[&FrameState]) -> u64 {
    let requested: Vec<usize> =
        states.iter().filter_map(|state| state.views.as_ref()).map(|views| views.own).collect();
    let Some((first, views)) = states.first().and_then(|state| Some((state, state.views.as_ref()?))) else {
        return 0;
    };
    let plan = SamplePlan::new(sequence.output.size, &sequence.quality, first.random);
    views.all.camera_rays(&plan, &requested)
}
