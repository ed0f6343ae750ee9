//! Everything that `kinora plan` prints, computed once for both the text and the JSON.

use crate::base::clock::TimeSource;
use crate::cli::farm_forecast::FarmForecast;
use crate::film::{AovSet, LayerId};
use crate::pipeline::plan::{
    FilmForecast, Outline, Outlook, PilotBudget, PilotTime, Plan, RayEstimate, RunForecast, SceneEffect,
    estimate_rays, outline, run_pilot,
};
use crate::sequence::Sequence;

/// A plan with its expected cost.
pub struct PlanReport<'a> {
    pub sequence: &'a Sequence,
    pub plan: Plan,
    pub outline: Outline,
    /// The expected numbers of rays.
    pub expected: RayEstimate,
    /// The pilot's result, and the forecast for the sequence's own quality. None with `--no-pilot`.
    pub outlook: Option<(Outlook, RunForecast)>,
    /// Bytes for films that later frames reuse.
    pub cache_budget: u64,
    /// The prediction for `--workers`.
    pub farm: Option<FarmForecast>,
    /// Bytes of films that wait for the encoder, and of the pictures made from them.
    pub pending_bytes: u64,
}

impl<'a> PlanReport<'a> {
    /// Plans these frames. Traces a pilot if `with_pilot` is set.
    pub fn new(
        sequence: &'a Sequence,
        frames: &[u32],
        aovs: AovSet,
        cache_budget: u64,
        with_pilot: bool,
    ) -> Self {
        let plan = Plan::new(sequence, frames, aovs, cache_budget);
        let outline = outline(sequence, &plan);
        let (expected, outlook) = match with_pilot {
            true => piloted(sequence, &plan, aovs),
            false => (RayEstimate::of(sequence, &plan), None),
        };
        Self { sequence, plan, outline, expected, outlook, cache_budget, farm: None, pending_bytes: 0 }
    }

    pub fn with_farm(self, farm: Option<FarmForecast>, pending_bytes: u64) -> Self {
        Self { farm, pending_bytes, ..self }
    }

    /// The number of the frame at this place of the plan.
    pub fn frame(&self, index: usize) -> u32 {
        self.plan.states.frames[index].frame
    }

    /// Films that would be traced if there were memory for all of them.
    pub fn unlimited_films(&self) -> usize {
        let looks = &self.plan.states.frames;
        let mut different: Vec<_> = looks.iter().map(|look| look.scene_hash).collect();
        different.sort_unstable();
        different.dedup();
        different.len()
    }

    /// Films in which a layer of light is traced.
    pub fn films_with_layer(&self, layer: usize) -> usize {
        let id = LayerId(layer as u32);
        self.plan.films.iter().filter(|take| take.lit.contains(&id)).count()
    }

    pub fn unused_effects(&self) -> impl Iterator<Item = &'static str> {
        let unused = SceneEffect::ALL.iter().filter(|effect| !self.outline.effects.contains_key(effect));
        unused.map(|effect| effect.name())
    }
}

/// Rays, times and errors by a pilot.
fn piloted(sequence: &Sequence, plan: &Plan, aovs: AovSet) -> (RayEstimate, Option<(Outlook, RunForecast)>) {
    let outlook = run_pilot(sequence, plan, aovs, PilotTime::PLAN, TimeSource::Machine);
    let forecast = outlook.forecast(&sequence.quality);
    let known = RayEstimate::of(sequence, plan);
    let expected = match known.exact || known.shares_views {
        true => estimate_rays(sequence, plan, PilotBudget::PLAN),
        // Without reuse, every frame costs as much as its film.
        false => {
            let alone = |part: fn(&FilmForecast) -> f64| {
                plan.film_of.iter().map(|&film| part(&forecast.films[film])).sum::<f64>() as u64
            };
            RayEstimate {
                camera: forecast.camera as u64,
                camera_alone: alone(|film| film.camera),
                rays: Some(forecast.rays as u64),
                rays_alone: Some(alone(|film| film.rays)),
                ..known
            }
        }
    };
    (expected, Some((outlook, forecast)))
}
