//! Frames looked at without tracing: what each of them evaluates to.

use super::stages::{Faults, Shown, Stopwatch};
use super::{Shutter, seen, unseen};
use crate::base::color::Rgb;
use crate::base::digest::{Content, Digest, Digester};
use crate::base::time::{Clock, Timeline};
use crate::camera::Camera;
use crate::camera::path::NoCamera;
use crate::film::{LayerId, exposure, lit};
use crate::scene::{Digests, Geometry, Scene, Shading, Weights};
use crate::sequence::Sequence;
use crate::sequence::quality::{Integrator, Quality};
use crate::trace::{Moment, Weightings, is_random};
use crate::track::Animated;
use crate::world::{Current, Now};
use bevy_ecs::change_detection::{DetectChanges, Tick};
use bevy_ecs::schedule::Schedule;
use bevy_ecs::world::World;
use std::collections::BTreeSet;

/// A sequence's world without anything that traces.
pub struct Preview {
    world: World,
    schedule: Schedule,
    timeline: Timeline,
    shutter: Shutter,
    exposure: Animated<f64>,
    /// What is the same in all frames.
    settings: Settings,
    digests: Digests,
    /// When geometry and shading had changed last.
    changed: Option<(Tick, Tick)>,
}

/// What a frame evaluates to: see [`super::looks`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Look {
    pub frame: u32,
    /// All that decides which light each layer holds, at every moment at which the frame is traced: geometry, materials,
    /// where lights are, sky, fog, cameras, and the settings of quality that are called for. What has no strength has no
    /// part in it.
    pub transport: Digest,
    /// What of light the frame shows: equal digests, equal radiance. What shines in layers of weight 0 has no part in it.
    pub radiance: Digest,
    /// What each layer is weighted with.
    pub weights: Vec<Rgb>,
    /// The weights of all frames of the sequence that are made of the same film, where they decide how it is sampled.
    pub shown: Weightings,
    /// Which of them are the frame's own, or weight what is not dark alike.
    pub own: usize,
    /// Factor of the displayed picture.
    pub exposure: f32,
    /// Moments at which the frame is traced: one, unless something moves while the shutter is open.
    pub moments: u32,
    /// Whether samples are drawn at random.
    pub random: bool,
    /// The geometry at the first and the last moment, and how often it changes in between.
    pub geometry: (Digest, Digest),
    pub rebuilds: u32,
    /// Why the frame cannot be traced.
    pub fault: Option<NoCamera>,
}

impl Look {
    /// What the frame looks like: equal digests, equal radiance and exposure.
    pub fn digest(&self) -> Digest {
        Digest::of(&(self.radiance, self.exposure))
    }

    /// What all layers of the frame's film hold and are weighted with, dark ones too.
    pub fn film(&self) -> Digest {
        Digest::of(&(self.transport, self.weighted()))
    }

    /// The layers of light that a film of the frame is traced with, ascending: those that show in it, or in any frame that has a
    /// say in how it is sampled.
    pub fn lit(&self) -> Vec<LayerId> {
        let others = self.shown.iter().flat_map(|weights| lit(weights));
        lit(&self.weights).chain(others).collect::<BTreeSet<_>>().into_iter().collect()
    }

    /// Has the frame be made of a film that is sampled for all of these weights, of which it has one. Films that are sampled for
    /// different frames are not the same.
    pub(super) fn share(&mut self, frames: Digest, shown: Weightings, own: usize) {
        (self.shown, self.own) = (shown, own);
        self.transport = Digest::of(&(self.transport, frames));
        self.radiance = Digest::of(&(self.radiance, frames));
    }

    /// The layers that show, with their weights.
    fn weighted(&self) -> Vec<(u32, Rgb)> {
        let weighted = |(_, weight): &(u32, Rgb)| *weight != Rgb::ZERO;
        (0..).zip(self.weights.iter().copied()).filter(weighted).collect()
    }
}

/// A look at one moment.
#[derive(PartialEq)]
struct Sight {
    /// What light meets.
    transport: Digest,
    /// What is seen with the weights of the frame.
    radiance: Digest,
    /// Whether the moment alone calls for random samples.
    random: bool,
}

/// The settings that change films.
struct Settings {
    size: (u32, u32),
    coverage: bool,
    quality: Quality,
}

impl Preview {
    pub fn new(sequence: &Sequence) -> Self {
        let mut world = unseen(sequence);
        world.insert_resource(Shown(Moment::ONLY));
        let settings = Settings {
            size: sequence.output.size,
            coverage: sequence.output.transparent,
            quality: sequence.quality,
        };
        Self {
            world,
            schedule: seen(),
            timeline: sequence.timeline,
            shutter: Shutter::new(sequence),
            exposure: sequence.output.exposure.clone(),
            settings,
            digests: Digests::default(),
            changed: None,
        }
    }

