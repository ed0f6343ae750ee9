//! Frames of which only a few blocks are traced, to find what all of them would take.

use super::stages::{Faults, Shown, Stopwatch, accelerate};
use super::{Look, Shutter, Stage, seen, unseen};
use crate::base::clock::{Clock, Took, timed};
use crate::base::color::Rgb;
use crate::base::stats::Counts;
use crate::base::time::Timeline;
use crate::camera::Camera;
use crate::film::filter::FilterSampler;
use crate::film::{Extras, LayerId};
use crate::scene::top_level::Bvh;
use crate::scene::{Geometry, Scene, Shading, Weights};
use crate::sequence::Sequence;
use crate::trace::{Moment, Probe, TraceSettings};
use crate::world::{Current, Now, sky_table};
use bevy_ecs::schedule::common_conditions::resource_changed;
use bevy_ecs::schedule::{IntoScheduleConfigs, Schedule};
use bevy_ecs::world::World;
use std::ops::Range;

/// A sequence's world with all that tracing needs, and nothing that makes frames.
pub struct Prober {
    world: World,
    schedule: Schedule,
    timeline: Timeline,
    shutter: Shutter,
    settings: TraceSettings,
    /// By what it tells the time.
    clock: Clock,
}

/// What a pass over all moments of a frame took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Probed {
    /// To put things in their places and build trees.
    pub prepare: Took,
    pub trace: Took,
    pub rays: u64,
}

impl Prober {
    pub fn new(sequence: &Sequence, extras: Extras, clock: Clock) -> Self {
        let mut world = unseen(sequence);
        world.resource_mut::<Current<Shading>>().0.sky_table = sky_table(sequence);
        world.insert_resource(Current(Bvh::default()));
        let settings = TraceSettings {
            size: sequence.output.size,
            quality: sequence.quality,
            filter: FilterSampler::new(sequence.quality.filter),
            extras,
        };
        let mut schedule = seen();
        let rebuilt = accelerate.run_if(resource_changed::<Current<Geometry>>);
        schedule.add_systems(rebuilt.in_set(Stage::Accelerate));
        let (timeline, shutter) = (sequence.timeline, Shutter::new(sequence));
        Self { world, schedule, timeline, shutter, settings, clock }
    }

    /// A probe of so many blocks of a frame.
    pub fn probe(&self, look: &Look, blocks: usize) -> Probe {
        let layers = look.weights.len() + self.settings.extras.layers();
        Probe::new(self.settings.size, blocks, layers, self.settings.quality.seed)
    }

    /// Traces these samples of all pixels of the probe, with these layers of light. Nothing if the frame has no camera.
    pub fn pass(
        &mut self,
        look: &Look,
        lit: &[LayerId],
        probe: &mut Probe,
        samples: &Range<u32>,
    ) -> Option<Probed> {
        let mut moments = self.shutter.moments(&self.timeline, look.frame);
        if look.moments == 1 {
            moments.truncate(1);
            moments.iter_mut().for_each(|(_, moment)| *moment = Moment::ONLY);
        }
        let mut weights = Weights(vec![Rgb::ZERO; look.weights.len()]);
        lit.iter().for_each(|layer| weights.0[layer.index()] = Rgb::ONE);
        let mut done = Probed { prepare: Took::ZERO, trace: Took::ZERO, rays: 0 };
        probe.begin_pass();
        for (now, moment) in moments {
            let (ready, took) = timed(|| self.prepare(now, moment));
            ready?;
            let (counts, traced) = timed(|| self.trace(&weights, moment, look.random, probe, samples));
            let rays = counts?.rays.total();
            done.prepare = done.prepare + self.clock.told(took, 0);
            done.trace = done.trace + self.clock.told(traced, rays);
            done.rays += rays;
        }
        Some(done)
    }

    /// Runs the stages up to Accelerate.
    fn prepare(&mut self, now: crate::base::time::Clock, moment: Moment) -> Option<()> {
        self.world.insert_resource(Now(now));
        self.world.insert_resource(Shown(moment));
        self.world.resource_mut::<Stopwatch>().start();
        self.schedule.run(&mut self.world);
        self.world.clear_trackers();
        self.world.resource_mut::<Faults>().take().ok()
    }

    fn trace(
        &self,
        weights: &Weights,
        moment: Moment,
        random: bool,
        probe: &mut Probe,
        samples: &Range<u32>,
    ) -> Option<Counts> {
        let (geometry, shading) =
            (&self.world.resource::<Current<Geometry>>().0, &self.world.resource::<Current<Shading>>().0);
        let camera = self.world.resource::<Current<Option<Camera>>>().0.as_ref()?;
        let scene = Scene { geometry, shading, weights, camera };
        Some(probe.trace(
            &scene,
            &self.world.resource::<Current<Bvh>>().0,
            &self.settings,
            (moment, random),
            samples,
        ))
    }
}
