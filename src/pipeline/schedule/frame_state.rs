//! The state of a frame: everything it evaluates to, without tracing.

use crate::base::color::Rgb;
use crate::base::digest::Digest;
use crate::camera::CrossFade;
use crate::camera::path::NoCamera;
use crate::film::{LayerId, lit};
use crate::trace::{SharedViews, View, Weightings};
use std::collections::BTreeSet;
use std::sync::Arc;

/// What a frame evaluates to: see `frame_states`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameState {
    pub frame: u32,
    /// Digest of everything that decides the light in each layer, at every moment of the frame: geometry, materials,
    /// places of lights, sky, fog, cameras, and the quality settings that matter. Excludes what has no strength.
    pub scene_hash: Digest,
    /// Digest of the light that the frame shows: equal digests mean equal radiance. Excludes emitters in layers of
    /// weight 0.
    pub image_hash: Digest,
    /// The weight of each layer.
    pub weights: Vec<Rgb>,
    /// The weights of all frames of the sequence that share the film, if they decide how it is sampled.
    pub weightings: Weightings,
    /// Index in `weightings` of the frame's own weights, or of weights that are equal for all layers with light.
    pub own: usize,
    /// Factor on the displayed picture.
    pub exposure: f32,
    /// Number of moments at which the frame is traced: 1 unless something moves while the shutter is open.
    pub moments: u32,
    /// Whether samples are random.
    pub random: bool,
    /// Digest of the camera, lights, sky, ambient light and fog, and of whether a moment needs random samples: frames that
    /// agree in it differ in objects and their materials only. None if it changes while the shutter is open, or
    /// if each frame has random numbers of its own.
    pub surroundings: Option<Digest>,
    /// What the frame has in common with others of which it may share samples, and its view. None if it may share none.
    pub viewpoint: Option<(Digest, View)>,
    /// Why it shares none, if that is not because of its neighbours.
    pub view_obstacle: Option<ViewObstacle>,
    /// The views that share samples with the frame's own.
    pub views: Option<FrameViews>,
    /// Digests of the geometry at the first and the last moment, and the number of changes in between.
    pub geometry: (Digest, Digest),
    pub rebuilds: u32,
    /// The cameras of a cross-fade, which have a film each: the ones before and after the cut.
    pub faded: Option<[FadedView; 2]>,
    /// The index of the active camera.
    pub camera: usize,
    /// Digest of the slots of the geometry and of the own spaces of its shapes, if neighbours in time are found by them: they
    /// may differ where the light does not, as those of a ball that turns.
    pub poses: Digest,
    /// The frame itself and those whose samples help to denoise it, if there are any.
    pub neighbors: Option<Arc<[SampledState]>>,
    /// Why the frame cannot be traced.
    pub fault: Option<NoCamera>,
}

/// What one of two cameras of a frame shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FadedView {
    /// Index of the camera.
    pub camera: usize,
    /// Its share of the frame, above 0 and below 1.
    pub share: f64,
    /// As the fields of [`FrameState`], if the camera alone showed the frame.
    pub scene_hash: Digest,
    pub moments: u32,
    pub random: bool,
}

/// A frame that is sampled for those around it, too.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SampledState {
    /// What the frame evaluates to by itself.
    pub state: FrameState,
    /// The layers that any frame shows which it is sampled for.
    pub lit: Vec<LayerId>,
}

impl SampledState {
    /// Digest of its samples, and of where its points are.
    pub fn digest(&self) -> Digest {
        Digest::of(&(self.state.scene_hash, self.state.poses))
    }

    /// The layers to sample, ascending: those that it is sampled for, and `lit`.
    pub fn layers_with(&self, lit: &[LayerId]) -> Vec<LayerId> {
        self.lit.iter().chain(lit).copied().collect::<BTreeSet<_>>().into_iter().collect()
    }
}

/// Why a frame does not share samples of views.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ViewObstacle {
    /// Frames are sampled until they reach a target error.
    Target,
    /// Frames are denoised, so each needs samples of its own.
    Denoise,
    /// Each frame has random numbers of its own.
    Noise,
    /// Light depends on more than the direction of a ray: the camera has a lens, or its rays are parallel.
    Lens,
    Parallel,
    /// Something moves while the shutter is open.
    Shutter,
    /// Two cameras show the frame.
    CrossFade,
    /// A pattern is shown, which fades by the size of pixels.
    Pattern,
    /// The filter is narrower than a pixel: most samples of other views would be in none.
    Filter,
    /// Hardly any directions are in several pictures.
    Gain,
    /// No frame next to it shows the same scene from the same place in another view.
    #[default]
    Neighbors,
}

