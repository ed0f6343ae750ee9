//! The frame loop: a sequence's world, driven from frame to frame.

use super::cross_fade::FadedFilm;
use super::frame_mark::FrameMark;
use super::frame_state::FrameState;
use super::frame_states::frame_states;
use super::known_samples::KnownSamples;
use super::neighbors::SampledFrame;
use super::preview::Preview;
use super::shared_paths::weights_of;
use super::shutter::Shutter;
use super::stages::{
    CurrentMoment, ExposureTrack, FilmInProgress, FilmSink, FirstError, FrameError, FrameStage,
    RenderSettings, RunProgress, Sink, Stats, Stopwatch, TraceRequest, empty_bvh,
};
use super::systems::{new_world, schedule};
use crate::base::cancel::Stop;
use crate::base::stats::{Counts, ProgressMeter};
use crate::base::time::{Clock, Timeline};
use crate::film::filter::FilterSampler;
use crate::film::{AovSet, Film, LayerId};
use crate::scene::Shading;
use crate::sequence::Sequence;
use crate::sequence::quality::Quality;
use crate::trace::{Moment, TraceSettings};
use crate::world::{Current, Now, ShapeUse, sky_table};
use bevy_ecs::schedule::Schedule;
use bevy_ecs::world::World;
use std::marker::PhantomData;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::time::Instant;

/// A sequence's world, and the systems that render its frames.
#[warn(missing_docs)]
pub struct FrameLoop<S> {
    pub(super) world: World,
    schedule: Schedule,
    timeline: Timeline,
    shutter: Shutter,
    pub(super) quality: Quality,
    /// How frames are evaluated that are rendered without a state.
    evaluation: Evaluation,
    /// Where the measurement of the current frame began. None unless frames are reported.
    mark: Option<FrameMark>,
    /// The films of the cameras that showed the last frame together.
    pub(super) faded: Vec<FadedFilm>,
    /// The samples of frames that the next one may be denoised with.
    pub(super) sampled: KnownSamples<SampledFrame>,
    sink: PhantomData<S>,
}

/// How frames are evaluated that are rendered without a state. A run evaluates all frames once, before it begins.
enum Evaluation {
    /// A frame has one moment, and depends on no other frame.
    Unneeded,
    /// A shutter opens: a preview finds the frames in which something moves meanwhile.
    Moments(Arc<Sequence>, Option<Box<Preview>>),
    /// With a target error, and if views or neighbours in time share samples, other frames affect the samples of a frame; and
    /// cross-fades have two films.
    States(Arc<Sequence>),
}

impl Evaluation {
    fn of(sequence: &Sequence) -> Self {
        let quality = &sequence.quality;
        let copy = || Arc::new(sequence.clone());
        if quality.noise.is_some()
            || quality.shares_views()
            || quality.uses_neighbors()
            || sequence.active_camera.fades()
        {
            Self::States(copy())
        } else if sequence.blurs_motion() {
            Self::Moments(copy(), None)
        } else {
            Self::Unneeded
        }
    }
}

#[warn(missing_docs)]
impl<S: FilmSink> FrameLoop<S> {
    /// Films go to `sink` in the order of the calls.
    pub fn new(sequence: &Sequence, sink: S, meter: Arc<ProgressMeter>) -> Self {
        Self::with_aovs(sequence, AovSet::default(), sink, meter)
    }

    /// [`FrameLoop::new`] for films that record `aovs` besides light.
    pub fn with_aovs(sequence: &Sequence, aovs: AovSet, sink: S, meter: Arc<ProgressMeter>) -> Self {
        let mut world = new_world(sequence);
        world.resource_mut::<Current<Shading>>().0.sky_table = sky_table(sequence);
        world.insert_resource(ShapeUse::Rays);
        world.insert_resource(empty_bvh(&sequence.quality));
        world.insert_resource(RenderSettings(TraceSettings {
            size: sequence.output.size,
            quality: sequence.quality,
            filter: FilterSampler::new(sequence.quality.filter),
            aovs,
            first_sample: 0,
        }));
        world.insert_resource(ExposureTrack(sequence.output.exposure.clone()));
        world.insert_resource(FilmInProgress::default());
        world.insert_resource(TraceRequest::default());
        world.insert_resource(Sink(sink));
        world.insert_resource(RunProgress(meter));
        let (timeline, shutter) = (sequence.timeline, Shutter::new(sequence));
        Self {
            world,
            schedule: schedule::<S>(),
            timeline,
            shutter,
            quality: sequence.quality,
            evaluation: Evaluation::of(sequence),
            mark: None,
            faded: Vec::new(),
            sampled: KnownSamples::default(),
            sink: PhantomData,
        }
    }

