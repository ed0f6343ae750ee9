//! The ECS schedule: systems in their order, and evaluation of frames without tracing.
//!
//! In: a `Sequence` and frame numbers.
//! Out: films, passed to a [`FilmSink`]; frame states.
//! Uses `world`, `scene`, `trace` and the rooms above. Only `systems` knows the order of the systems.

mod cross_fade;
mod film_settings;
mod frame_loop;
mod frame_mark;
mod frame_state;
mod frame_states;
mod prepared_world;
mod known_samples;
mod neighbors;
mod preview;
mod progressive_loop;
mod prober;
mod sample_sets;
mod shared_paths;
mod shutter;
mod stages;
mod systems;
mod view_spans;
mod shared_views;
#[cfg(test)]
mod tests;

pub use frame_loop::FrameLoop;
pub use frame_state::{FadedView, FrameState, FrameViews, SampledState, ViewObstacle};
pub use frame_states::{REACH, frame_states};
pub use known_samples::KnownSamples;
pub use preview::Preview;
pub use prober::{PassCost, Prober};
pub use progressive_loop::ProgressiveLoop;
pub use shared_paths::{PathGroup, SharingTrial};
pub use stages::{FilmCollector, FilmSink, FrameError, FrameStage, Stats};
