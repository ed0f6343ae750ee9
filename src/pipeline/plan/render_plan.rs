//! The plan of a run: its frame states, its films, and the film of each frame.

use super::camera_rays::camera_rays;
use super::evaluate::{FrameStates, evaluate};
use super::shared_films::{FilmCache, SharedFilm, shared_films};
use super::view_groups::view_groups;
use crate::film::{AovSet, LayerId};
use crate::pipeline::schedule::{FrameState, ViewObstacle};
use crate::sequence::Sequence;
use crate::sequence::quality::Denoise;
use crate::trace::MAX_FRAMES;
use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;

/// Copying an object takes as long as tracing about this number of samples (0.3 microseconds in a scene of 100,000
/// spheres).
const SAMPLES_PER_COPY: u64 = 4;

/// What a run traces.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    pub states: FrameStates,
    pub cache: FilmCache,
    /// Films in the order of tracing.
    pub films: Vec<SharedFilm>,
    /// Index of the film of each frame.
    pub film_of: Vec<usize>,
    /// For each film, whether its scene may be copied to share paths; empty if that of none may. It is not if the film is
    /// sampled until it reaches a target error, or if it has few samples for the number of objects.
    pub(super) copied: Vec<bool>,
    /// Bytes for films that share paths and for copies of their scenes: the part of the budget that cached films leave. 0
    /// if no films share paths.
    pub(super) sharing_budget: u64,
    /// Films that are traced together because their views share samples.
    pub view_groups: Vec<ViewGroup>,
}

/// Consecutive films whose views share samples.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ViewGroup {
    pub films: Range<usize>,
    /// The number of camera rays of all films, without those of pixels that lack samples.
    pub camera_rays: u64,
    /// Bytes of the films and of their sums while they are traced.
    pub bytes: u64,
}

/// Whether copying a scene for every moment takes less time than tracing its samples.
fn copy_pays(sequence: &Sequence, state: &FrameState) -> bool {
    let copied = (sequence.objects.len() as u64).saturating_mul(u64::from(state.moments));
    copied.saturating_mul(SAMPLES_PER_COPY) <= camera_rays(sequence, state)
}

impl Plan {
    /// The plan of these frames, in this order. Cached films take at most `budget` bytes; with 0, each frame has its
    /// own film.
    pub fn new(sequence: &Sequence, frames: &[u32], aovs: AovSet, budget: u64) -> Self {
        Self::from_states(evaluate(sequence, frames), sequence, aovs, budget)
    }

    /// [`Plan::new`] for frames that are already evaluated.
    pub fn from_states(states: FrameStates, sequence: &Sequence, aovs: AovSet, budget: u64) -> Self {
        let cache = FilmCache::of(sequence, aovs, budget);
        let (films, film_of) = shared_films(&states.frames, &cache);
        let mut plan = Self {
            states,
            cache,
            films,
            film_of,
            copied: Vec::new(),
            sharing_budget: 0,
            view_groups: Vec::new(),
        };
        plan.view_groups = view_groups(&plan, sequence);
        // Frames that are denoised are traced in sets of samples, each frame for itself.
        if sequence.quality.noise.is_none() && sequence.quality.denoise == Denoise::Off {
            plan.copied =
                (0..plan.films.len()).map(|film| copy_pays(sequence, plan.state_of(film))).collect();
            plan.sharing_budget = plan.cache.budget.saturating_sub(plan.kept_bytes());
        }
        plan
    }

    /// The plan if no films share paths. The time of such a plan can be predicted from a few patches of pixels, so runs with
    /// a time limit use it.
    pub fn without_shared_paths(self) -> Self {
        Self { sharing_budget: 0, ..self }
    }

    /// The state of the first frame of a film.
    pub fn state_of(&self, film: usize) -> &FrameState {
        &self.states.frames[self.films[film].frames[0]]
    }

