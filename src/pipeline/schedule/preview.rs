//! Evaluates frames without tracing.

use super::cross_fade::look_through;
use super::film_settings::FilmSettings;
use super::frame_state::{FrameState, ViewObstacle};
use super::shutter::Shutter;
use super::stages::{CurrentMoment, FirstError, Stopwatch};
use super::systems::{new_world, update_schedule};
use crate::base::digest::{Content, Digest, Digester};
use crate::base::math::Basis;
use crate::base::time::{Clock, Timeline};
use crate::camera::path::NoCamera;
use crate::camera::{Camera, Projection};
use crate::film::exposure;
use crate::scene::{Digests, Geometry, Scene, Shading, Weights};
use crate::sequence::Sequence;
use crate::trace::{Moment, View, Weightings, is_random};
use crate::track::Animated;
use crate::world::{Current, Now, ShapeUse};
use bevy_ecs::change_detection::{DetectChanges, Tick};
use bevy_ecs::schedule::Schedule;
use bevy_ecs::world::World;

/// A sequence's world without the systems that trace.
pub struct Preview {
    world: World,
    schedule: Schedule,
    timeline: Timeline,
    shutter: Shutter,
    exposure: Animated<f64>,
    /// Settings that are equal in all frames.
    settings: FilmSettings,
    digests: Digests,
    /// The digest of the poses, and the revision of the geometry of which it is.
    poses: Option<(u64, Digest)>,
    /// Change tick of the shading at the last evaluation.
    shading_tick: Option<Tick>,
}

/// The state of the scene at one moment.
struct MomentState {
    /// Digest of everything that light meets.
    scene_hash: Digest,
    /// Digest of the visible light, with the weights of the frame.
    image_hash: Digest,
    /// Whether the moment alone needs random samples.
    random: bool,
    /// Digest of everything but objects and their materials, and of the kind of samples.
    surroundings: Digest,
    /// Digest of everything that light meets but the view, and of the kind of samples; and the view. Or why it cannot share
    /// samples.
    viewpoint: Result<(Digest, View), ViewObstacle>,
    /// As [`FrameState::poses`].
    poses: Digest,
}

impl MomentState {
    /// Whether light meets the same scene at another moment.
    fn looks_like(&self, other: &Self) -> bool {
        let all = |state: &Self| (state.scene_hash, state.image_hash, state.random);
        all(self) == all(other)
    }
}

/// The digest of the slots that are not empty, and of the own spaces of their shapes.
fn poses(geometry: &Geometry) -> Digest {
    let mut digester = Digester::new();
    let slots = geometry.primitives.iter().enumerate().filter(|(_, primitive)| !primitive.is_empty());
    slots.for_each(|(slot, _)| (slot as u32, geometry.origin(slot).to_object()).feed(&mut digester));
    digester.finish()
}

/// Whether any visible material has a pattern or a relief. They fade by the size of pixels, so views with different pixels
/// see different light.
fn shows_patterns(scene: &Scene) -> bool {
    let fades = |index: u32| {
        let material = &scene.shading.materials[index as usize];
        material.has_relief() || material.textures.iter().any(|(_, texture)| texture.has_pattern())
    };
    scene.geometry.materials().any(fades)
}

impl Preview {
    pub fn new(sequence: &Sequence) -> Self {
        let mut world = new_world(sequence);
        world.insert_resource(CurrentMoment(Moment::ONLY));
        let settings = FilmSettings::of(sequence);
        Self {
            world,
            schedule: update_schedule(),
            timeline: sequence.timeline,
            shutter: Shutter::new(sequence),
            exposure: sequence.output.exposure.clone(),
            settings,
            digests: Digests::default(),
            poses: None,
            shading_tick: None,
        }
    }

    /// A preview whose scenes have the meshes and trees that rays need.
    pub fn with_rays(sequence: &Sequence) -> Self {
        let mut preview = Self::new(sequence);
        preview.world.insert_resource(ShapeUse::Rays);
        preview
    }

    /// Evaluates a frame without regard to other frames of the same film.
    pub fn state(&mut self, frame: u32) -> FrameState {
        let time = self.timeline.clock(frame).start;
        let Some(fade) = self.shutter.cuts.cross_fade(time) else {
            return self.state_through(self.shutter.cuts.at(time), frame);
        };
        let through = |camera| {
            look_through(&mut self.world, Some(camera));
            self.state_through(camera, frame)
        };
        let [from, to] = [fade.from, fade.to].map(through);
        look_through(&mut self.world, None);
        FrameState::faded(fade, from, to)
    }

