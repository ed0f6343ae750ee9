//! The plan of a run. Animation depends on time alone, so the plan evaluates all frames before any is traced.
//!
//! In: a `Sequence` and frame numbers.
//! Out: which films are traced, which frames share them, and forecasts of rays, time and error.
//! Uses `schedule` to evaluate and trace, and the rooms above.
//!
//! ```text
//! Sequence, frames ──evaluate──▶ FrameStates ──shared_films──▶ Plan ──run──▶ the frame loop
//! ```
//!
//! A plan never changes a picture: a frame that is rendered alone has the same bytes.

mod camera_rays;
mod changes;
mod effects;
mod evaluate;
mod group_trial;
mod outline;
mod outlook;
mod path_shares;
mod ray_estimate;
mod render_plan;
mod run;
mod shared_films;
mod shared_run;
mod tries;
mod view_groups;
mod work_groups;
#[cfg(test)]
mod tests;

pub use camera_rays::camera_rays;
pub use changes::{AnimatedPart, Changes};
pub use effects::{EffectSource, SceneEffect};
pub use evaluate::{FrameStates, evaluate, evaluate_until, with_shared};
pub use outline::{FrameSpan, Outline, Reason, outline};
pub use outlook::{FilmForecast, Outlook, PilotTime, Range, RunForecast, run_pilot};
pub use ray_estimate::{
    CostEstimate, NullSink, PilotBudget, RayEstimate, cost_estimate, downscaled, estimate_rays,
};
pub use render_plan::{Plan, ViewGroup};
pub use run::run;
pub use shared_films::{FilmCache, SharedFilm};
pub use shared_run::{SharedRun, run_shared};
pub use work_groups::{WorkGroup, work_groups};
