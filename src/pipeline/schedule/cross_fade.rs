//! Frames that two cameras show together: each camera has a film of its own, and the frame is their mean.
//!
//! Films are mixed, not pictures. So light is mixed as in a double exposure, EXR files hold the mixed radiance, alpha
//! stays premultiplied, and everything behind films (tone maps, formats, animations) knows nothing of it.

use super::frame_loop::FrameLoop;
use super::frame_state::{FadedView, FrameState};
use super::shared_paths::weights_of;
use super::stages::{FilmInProgress, FilmSink, FrameError, RenderSettings, RunProgress, Stats, TraceRequest};
use crate::base::digest::Digest;
use crate::camera::path::NoCamera;
use crate::film::{Film, LayerId};
use crate::world::ActiveCamera;
use bevy_ecs::world::World;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;

/// A film of one of two cameras, for the next frame: cameras that stand still before a scene that does not change show
/// the same light in all frames of a cross-fade.
pub struct FadedFilm {
    scene_hash: Digest,
    lit: Vec<LayerId>,
    film: Film,
}

/// Makes a camera the active one at all times; None for the camera that the sequence chooses.
pub fn look_through(world: &mut World, camera: Option<usize>) {
    world.resource_mut::<ActiveCamera>().only = camera;
}

impl<S: FilmSink> FrameLoop<S> {
    /// Renders a frame that two cameras show, with the layers `lit`. Returns its film, which is not pushed.
    pub(super) fn trace_faded(
        &mut self,
        state: &FrameState,
        [from, to]: [&FadedView; 2],
        lit: &[LayerId],
    ) -> Result<Film, FrameError> {
        let before = std::mem::take(&mut self.faded);
        let [first, second] = [self.view(state, from, lit, &before), self.view(state, to, lit, &before)];
        let film = first?.mixed_with(&second?, to.share);
        self.world.resource_mut::<Stats>().traced += 1;
        self.world.resource::<RunProgress>().0.frames.fetch_add(1, Relaxed);
        Ok(film)
    }

    /// The film of one of the cameras: that of the frame before if it shows the same.
    fn view(
        &mut self,
        state: &FrameState,
        view: &FadedView,
        lit: &[LayerId],
        before: &[FadedFilm],
    ) -> Result<Film, FrameError> {
        let same = |known: &&FadedFilm| known.scene_hash == view.scene_hash && known.lit == lit;
        let film = match before.iter().find(same) {
            Some(known) => known.film.clone(),
            None => self.trace_view(state, view, lit)?,
        };
        // With a target error, samples depend on the weights of the frame as well.
        let has_target = self.world.resource::<RenderSettings>().0.quality.noise.is_some();
        if !has_target && !film.unfinished {
            let (scene_hash, lit) = (view.scene_hash, lit.to_vec());
            self.faded.push(FadedFilm { scene_hash, lit, film: film.clone() });
        }
        Ok(film.shown_as(state.own, &state.weights))
    }

    fn trace_view(
        &mut self,
        state: &FrameState,
        view: &FadedView,
        lit: &[LayerId],
    ) -> Result<Film, FrameError> {
        look_through(&mut self.world, Some(view.camera));
        self.world.insert_resource(TraceRequest {
            lit: Some(weights_of(state, lit)),
            weightings: Arc::clone(&state.weightings),
            own: state.own,
            keep: true,
            is_part: true,
            films: None,
            parts: [0; 2],
            only_prepare: false,
        });
        let moments = self.moments_of(view.camera, state.frame, view.moments == 1);
        let done = self.run(&moments);
        self.world.insert_resource(TraceRequest::default());
        look_through(&mut self.world, None);
        done?;
        let film = self.world.resource_mut::<FilmInProgress>().kept.take();
        film.ok_or(FrameError::Camera { frame: state.frame, why: NoCamera::NotFinite })
    }
}