    /// Evaluates a frame through a camera, which is the active one.
    fn state_through(&mut self, camera: usize, frame: u32) -> FrameState {
        let moments = self.shutter.moments_of(camera, &self.timeline, frame);
        let mut found: Vec<MomentState> = Vec::with_capacity(moments.len());
        let (mut fault, mut geometry, mut rebuilds) = (None, None, 0);
        for &(clock, _) in &moments {
            match self.moment(clock) {
                Ok(one) => {
                    found.push(one);
                    let now = self.digests.primitives();
                    let (first, last) = *geometry.get_or_insert((now, now));
                    rebuilds += u32::from(last != now);
                    geometry = Some((first, now));
                }
                Err(why) => {
                    fault = Some(why);
                    break;
                }
            }
        }
        // If nothing moves while the shutter is open, one moment is enough.
        if fault.is_none() && found.windows(2).all(|pair| pair[0].looks_like(&pair[1])) {
            found.truncate(1);
        }
        let surroundings = found.first().map(|one| one.surroundings);
        let surroundings = surroundings.filter(|first| found.iter().all(|one| one.surroundings == *first));
        let random = found.len() > 1 || found.first().is_some_and(|one| one.random);
        // Frames with random numbers of their own share no paths.
        let own_noise = random && self.settings.varies_noise();
        let surroundings = surroundings.filter(|_| !own_noise);
        let viewpoint = match &found[..] {
            _ if own_noise => Err(ViewObstacle::Noise),
            [one] => one.viewpoint,
            _ => Err(ViewObstacle::Shutter),
        };
        let digester = |of: &dyn Fn(&MomentState) -> Digest| {
            let mut digester = Digester::new();
            self.settings.feed(random, frame, &mut digester);
            found.iter().map(|one| (of(one), one.random)).collect::<Vec<_>>().feed(&mut digester);
            fault.is_some().feed(&mut digester);
            digester
        };
        let image_hash = digester(&|one| one.image_hash).finish();
        let scene_hash = digester(&|one| one.scene_hash).finish();
        FrameState {
            frame,
            scene_hash,
            image_hash,
            weights: self.world.resource::<Current<Weights>>().0.0.clone(),
            weightings: Weightings::default(),
            own: 0,
            exposure: exposure(self.exposure.at(self.timeline.clock(frame).start)),
            moments: found.len() as u32,
            random,
            surroundings,
            viewpoint: viewpoint.ok(),
            view_obstacle: viewpoint.err(),
            views: None,
            geometry: geometry.unwrap_or_default(),
            rebuilds,
            faded: None,
            camera,
            poses: Digest::of(&found.iter().map(|one| one.poses).collect::<Vec<_>>()),
            neighbors: None,
            fault,
        }
    }

    /// Calls `see` with the scene at a frame's first moment; in a cross-fade, through the camera with the larger share.
    /// None if the scene has no camera then.
    pub fn scene_of<T>(&mut self, frame: u32, see: impl FnOnce(&Scene) -> T) -> Option<T> {
        let camera = self.shutter.cuts.leading(self.timeline.clock(frame).start);
        let (clock, _) = *self.shutter.moments_of(camera, &self.timeline, frame).first()?;
        look_through(&mut self.world, Some(camera));
        let moment = self.moment(clock);
        look_through(&mut self.world, None);
        moment.ok()?;
        let (geometry, shading) = (&self.current::<Geometry>()?.0, &self.current::<Shading>()?.0);
        let (weights, camera) = (&self.current::<Weights>()?.0, &self.current::<Option<Camera>>()?.0);
        Some(see(&Scene { geometry, shading, weights, camera: camera.as_ref()? }))
    }

    fn current<T: Send + Sync + 'static>(&self) -> Option<&Current<T>> {
        self.world.get_resource()
    }

    /// The view of a scene's camera, or why it cannot share samples.
    fn view(&self, scene: &Scene) -> Result<View, ViewObstacle> {
        if !self.settings.shares_views() {
            return Err(ViewObstacle::Neighbors);
        }
        match View::of(scene.camera) {
            None if scene.camera.lens.is_some() => Err(ViewObstacle::Lens),
            None => Err(ViewObstacle::Parallel),
            Some(_) if shows_patterns(scene) => Err(ViewObstacle::Pattern),
            Some(view) => Ok(view),
        }
    }

    fn moment(&mut self, clock: Clock) -> Result<MomentState, NoCamera> {
        self.world.insert_resource(Now(clock));
        self.world.resource_mut::<Stopwatch>().start();
        self.schedule.run(&mut self.world);
        self.world.clear_trackers();
        if let Some(why) = self.world.resource_mut::<FirstError>().no_camera() {
            return Err(why);
        }
        let world = &self.world;
        let (Some(geometry), Some(shading)) =
            (world.get_resource_ref::<Current<Geometry>>(), world.get_resource_ref::<Current<Shading>>())
        else {
            return Err(NoCamera::NotFinite);
        };
        let shading_tick = Some(shading.last_changed());
        self.digests.update(&geometry.0, &shading.0, self.shading_tick != shading_tick);
        self.shading_tick = shading_tick;
        let camera = &world.resource::<Current<Option<Camera>>>().0;
        let Some(camera) = camera else { return Err(NoCamera::NotFinite) };
        let weights = &world.resource::<Current<Weights>>().0;
        let scene = Scene { geometry: &geometry.0, shading: &shading.0, weights, camera };
        let integrator = self.settings.integrator();
        let random = is_random(&scene, integrator);
        let image_hash = self.digests.image_hash(&scene, integrator.samples_lights());
        let surroundings = Digest::of(&(self.digests.surroundings(&scene), random));
        let viewpoint = self.view(&scene).map(|view| {
            let everywhere = Camera {
                basis: Basis::AXES,
                projection: Projection::Perspective { half_height: 1.0 },
                ..*camera
            };
            let scene = Scene { camera: &everywhere, ..scene };
            (Digest::of(&(self.digests.scene_hash(&scene), random)), view)
        });
        let scene_hash = self.digests.scene_hash(&scene);
        let poses = match self.poses {
            _ if !self.settings.uses_neighbors() => Digest::default(),
            Some((revision, known)) if revision == geometry.0.revision() => known,
            _ => self.poses.insert((geometry.0.revision(), poses(&geometry.0))).1,
        };
        Ok(MomentState { scene_hash, image_hash, random, surroundings, viewpoint, poses })
    }
}