    /// Reports each finished frame from now on. Trials of a few samples do not.
    pub fn report_frames(&mut self) {
        self.mark = Some(FrameMark::default());
    }

    /// Renders one frame separately and pushes its film to the sink. After an error, the loop cannot render further
    /// frames.
    pub fn frame(&mut self, frame: u32) -> Result<(), FrameError> {
        let still = match &mut self.evaluation {
            Evaluation::Unneeded => true,
            Evaluation::Moments(sequence, preview) => {
                preview.get_or_insert_with(|| Box::new(Preview::new(sequence))).state(frame).moments == 1
            }
            Evaluation::States(sequence) => match &frame_states(sequence, &[frame], &Stop::default())[..] {
                [state] => return self.trace_alone(state).map(|_| ()),
                _ => true,
            },
        };
        let moments = self.moments(frame, still);
        self.run(&moments)
    }

    /// Renders an evaluated frame with the layers `lit`, which include all that it shows. Returns its film. None if the run
    /// is stopped while samples of other views are traced for it.
    pub fn trace(&mut self, state: &FrameState, lit: &[LayerId]) -> Result<Option<Film>, FrameError> {
        self.trace_with(state, lit, true)?;
        Ok(self.world.resource_mut::<FilmInProgress>().kept.take())
    }

    /// Renders an evaluated frame separately. Returns false if the run is stopped while samples of other views are traced
    /// for it; then it has no film.
    pub fn trace_alone(&mut self, state: &FrameState) -> Result<bool, FrameError> {
        self.trace_with(state, &state.lit(), false)
    }

    fn trace_with(&mut self, state: &FrameState, lit: &[LayerId], keep: bool) -> Result<bool, FrameError> {
        if state.views.is_some() {
            let film = self.trace_views(&[state], lit)?.pop();
            film.iter().try_for_each(|film| self.push_traced(state, film, "traced"))?;
            let has_film = film.is_some();
            self.world.resource_mut::<FilmInProgress>().kept = film.filter(|_| keep);
            return Ok(has_film);
        }
        if let Some([from, to]) = &state.faded {
            let film = self.trace_faded(state, [from, to], lit)?;
            return self.push_and_keep(state, film, keep);
        }
        self.faded.clear();
        if let Some(sampled) = &state.neighbors {
            let film = self.trace_among_neighbors(state, sampled, lit)?;
            return self.push_and_keep(state, film, keep);
        }
        self.world.insert_resource(TraceRequest {
            lit: Some(weights_of(state, lit)),
            weightings: Arc::clone(&state.weightings),
            own: state.own,
            keep,
            is_part: false,
            films: None,
            parts: [0; 2],
            only_prepare: false,
        });
        let moments = self.moments(state.frame, state.moments == 1);
        let done = self.run(&moments);
        self.world.insert_resource(TraceRequest::default());
        done?;
        self.report(state.frame, "traced");
        Ok(true)
    }

    fn push_and_keep(&mut self, state: &FrameState, film: Film, keep: bool) -> Result<bool, FrameError> {
        self.push_traced(state, &film, "traced")?;
        self.world.resource_mut::<FilmInProgress>().kept = Some(film).filter(|_| keep);
        Ok(true)
    }

    /// Makes a frame from the film of another frame with the same scene hash. The film must have all layers that this
    /// frame shows.
    pub fn reuse(&mut self, state: &FrameState, film: &Film) -> Result<(), FrameError> {
        let pushed = self.push_film(state, film);
        self.world.resource_mut::<Stats>().reused += 1;
        let meter = &self.world.resource::<RunProgress>().0;
        meter.reused.fetch_add(1, Relaxed);
        meter.frames.fetch_add(1, Relaxed);
        self.report(state.frame, "reused");
        pushed
    }

    /// The moments of a frame, or the first one only if all are equal.
    pub(super) fn moments(&self, frame: u32, still: bool) -> Vec<(Clock, Moment)> {
        self.moments_of(self.shutter.camera(&self.timeline, frame), frame, still)
    }