/// How many neighbouring frames one process denoises. It samples two more on each side.
const FRAMES_OF_BLOCK: u32 = 8;

/// Views that share samples, and the place of a frame's own.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameViews {
    pub all: Arc<SharedViews>,
    pub own: usize,
}

impl FrameState {
    /// The state of a frame that two cameras show, from what it would be through each of them.
    pub(super) fn faded(fade: CrossFade, from: Self, to: Self) -> Self {
        let view = |state: &Self, camera, share| FadedView {
            camera,
            share,
            scene_hash: state.scene_hash,
            moments: state.moments,
            random: state.random,
        };
        let views = [view(&from, fade.from, 1.0 - fade.share), view(&to, fade.to, fade.share)];
        Self {
            scene_hash: Digest::of(&(from.scene_hash, to.scene_hash, fade.share)),
            image_hash: Digest::of(&(from.image_hash, to.image_hash, fade.share)),
            moments: from.moments.max(to.moments),
            random: from.random || to.random,
            surroundings: None,
            viewpoint: None,
            view_obstacle: Some(ViewObstacle::CrossFade),
            rebuilds: from.rebuilds + to.rebuilds,
            faded: Some(views),
            fault: from.fault.or(to.fault),
            ..to
        }
    }

    /// The number of films that are traced for the frame.
    pub fn parts(&self) -> u32 {
        if self.faded.is_some() { 2 } else { 1 }
    }

    /// Digest of the picture: equal digests mean equal radiance and exposure.
    pub fn digest(&self) -> Digest {
        Digest::of(&(self.image_hash, self.exposure))
    }

    /// Digest of all layers of the frame's film and their weights, including layers without light.
    pub fn film(&self) -> Digest {
        Digest::of(&(self.scene_hash, self.weighted()))
    }

    /// The layers to trace for the frame, ascending: those that it shows, and those of frames that affect how it is
    /// sampled.
    pub fn lit(&self) -> Vec<LayerId> {
        let others = self.weightings.iter().flat_map(|weights| lit(weights));
        lit(&self.weights).chain(others).collect::<BTreeSet<_>>().into_iter().collect()
    }

    /// Makes the frame share a film that is sampled for all of `weightings`. Entry `own` is this frame's. Films that
    /// are sampled for different sets of frames get different hashes.
    pub(super) fn share(&mut self, frames: Digest, weightings: Weightings, own: usize) {
        (self.weightings, self.own) = (weightings, own);
        self.join(frames);
    }

    /// Makes the frame share samples of views. The same frame with other views has other samples, so it gets other hashes.
    pub(super) fn share_views(&mut self, digest: Digest, views: FrameViews) {
        self.views = Some(views);
        self.join(digest);
    }

    /// Makes the frame use the samples of neighbours in time. The first entry is the frame itself.
    pub(super) fn sample_with(&mut self, sampled: Vec<SampledState>) {
        if sampled.len() > 1 {
            let all: Vec<Digest> = sampled.iter().map(SampledState::digest).collect();
            self.join(Digest::of(&all));
        }
        self.neighbors = Some(sampled.into());
    }

    /// Makes a digest of what else decides the samples part of both hashes.
    fn join(&mut self, digest: Digest) {
        self.scene_hash = Digest::of(&(self.scene_hash, digest));
        self.image_hash = Digest::of(&(self.image_hash, digest));
    }

    /// Digest of what should be traced by one process: the film or, if its view shares samples, the films of all these
    /// views. Another process would trace the same again.
    pub fn shared_work(&self) -> Digest {
        match (&self.views, &self.viewpoint) {
            (Some(views), Some((viewpoint, _))) => Digest::of(&(*viewpoint, views.all.digest())),
            _ => self.scene_hash,
        }
    }

    /// The number of the block of frames that one process should render, if the frame takes samples of others.
    pub fn block(&self) -> Option<u32> {
        let has_others = self.neighbors.as_ref().is_some_and(|sampled| sampled.len() > 1);
        has_others.then(|| self.frame.div_euclid(FRAMES_OF_BLOCK))
    }

    /// The frame without shared samples, for pilots.
    pub fn alone(&self) -> Self {
        Self { views: None, neighbors: None, ..self.clone() }
    }

    /// The visible layers with their weights.
    fn weighted(&self) -> Vec<(u32, Rgb)> {
        let weighted = |(_, weight): &(u32, Rgb)| *weight != Rgb::ZERO;
        (0..).zip(self.weights.iter().copied()).filter(weighted).collect()
    }
}