    /// The films from number `first` on whose views share samples and that are traced together.
    pub fn view_group(&self, first: usize) -> Option<&ViewGroup> {
        self.view_groups.iter().find(|group| group.films.start == first)
    }

    /// Whether films of the same views are in several groups, because the film cache has no room for all of them.
    pub fn splits_views(&self) -> bool {
        let views = |group: &ViewGroup| {
            let state = self.state_of(group.films.start);
            state.views.as_ref().map(|views| Arc::as_ptr(&views.all))
        };
        self.view_groups.array_windows().any(|[a, b]| views(a) == views(b))
    }

    /// Why frames do not share samples of views: the obstacle of the first frame that does not.
    pub fn view_obstacle(&self) -> Option<ViewObstacle> {
        self.states.frames.iter().find_map(|state| state.view_obstacle)
    }

    /// Number of frames that reuse the film of another frame.
    pub fn reused(&self) -> usize {
        self.film_of.len() - self.films.len()
    }

    /// The number of films from number `first` on that may share paths: they differ in objects and their materials only.
    /// The film cache has room for all of them. At most one if films share no paths.
    pub fn together(&self, first: usize) -> usize {
        let state = |film: usize| self.state_of(film);
        let surroundings = state(first).surroundings;
        if surroundings.is_none() || state(first).views.is_some() {
            return 1;
        }
        let mut lit: BTreeSet<LayerId> = BTreeSet::new();
        let mut count = 0;
        for film in (first..self.films.len()).take(MAX_FRAMES) {
            lit.extend(&self.films[film].lit);
            let bytes = self.cache.bytes(lit.len()).saturating_mul(count as u64 + 1);
            let other = state(film);
            let is_alike = other.surroundings == surroundings
                && other.fault.is_none()
                && other.views.is_none()
                && self.copied.get(film) == Some(&true);
            if !is_alike || bytes > self.sharing_budget - self.scenes_budget() {
                break;
            }
            count += 1;
        }
        count
    }

    /// Bytes for copies of scenes while films share paths.
    pub fn scenes_budget(&self) -> u64 {
        self.sharing_budget / 4
    }

    /// Maximum bytes of films that are traced together.
    pub fn shared_bytes(&self) -> u64 {
        let (mut most, mut first) = (0, 0);
        while first < self.films.len() {
            let count = self.together(first).max(1);
            if count > 1 {
                let lit = Self::lit(&self.films[first..first + count]).len();
                most = most.max(self.cache.bytes(lit).saturating_mul(count as u64));
            }
            first += count;
        }
        most
    }

    /// The layers that any of these films holds, ascending.
    pub fn lit(films: &[SharedFilm]) -> Vec<LayerId> {
        let all: BTreeSet<LayerId> = films.iter().flat_map(|film| &film.lit).copied().collect();
        all.into_iter().collect()
    }

    /// Maximum bytes of the film cache.
    pub fn kept_bytes(&self) -> u64 {
        let mut most = 0;
        let mut now = 0;
        for (index, &film) in self.film_of.iter().enumerate() {
            let shared = &self.films[film];
            let (first, last) = (shared.frames.first(), shared.frames.last());
            let bytes = self.cache.bytes(shared.lit.len());
            let kept = first != last;
            if kept && first == Some(&index) {
                now += bytes;
            }
            most = most.max(now);
            if kept && last == Some(&index) {
                now -= bytes;
            }
        }
        most
    }

    /// Number of times that the top-level tree is built or refitted: once for each film whose geometry differs from that
    /// of the film before, and once for each moment at which it moves while the shutter is open.
    pub fn bvh_updates(&self) -> u64 {
        let mut before = None;
        let mut updates = 0;
        for shared in &self.films {
            let state = &self.states.frames[shared.frames[0]];
            updates += u64::from(before != Some(state.geometry.0)) + u64::from(state.rebuilds);
            before = Some(state.geometry.1);
        }
        updates
    }
}
