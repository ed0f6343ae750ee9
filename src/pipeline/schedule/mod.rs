//! The frame's systems and their order: the only file that names it.

mod looks;
mod preview;
mod prober;
mod shutter;
mod stages;
#[cfg(test)]
mod tests;

pub use looks::looks;
pub use preview::{Look, Preview};
pub use prober::{Probed, Prober};
pub use stages::{FilmSink, Films, NoFrame, Stage, Tally};

use crate::base::cancel::Stop;
use crate::base::color::Rgb;
use crate::base::stats::Meter;
use crate::base::time::Timeline;
use crate::camera::Camera;
use crate::film::filter::FilterSampler;
use crate::film::{Extras, Film, LayerId};
use crate::scene::top_level::Bvh;
use crate::scene::{Geometry, Shading, Weights, extract};
use crate::sequence::Sequence;
use crate::trace::{Moment, TraceSettings};
use crate::world::animate;
use crate::world::{Current, Glows, Now, sky_table, spawn};
use bevy_ecs::schedule::common_conditions::resource_changed;
use bevy_ecs::schedule::{
    IntoScheduleConfigs, LogLevel, Schedule, ScheduleBuildSettings, SingleThreadedExecutor,
};
use bevy_ecs::system::IntoSystem;
use bevy_ecs::world::World;
use shutter::Shutter;
use stages::{Exposed, Exposure, Faults, Settings, Shown, Sink, Stopwatch, Wanted, Watched};
use std::marker::PhantomData;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::time::Instant;

/// A sequence's world and the systems that make frames of it.
pub struct FrameLoop<S> {
    world: World,
    schedule: Schedule,
    timeline: Timeline,
    shutter: Shutter,
    /// Tells which frames have something that moves while the shutter is open; none if it never is.
    preview: Option<Preview>,
    /// Where other frames have a say in how one is sampled: where an error is asked for.
    sampled: Option<Arc<Sequence>>,
    sink: PhantomData<S>,
}

impl<S: FilmSink> FrameLoop<S> {
    /// Films go to `sink` in the order in which frames are asked for.
    pub fn new(sequence: &Sequence, sink: S, meter: Arc<Meter>) -> Self {
        Self::with_extras(sequence, Extras::default(), sink, meter)
    }

    /// The same for films that record `extras` besides light.
    pub fn with_extras(sequence: &Sequence, extras: Extras, sink: S, meter: Arc<Meter>) -> Self {
        let mut world = unseen(sequence);
        world.resource_mut::<Current<Shading>>().0.sky_table = sky_table(sequence);
        world.insert_resource(Current(Bvh::default()));
        world.insert_resource(Settings(TraceSettings {
            size: sequence.output.size,
            quality: sequence.quality,
            filter: FilterSampler::new(sequence.quality.filter),
            extras,
        }));
        world.insert_resource(Exposure(sequence.output.exposure.clone()));
        world.insert_resource(Exposed::default());
        world.insert_resource(Wanted::default());
        world.insert_resource(Sink(sink));
        world.insert_resource(Watched(meter));
        let (timeline, shutter) = (sequence.timeline, Shutter::new(sequence));
        let preview = sequence.blurs_motion().then(|| Preview::new(sequence));
        let sampled = sequence.quality.noise.is_some().then(|| Arc::new(sequence.clone()));
        Self { world, schedule: schedule::<S>(), timeline, shutter, preview, sampled, sink: PhantomData }
    }

    /// Makes one frame by itself and hands its film to the sink. After an error no further frame can be made.
    pub fn frame(&mut self, frame: u32) -> Result<(), NoFrame> {
        if let Some(sequence) = self.sampled.clone()
            && let [look] = &looks(&sequence, &[frame], &Stop::default())[..]
        {
            return self.trace_alone(look);
        }
        let still = self.preview.as_mut().is_none_or(|preview| preview.look(frame).moments == 1);
        self.run(frame, still)
    }

    /// Makes a frame that has been looked at, traced with these layers of light, among them all that it shows. Its film is
    /// given back.
    pub fn trace(&mut self, look: &Look, lit: &[LayerId]) -> Result<Option<Film>, NoFrame> {
        self.take(look, lit, true)?;
        Ok(self.world.resource_mut::<Exposed>().kept.take())
    }

    /// Makes a frame that has been looked at by itself.
    pub fn trace_alone(&mut self, look: &Look) -> Result<(), NoFrame> {
        self.take(look, &look.lit(), false)
    }

    fn take(&mut self, look: &Look, lit: &[LayerId], keep: bool) -> Result<(), NoFrame> {
        let mut weights = vec![Rgb::ZERO; look.weights.len()];
        lit.iter().for_each(|layer| weights[layer.index()] = Rgb::ONE);
        self.world.insert_resource(Wanted {
            lit: Some(Weights(weights)),
            shown: Arc::clone(&look.shown),
            own: look.own,
            keep,
        });
        let done = self.run(look.frame, look.moments == 1);
        self.world.insert_resource(Wanted::default());
        done
    }

