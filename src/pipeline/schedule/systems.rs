//! The systems and their order. No other file knows the order.

use super::stages::{
    FilmSink, FirstError, FrameStage, Stats, Stopwatch, accelerate, begin, count_geometry, count_shading,
    encode, keep_camera_error, keep_error, keep_mesh_fault, lap, no_error, trace_frame,
};
use crate::base::color::Rgb;
use crate::camera::Camera;
use crate::scene::{Geometry, Shading, Weights, extract};
use crate::sequence::Sequence;
use crate::world::animate;
use crate::world::{Current, LightSetup, ShapeUse, SlotCount, spawn};
use bevy_ecs::schedule::common_conditions::resource_changed;
use bevy_ecs::schedule::{
    IntoScheduleConfigs, LogLevel, Schedule, ScheduleBuildSettings, SingleThreadedExecutor,
};
use bevy_ecs::system::IntoSystem;
use bevy_ecs::world::World;

/// A world of the sequence with the resources that the stages up to Extract use.
pub fn new_world(sequence: &Sequence) -> World {
    let mut world = spawn(sequence);
    let LightSetup { ambient, layers } = *world.resource::<LightSetup>();
    let SlotCount(slots) = *world.resource::<SlotCount>();
    world.insert_resource(Current(Geometry::with_slots(slots as usize)));
    world.insert_resource(Current(Shading { ambient, ..Shading::default() }));
    world.insert_resource(Current(Weights(vec![Rgb::ONE; layers])));
    world.insert_resource(Current(None::<Camera>));
    world.insert_resource(ShapeUse::default());
    world.insert_resource(FirstError::default());
    world.insert_resource(Stopwatch::default());
    world.insert_resource(Stats::default());
    world
}

/// A chain of the stages up to Extract. Systems of one stage must access different data; otherwise, building the
/// schedule fails.
pub fn update_schedule() -> Schedule {
    let mut schedule = Schedule::default();
    schedule.set_executor(SingleThreadedExecutor::new());
    schedule.set_build_settings(ScheduleBuildSettings {
        ambiguity_detection: LogLevel::Error,
        ..ScheduleBuildSettings::default()
    });
    schedule.configure_sets(
        (
            FrameStage::Animate,
            FrameStage::Extract,
            FrameStage::Accelerate,
            FrameStage::Trace,
            FrameStage::Encode,
        )
            .chain(),
    );
    let camera = animate::camera.pipe(keep_camera_error);
    let series = animate::series.pipe(keep_mesh_fault);
    let deformed = animate::deformed.pipe(keep_mesh_fault);
    // Hidden objects load nothing, and a camera may focus on an object.
    let placed = (animate::transforms, animate::cuts, series, deformed, animate::particles, camera).chain();
    let animated = (
        placed,
        animate::table_rows,
        animate::materials,
        animate::lights,
        animate::sky_and_fog,
        animate::weights,
    );
    let begun = begin(FrameStage::Animate);
    schedule.add_systems((begun, animated, lap(FrameStage::Animate)).chain().in_set(FrameStage::Animate));
    let packed = (
        begin(FrameStage::Extract),
        (extract::geometry, count_geometry).chain().run_if(extract::geometry_changed),
        (extract::shading, count_shading).chain().run_if(extract::shading_changed),
        extract::weights.run_if(extract::weights_changed),
        lap(FrameStage::Extract),
    );
    schedule.add_systems(packed.chain().in_set(FrameStage::Extract));
    schedule
}

/// All stages.
pub fn schedule<S: FilmSink>() -> Schedule {
    let mut schedule = update_schedule();
    let rebuilt = accelerate.run_if(resource_changed::<Current<Geometry>>);
    let begun = begin(FrameStage::Accelerate);
    schedule
        .add_systems((begun, rebuilt, lap(FrameStage::Accelerate)).chain().in_set(FrameStage::Accelerate));
    schedule.add_systems(
        (begin(FrameStage::Trace), trace_frame.run_if(no_error), lap(FrameStage::Trace))
            .chain()
            .in_set(FrameStage::Trace),
    );
    let encoded = encode::<S>.pipe(keep_error).run_if(no_error);
    let begun = begin(FrameStage::Encode);
    schedule.add_systems((begun, encoded, lap(FrameStage::Encode)).chain().in_set(FrameStage::Encode));
    schedule
}