    /// [`FrameLoop::moments`] through one of the cameras.
    pub(super) fn moments_of(&self, camera: usize, frame: u32, still: bool) -> Vec<(Clock, Moment)> {
        let mut moments = self.shutter.moments_of(camera, &self.timeline, frame);
        if still {
            moments.truncate(1);
            moments.iter_mut().for_each(|(_, moment)| *moment = Moment::ONLY);
        }
        moments
    }

    /// Runs the stages for a moment of a frame.
    pub(super) fn run_moment(&mut self, clock: Clock, moment: Moment) -> Result<(), FrameError> {
        self.world.resource_mut::<RenderSettings>().0.quality = self.quality.of_frame(clock.frame);
        self.world.insert_resource(Now(clock));
        self.world.insert_resource(CurrentMoment(moment));
        self.world.resource_mut::<Stopwatch>().start();
        self.schedule.run(&mut self.world);
        // Without this call, removed components would accumulate.
        self.world.clear_trackers();
        self.world.resource_mut::<FirstError>().take()
    }

    /// Runs stages that prepare scenes and trace nothing.
    pub(super) fn without_tracing<T>(
        &mut self,
        prepare: impl FnOnce(&mut Self) -> Result<T, FrameError>,
    ) -> Result<T, FrameError> {
        self.world.insert_resource(TraceRequest { only_prepare: true, ..TraceRequest::default() });
        let prepared = prepare(self);
        self.world.insert_resource(TraceRequest::default());
        prepared
    }

    /// Records films that were traced together since `start`. Returns them; none if the run was stopped.
    pub(super) fn recorded(&mut self, traced: Option<(Vec<Film>, Counts)>, start: Instant) -> Vec<Film> {
        let Some((films, counts)) = traced else { return Vec::new() };
        self.record(films.len() as u32, counts, start);
        films
    }

    /// Records the work of tracing some films since `start`.
    pub(super) fn record(&mut self, films: u32, counts: Counts, start: Instant) {
        let mut stats = self.world.resource_mut::<Stats>();
        stats.counts += counts;
        stats.traced += films;
        stats.stages[FrameStage::Trace as usize] += start.elapsed();
    }

    /// Pushes a frame's film, which was traced together with other films.
    pub fn push(&mut self, state: &FrameState, film: &Film) -> Result<(), FrameError> {
        self.push_traced(state, film, "together")
    }

    fn push_traced(&mut self, state: &FrameState, film: &Film, how: &'static str) -> Result<(), FrameError> {
        self.push_film(state, film)?;
        self.report(state.frame, how);
        Ok(())
    }

    /// Reports a finished frame to whoever listens: everything since the frame before belongs to it, so that the frames
    /// of a run add up to its summary.
    fn report(&mut self, frame: u32, film: &'static str) {
        let stats = self.world.resource::<Stats>();
        self.mark.iter_mut().for_each(|mark| mark.report(frame, film, stats));
    }

    fn push_film(&mut self, state: &FrameState, film: &Film) -> Result<(), FrameError> {
        let _span = FrameStage::Encode.span(state.frame).entered();
        let start = Instant::now();
        let film = Film { exposure: state.exposure, ..film.shown_as(state.own, &state.weights) };
        let pushed = self.world.resource_mut::<Sink<S>>().0.push(state.frame, film);
        let mut stats = self.world.resource_mut::<Stats>();
        stats.stages[FrameStage::Encode as usize] += start.elapsed();
        pushed.map_err(FrameError::Encode)
    }

    /// Runs the stages for these moments of a frame.
    pub(super) fn run(&mut self, moments: &[(Clock, Moment)]) -> Result<(), FrameError> {
        loop {
            for &(clock, moment) in moments {
                self.run_moment(clock, moment)?;
            }
            if !self.world.resource::<FilmInProgress>().needs_another_round() {
                return Ok(());
            }
        }
    }

    /// Statistics of all frames so far.
    pub fn stats(&self) -> &Stats {
        self.world.resource::<Stats>()
    }

    /// Calls `act` with the sink.
    pub fn with_sink<T>(&mut self, act: impl FnOnce(&mut S) -> T) -> T {
        act(&mut self.world.resource_mut::<Sink<S>>().0)
    }

    /// Ends the loop and returns the sink.
    pub fn into_sink(mut self) -> Option<S> {
        self.world.remove_resource::<Sink<S>>().map(|sink| sink.0)
    }
}
