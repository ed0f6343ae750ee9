//! A sequence's world with the systems up to Accelerate: what tracing needs, for those who trace in their own way.

use super::cross_fade::look_through;
use super::frame_state::FrameState;
use super::shutter::Shutter;
use super::stages::{CurrentMoment, FirstError, FrameError, FrameStage, Stopwatch, accelerate, empty_bvh};
use super::systems::{new_world, update_schedule};
use crate::base::time::{Clock, Timeline};
use crate::camera::Camera;
use crate::film::AovSet;
use crate::film::filter::FilterSampler;
use crate::scene::top_level::Bvh;
use crate::scene::{Geometry, Scene, Shading, Weights};
use crate::sequence::Sequence;
use crate::sequence::quality::Quality;
use crate::trace::{Moment, TraceSettings};
use crate::world::{Current, Now, ShapeUse, sky_table};
use bevy_ecs::schedule::common_conditions::resource_changed;
use bevy_ecs::schedule::{IntoScheduleConfigs, Schedule};
use bevy_ecs::world::World;

/// A world that is brought to moments.
pub struct PreparedWorld {
    world: World,
    schedule: Schedule,
    timeline: Timeline,
    shutter: Shutter,
    quality: Quality,
    /// The settings of the frame that was prepared last.
    pub settings: TraceSettings,
}

impl PreparedWorld {
    pub fn new(sequence: &Sequence, aovs: AovSet) -> Self {
        let mut world = new_world(sequence);
        world.resource_mut::<Current<Shading>>().0.sky_table = sky_table(sequence);
        world.insert_resource(ShapeUse::Rays);
        world.insert_resource(empty_bvh(&sequence.quality));
        let settings = TraceSettings {
            size: sequence.output.size,
            quality: sequence.quality,
            filter: FilterSampler::new(sequence.quality.filter),
            aovs,
            first_sample: 0,
        };
        let mut schedule = update_schedule();
        let rebuilt = accelerate.run_if(resource_changed::<Current<Geometry>>);
        schedule.add_systems(rebuilt.in_set(FrameStage::Accelerate));
        let (timeline, shutter) = (sequence.timeline, Shutter::new(sequence));
        Self { world, schedule, timeline, shutter, quality: sequence.quality, settings }
    }

    /// The moments of a frame, or the first one only if all are equal.
    pub fn moments(&self, state: &FrameState) -> Vec<(Clock, Moment)> {
        let mut moments = self.shutter.moments(&self.timeline, state.frame);
        if state.moments == 1 {
            moments.truncate(1);
            moments.iter_mut().for_each(|(_, moment)| *moment = Moment::ONLY);
        }
        moments
    }

    /// The seed of a frame.
    pub fn seed_of(&self, frame: u32) -> u32 {
        self.quality.of_frame(frame).seed
    }

    /// Makes a camera the active one at all times; None for the camera that the sequence chooses.
    pub fn look_through(&mut self, camera: Option<usize>) {
        look_through(&mut self.world, camera);
    }

    /// The active camera.
    pub fn camera(&self) -> Option<Camera> {
        self.world.get_resource::<Current<Option<Camera>>>()?.0
    }

    /// Runs the stages up to Accelerate.
    pub fn prepare(&mut self, now: Clock, moment: Moment) -> Result<(), FrameError> {
        self.settings.quality = self.quality.of_frame(now.frame);
        self.world.insert_resource(Now(now));
        self.world.insert_resource(CurrentMoment(moment));
        self.world.resource_mut::<Stopwatch>().start();
        self.schedule.run(&mut self.world);
        self.world.clear_trackers();
        self.world.resource_mut::<FirstError>().take()
    }

    /// The scene and its tree. None if it has no camera.
    pub fn scene<'a>(&'a self, weights: &'a Weights) -> Option<(Scene<'a>, &'a Bvh)> {
        let geometry = &self.world.get_resource::<Current<Geometry>>()?.0;
        let shading = &self.world.get_resource::<Current<Shading>>()?.0;
        let camera = self.world.get_resource::<Current<Option<Camera>>>()?.0.as_ref()?;
        let bvh = &self.world.get_resource::<Current<Bvh>>()?.0;
        Some((Scene { geometry, shading, weights, camera }, bvh))
    }
}