    /// What a frame evaluates to, without a word of other frames that are made of the same film.
    pub(super) fn look(&mut self, frame: u32) -> Look {
        let moments = self.shutter.moments(&self.timeline, frame);
        let mut found: Vec<Sight> = Vec::with_capacity(moments.len());
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
        // What stands still while the shutter is open is one moment.
        if fault.is_none() && found.windows(2).all(|pair| pair[0] == pair[1]) {
            found.truncate(1);
        }
        let random = found.len() > 1 || found.first().is_some_and(|one| one.random);
        let digester = |of: &dyn Fn(&Sight) -> Digest| {
            let mut digester = Digester::new();
            self.settings.feed(random, &mut digester);
            found.iter().map(|one| (of(one), one.random)).collect::<Vec<_>>().feed(&mut digester);
            fault.is_some().feed(&mut digester);
            digester
        };
        let radiance = digester(&|one| one.radiance).finish();
        let transport = digester(&|one| one.transport).finish();
        Look {
            frame,
            transport,
            radiance,
            weights: self.world.resource::<Current<Weights>>().0.0.clone(),
            shown: Weightings::default(),
            own: 0,
            exposure: exposure(self.exposure.at(self.timeline.clock(frame).start)),
            moments: found.len() as u32,
            random,
            geometry: geometry.unwrap_or_default(),
            rebuilds,
            fault,
        }
    }

    /// Hands the scene at a frame's first moment over; nothing if it has no camera then.
    pub fn scene_of<T>(&mut self, frame: u32, see: impl FnOnce(&Scene) -> T) -> Option<T> {
        let (clock, _) = *self.shutter.moments(&self.timeline, frame).first()?;
        self.moment(clock).ok()?;
        let (geometry, shading) = (&self.current::<Geometry>()?.0, &self.current::<Shading>()?.0);
        let (weights, camera) = (&self.current::<Weights>()?.0, &self.current::<Option<Camera>>()?.0);
        Some(see(&Scene { geometry, shading, weights, camera: camera.as_ref()? }))
    }

    fn current<T: Send + Sync + 'static>(&self) -> Option<&Current<T>> {
        self.world.get_resource()
    }

    fn moment(&mut self, clock: Clock) -> Result<Sight, NoCamera> {
        self.world.insert_resource(Now(clock));
        self.world.resource_mut::<Stopwatch>().start();
        self.schedule.run(&mut self.world);
        self.world.clear_trackers();
        if let Some(why) = self.world.resource_mut::<Faults>().no_camera() {
            return Err(why);
        }
        let world = &self.world;
        let (Some(geometry), Some(shading)) =
            (world.get_resource_ref::<Current<Geometry>>(), world.get_resource_ref::<Current<Shading>>())
        else {
            return Err(NoCamera::NotFinite);
        };
        let now = (geometry.last_changed(), shading.last_changed());
        if self.changed != Some(now) {
            if self.changed.map(|(geometry, _)| geometry) != Some(now.0) {
                self.digests.geometry(&geometry.0);
            }
            self.digests.shading(&geometry.0, &shading.0);
            self.changed = Some(now);
        }
        let camera = &world.resource::<Current<Option<Camera>>>().0;
        let Some(camera) = camera else { return Err(NoCamera::NotFinite) };
        let weights = &world.resource::<Current<Weights>>().0;
        let scene = Scene { geometry: &geometry.0, shading: &shading.0, weights, camera };
        let integrator = self.settings.quality.integrator;
        let random = is_random(&scene, integrator);
        let radiance = self.digests.radiance(&scene, integrator.looks_for_lights());
        Ok(Sight { transport: self.digests.transport(&scene), radiance, random })
    }
}

impl Settings {
    /// Those that a film with or without random samples asks for.
    fn feed(&self, random: bool, into: &mut Digester) {
        let Self { size: (width, height), coverage, quality } = self;
        let Quality { integrator, bounces, filter, antialias, samples, .. } = quality;
        let Quality { threshold, clamp, smooth_terminator, seed, noise, points, shutter_steps: _, .. } =
            quality;
        (*width, *height, *coverage).feed(into);
        (integrator, *bounces, filter).feed(into);
        (*clamp, *smooth_terminator, random).feed(into);
        if *integrator == Integrator::Whitted {
            threshold.feed(into);
        }
        if random {
            (*seed, points).feed(into);
            match noise {
                Some(target) => target.feed(into),
                None => samples.feed(into),
            }
        } else {
            antialias.feed(into);
        }
    }
}
