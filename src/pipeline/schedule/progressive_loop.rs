//! Traces single frames in steps, for viewers that watch.

use super::frame_state::FrameState;
use super::prepared_world::PreparedWorld;
use super::shared_paths::weights_of;
use super::stages::FrameError;
use crate::base::cancel::Stop;
use crate::base::stats::Counts;
use crate::base::time::Clock;
use crate::camera::Camera;
use crate::camera::path::NoCamera;
use crate::film::{AovSet, LayerId};
use crate::scene::top_level::Bvh;
use crate::scene::{Scene, Weights};
use crate::sequence::Sequence;
use crate::trace::{Moment, ProgressiveFilm, Refinement, StageEnd, TraceSettings};

/// A sequence's world that traces films step by step.
pub struct ProgressiveLoop {
    world: PreparedWorld,
    /// The moment for which the world is prepared.
    prepared: Option<Clock>,
}

impl ProgressiveLoop {
    pub fn new(sequence: &Sequence, aovs: AovSet) -> Self {
        Self { world: PreparedWorld::new(sequence, aovs), prepared: None }
    }

    pub fn settings(&self) -> &TraceSettings {
        &self.world.settings
    }

    /// An empty film of a frame, which holds the layers `lit`.
    pub fn film(&self, state: &FrameState, lit: Vec<LayerId>) -> ProgressiveFilm {
        ProgressiveFilm::new(&self.world.settings, state.weights.len(), lit)
    }

    /// Traces a film of a frame up to a stage, seen by `camera` instead of the sequence's if there is one. After a stop,
    /// the film of a frame with one moment can be continued.
    pub fn trace(
        &mut self,
        state: &FrameState,
        camera: Option<&Camera>,
        film: &mut ProgressiveFilm,
        goal: Refinement,
        stop: &Stop,
    ) -> Result<(StageEnd, Counts), FrameError> {
        let weights = weights_of(state, film.lit());
        let mut counts = Counts::default();
        for (clock, moment) in self.world.moments(state) {
            if stop.signal().is_some() {
                return Ok((StageEnd::Stopped, counts));
            }
            // In a cross-fade, the camera before the cut as well.
            let faded = state.faded.as_ref().filter(|_| camera.is_none());
            let before = match faded {
                Some([from, _]) => Some((self.camera(from.camera, clock, moment)?, from.share)),
                None => None,
            };
            self.prepare(clock, moment)?;
            let Some((scene, bvh)) = self.world.scene(&weights) else { return Err(no_camera(state.frame)) };
            let scene = Scene { camera: camera.unwrap_or(scene.camera), ..scene };
            let random = state.random || camera.is_some_and(|camera| camera.lens.is_some());
            let before = before.as_ref().map(|(camera, share)| (camera, *share));
            let (end, traced) =
                film.trace((&scene, before), bvh, &self.world.settings, (moment, random), goal, stop);
            counts += traced;
            if end == StageEnd::Stopped {
                return Ok((end, counts));
            }
        }
        Ok((StageEnd::Complete, counts))
    }

    /// Calls `see` with the scene at the first moment of a frame, with all its light, and its tree.
    pub fn see<T>(
        &mut self,
        state: &FrameState,
        camera: Option<&Camera>,
        see: impl FnOnce(&Scene, &Bvh, &TraceSettings) -> T,
    ) -> Result<T, FrameError> {
        let Some((clock, moment)) = self.world.moments(state).into_iter().next() else {
            return Err(no_camera(state.frame));
        };
        self.prepare(clock, moment)?;
        let weights = Weights(state.weights.clone());
        let Some((scene, bvh)) = self.world.scene(&weights) else { return Err(no_camera(state.frame)) };
        let scene = Scene { camera: camera.unwrap_or(scene.camera), ..scene };
        Ok(see(&scene, bvh, &self.world.settings))
    }

    /// One of the cameras at a moment.
    fn camera(&mut self, index: usize, clock: Clock, moment: Moment) -> Result<Camera, FrameError> {
        self.prepared = None;
        self.world.look_through(Some(index));
        let prepared = self.world.prepare(clock, moment);
        self.world.look_through(None);
        prepared?;
        self.world.camera().ok_or_else(|| no_camera(clock.frame))
    }

    fn prepare(&mut self, clock: Clock, moment: Moment) -> Result<(), FrameError> {
        if self.prepared == Some(clock) {
            return Ok(());
        }
        self.prepared = None;
        self.world.prepare(clock, moment)?;
        self.prepared = Some(clock);
        Ok(())
    }
}

fn no_camera(frame: u32) -> FrameError {
    FrameError::Camera { frame, why: NoCamera::NotFinite }
}