    /// Makes a frame that has been looked at of the film of another frame of the same transport, which holds all layers
    /// that this one shows.
    pub fn reuse(&mut self, look: &Look, film: &Film) -> Result<(), NoFrame> {
        let start = Instant::now();
        let film = Film { exposure: look.exposure, ..film.shown_as(look.own, &look.weights) };
        let pushed = self.world.resource_mut::<Sink<S>>().0.push(look.frame, film);
        let mut tally = self.world.resource_mut::<Tally>();
        tally.reused += 1;
        tally.stages[Stage::Encode as usize] += start.elapsed();
        let meter = &self.world.resource::<Watched>().0;
        meter.reused.fetch_add(1, Relaxed);
        meter.frames.fetch_add(1, Relaxed);
        pushed.map_err(NoFrame::Encode)
    }

    /// Runs the stages for a frame: for every moment while the shutter is open, or for the first if all are alike.
    fn run(&mut self, frame: u32, still: bool) -> Result<(), NoFrame> {
        let mut moments = self.shutter.moments(&self.timeline, frame);
        if still {
            moments.truncate(1);
            moments.iter_mut().for_each(|(_, moment)| *moment = Moment::ONLY);
        }
        loop {
            for &(clock, moment) in &moments {
                self.world.insert_resource(Now(clock));
                self.world.insert_resource(Shown(moment));
                self.world.resource_mut::<Stopwatch>().start();
                self.schedule.run(&mut self.world);
                // Without this, removals of components pile up for ever.
                self.world.clear_trackers();
                self.world.resource_mut::<Faults>().take()?;
            }
            if !self.world.resource::<Exposed>().goes_on() {
                return Ok(());
            }
        }
    }

    /// What has been done so far.
    pub fn tally(&self) -> &Tally {
        self.world.resource::<Tally>()
    }

    /// Does something with the sink.
    pub fn with_sink<T>(&mut self, act: impl FnOnce(&mut S) -> T) -> T {
        act(&mut self.world.resource_mut::<Sink<S>>().0)
    }

    /// Ends the loop and gives the sink back.
    pub fn into_sink(mut self) -> Option<S> {
        self.world.remove_resource::<Sink<S>>().map(|sink| sink.0)
    }
}

/// A world of the sequence with what the stages up to Extract read and write.
fn unseen(sequence: &Sequence) -> World {
    let mut world = spawn(sequence);
    let Glows { ambient, layers } = *world.resource::<Glows>();
    world.insert_resource(Current(Geometry::default()));
    world.insert_resource(Current(Shading { ambient, ..Shading::default() }));
    world.insert_resource(Current(Weights(vec![Rgb::ONE; layers])));
    world.insert_resource(Current(None::<Camera>));
    world.insert_resource(Faults::default());
    world.insert_resource(Stopwatch::default());
    world.insert_resource(Tally::default());
    world
}

/// One chain of stages, up to Extract. Systems of one stage touch different data; two that did not would be refused.
fn seen() -> Schedule {
    use stages::*;
    let mut schedule = Schedule::default();
    schedule.set_executor(SingleThreadedExecutor::new());
    schedule.set_build_settings(ScheduleBuildSettings {
        ambiguity_detection: LogLevel::Error,
        ..ScheduleBuildSettings::default()
    });
    schedule.configure_sets(
        (Stage::Animate, Stage::Extract, Stage::Accelerate, Stage::Trace, Stage::Encode).chain(),
    );
    let camera = animate::camera.pipe(keep_camera_fault);
    // A camera may focus on an object, so objects are placed first.
    let placed = (animate::transforms, camera).chain();
    let animated = (placed, animate::materials, animate::lights, animate::air, animate::weights);
    schedule.add_systems((animated, lap(Stage::Animate)).chain().in_set(Stage::Animate));
    let packed = (
        (extract::geometry, count_geometry).chain().run_if(extract::geometry_changed),
        (extract::shading, count_shading).chain().run_if(extract::shading_changed),
        extract::weights.run_if(extract::weights_changed),
        lap(Stage::Extract),
    );
    schedule.add_systems(packed.chain().in_set(Stage::Extract));
    schedule
}

/// All stages.
fn schedule<S: FilmSink>() -> Schedule {
    use stages::*;
    let mut schedule = seen();
    let rebuilt = accelerate.run_if(resource_changed::<Current<Geometry>>);
    schedule.add_systems((rebuilt, lap(Stage::Accelerate)).chain().in_set(Stage::Accelerate));
    schedule.add_systems((trace_frame.run_if(no_fault), lap(Stage::Trace)).chain().in_set(Stage::Trace));
    let encoded = encode::<S>.pipe(keep_fault).run_if(no_fault);
    schedule.add_systems((encoded, lap(Stage::Encode)).chain().in_set(Stage::Encode));
    schedule
}
