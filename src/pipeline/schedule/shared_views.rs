//! Traces the films of frames that share samples because their cameras are at one point.

use super::frame_loop::FrameLoop;
use super::frame_state::FrameState;
use super::shared_paths::weights_of;
use super::stages::{FilmSink, FrameError, RenderSettings, RunProgress};
use crate::camera::Camera;
use crate::film::{Film, LayerId};
use crate::scene::top_level::Bvh;
use crate::scene::{Geometry, Scene, Shading};
use crate::trace::trace_views;
use crate::world::Current;
use std::sync::Arc;
use std::time::Instant;

#[warn(missing_docs)]
impl<S: FilmSink> FrameLoop<S> {
    /// Traces films of these frames together, with the layers `lit`. The frames must share samples of the same views.
    /// Returns all films, or none if the run is stopped.
    pub fn trace_views(&mut self, states: &[&FrameState], lit: &[LayerId]) -> Result<Vec<Film>, FrameError> {
        let Some(first) = states.first() else { return Ok(Vec::new()) };
        let Some(views) = &first.views else { return Ok(Vec::new()) };
        self.without_tracing(|frames| {
            let moments = frames.moments(first.frame, true);
            moments.into_iter().try_for_each(|(clock, moment)| frames.run_moment(clock, moment))
        })?;
        let _span = tracing::info_span!("trace together", first = first.frame).entered();
        let (start, weights, world) = (Instant::now(), weights_of(first, lit), &self.world);
        let (geometry, shading) =
            (&world.resource::<Current<Geometry>>().0, &world.resource::<Current<Shading>>().0);
        let Some(camera) = &world.resource::<Current<Option<Camera>>>().0 else { return Ok(Vec::new()) };
        let scene = Scene { geometry, shading, weights: &weights, camera };
        let requested: Vec<usize> =
            states.iter().filter_map(|state| state.views.as_ref()).map(|views| views.own).collect();
        let (bvh, settings) = (&world.resource::<Current<Bvh>>().0, &world.resource::<RenderSettings>().0);
        let meter = Arc::clone(&world.resource::<RunProgress>().0);
        let traced = trace_views(&views.all, &requested, (&scene, bvh), settings, &meter);
        Ok(self.recorded(traced, start))
    }
}
