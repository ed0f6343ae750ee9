//! Traces a few blocks of a frame to measure what all of them would cost.

use super::frame_state::FrameState;
use super::shutter::Shutter;
use super::stages::{CurrentMoment, FirstError, FrameStage, Stopwatch, accelerate};
use super::systems::{new_world, update_schedule};
use crate::base::clock::{ElapsedTime, TimeSource, timed};
use crate::base::color::Rgb;
use crate::base::stats::Counts;
use crate::base::time::Timeline;
use crate::camera::Camera;
use crate::film::filter::FilterSampler;
use crate::film::{AovSet, LayerId};
use crate::scene::top_level::Bvh;
use crate::scene::{Geometry, Scene, Shading, Weights};
use crate::sequence::Sequence;
use crate::trace::{Moment, PilotBlocks, TraceSettings};
use crate::world::{Current, Now, sky_table};
use bevy_ecs::schedule::common_conditions::resource_changed;
use bevy_ecs::schedule::{IntoScheduleConfigs, Schedule};
use bevy_ecs::world::World;
use std::ops::Range;

/// A sequence's world with the systems up to Accelerate.
pub struct Prober {
    world: World,
    schedule: Schedule,
    timeline: Timeline,
    shutter: Shutter,
    settings: TraceSettings,
    /// Measures the time of a pass.
    clock: TimeSource,
}

/// The cost of a pass over all moments of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PassCost {
    /// Time to place objects and build trees.
    pub prepare: ElapsedTime,
    pub trace: ElapsedTime,
    pub rays: u64,
}

impl Prober {
    pub fn new(sequence: &Sequence, aovs: AovSet, clock: TimeSource) -> Self {
        let mut world = new_world(sequence);
        world.resource_mut::<Current<Shading>>().0.sky_table = sky_table(sequence);
        world.insert_resource(Current(Bvh::default()));
        let settings = TraceSettings {
            size: sequence.output.size,
            quality: sequence.quality,
            filter: FilterSampler::new(sequence.quality.filter),
            aovs,
        };
        let mut schedule = update_schedule();
        let rebuilt = accelerate.run_if(resource_changed::<Current<Geometry>>);
        schedule.add_systems(rebuilt.in_set(FrameStage::Accelerate));
        let (timeline, shutter) = (sequence.timeline, Shutter::new(sequence));
        Self { world, schedule, timeline, shutter, settings, clock }
    }

    /// A probe of this number of blocks of a frame.
    pub fn probe(&self, state: &FrameState, blocks: usize) -> PilotBlocks {
        let layers = state.weights.len() + self.settings.aovs.layers();
        PilotBlocks::new(self.settings.size, blocks, layers, self.settings.quality.seed)
    }

    /// Traces `samples` of all pixels of the probe with the layers `lit`. None if the frame has no camera.
    pub fn pass(
        &mut self,
        state: &FrameState,
        lit: &[LayerId],
        probe: &mut PilotBlocks,
        samples: &Range<u32>,
    ) -> Option<PassCost> {
        let mut moments = self.shutter.moments(&self.timeline, state.frame);
        if state.moments == 1 {
            moments.truncate(1);
            moments.iter_mut().for_each(|(_, moment)| *moment = Moment::ONLY);
        }
        let mut weights = Weights(vec![Rgb::ZERO; state.weights.len()]);
        lit.iter().for_each(|layer| weights.0[layer.index()] = Rgb::ONE);
        let mut done = PassCost { prepare: ElapsedTime::ZERO, trace: ElapsedTime::ZERO, rays: 0 };
        probe.begin_pass();
        for (now, moment) in moments {
            let (ready, took) = timed(|| self.prepare(now, moment));
            ready?;
            let (counts, traced) = timed(|| self.trace(&weights, moment, state.random, probe, samples));
            let rays = counts?.rays.total();
            done.prepare = done.prepare + self.clock.elapsed(took, 0);
            done.trace = done.trace + self.clock.elapsed(traced, rays);
            done.rays += rays;
        }
        Some(done)
    }

    /// Runs the stages up to Accelerate.
    fn prepare(&mut self, now: crate::base::time::Clock, moment: Moment) -> Option<()> {
        self.world.insert_resource(Now(now));
        self.world.insert_resource(CurrentMoment(moment));
        self.world.resource_mut::<Stopwatch>().start();
        self.schedule.run(&mut self.world);
        self.world.clear_trackers();
        self.world.resource_mut::<FirstError>().take().ok()
    }

    fn trace(
        &self,
        weights: &Weights,
        moment: Moment,
        random: bool,
        probe: &mut PilotBlocks,
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
