//! Systems besides animation and extraction, and the resources that only they need.

use super::sample_sets::{FilmSet, NextStep, SampleSets};
use crate::base::math::DVec3;
use crate::base::stats::{Counts, ProgressMeter};
use crate::camera::Camera;
use crate::camera::path::NoCamera;
use crate::encode::EncodeError;
use crate::film::denoise::Memory;
use crate::film::{Film, lit};
use crate::import::series::StepError;
use crate::scene::top_level::{Bvh, BvhUpdate, Coherence};
use crate::scene::{Geometry, Scene, Shading, Weights};
use crate::sequence::quality::{Denoise, Integrator, Quality};
use crate::trace::{
    AdaptiveFrame, Moment, PrimaryHits, TraceSettings, Weightings, is_random, trace_moment, trace_weighted,
};
use crate::track::Animated;
use crate::world::{Current, Now};
use bevy_ecs::resource::Resource;
use bevy_ecs::schedule::SystemSet;
use bevy_ecs::system::{In, Res, ResMut};
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::time::{Duration, Instant};
use tracing::{Span, debug_span};

/// The stages of a frame, in their order.
#[derive(Clone, Copy, Debug, Hash, PartialEq, Eq, SystemSet)]
pub enum FrameStage {
    Animate,
    Extract,
    Accelerate,
    Trace,
    Encode,
}

impl FrameStage {
    pub const ALL: [Self; 5] = [Self::Animate, Self::Extract, Self::Accelerate, Self::Trace, Self::Encode];

    pub fn name(self) -> &'static str {
        match self {
            Self::Animate => "animate",
            Self::Extract => "extract",
            Self::Accelerate => "accelerate",
            Self::Trace => "trace",
            Self::Encode => "encode",
        }
    }

    /// A span of this stage. The last stage hands the film to the sink; the encoder's thread has spans of its own.
    pub fn span(self, frame: u32) -> Span {
        match self {
            Self::Animate => debug_span!("animate", frame),
            Self::Extract => debug_span!("extract", frame),
            Self::Accelerate => debug_span!("accelerate", frame),
            Self::Trace => debug_span!("trace", frame),
            Self::Encode => debug_span!("submit", frame),
        }
    }
}

/// A receiver of finished films.
pub trait FilmSink: Send + Sync + 'static {
    fn push(&mut self, frame: u32, film: Film) -> Result<(), EncodeError>;
}

/// A sink that keeps films in memory.
#[derive(Debug, Default)]
#[warn(missing_docs)]
pub struct FilmCollector(pub Vec<Film>);

impl FilmSink for FilmCollector {
    fn push(&mut self, _frame: u32, film: Film) -> Result<(), EncodeError> {
        self.0.push(film);
        Ok(())
    }
}

/// Why a frame could not be rendered.
#[derive(Debug)]
#[warn(missing_docs)]
pub enum FrameError {
    /// The frame has no camera.
    Camera {
        /// The number of the frame.
        frame: u32,
        /// Why it has no camera.
        why: NoCamera,
    },
    /// A mesh cannot be loaded.
    Mesh {
        /// The number of the frame.
        frame: u32,
        /// What is wrong with the mesh.
        why: StepError,
    },
    /// The sink refused the film.
    Encode(EncodeError),
}

/// Exact counts of work, and the wall time of each [`FrameStage`] in order.
#[derive(Clone, Debug, Default, Resource)]
pub struct Stats {
    pub counts: Counts,
    /// Number of times that the top-level tree was built, and that it was refitted instead.
    pub bvh_builds: u64,
    pub bvh_refits: u64,
    /// Number of times each kind of data was packed.
    pub geometry_packs: u64,
    /// Number of primitives that were rewritten, because they changed.
    pub primitives_packed: u64,
    pub shading_packs: u64,
    /// Frames that were traced, and frames that reused the film of another frame.
    pub traced: u32,
    pub reused: u32,
    pub stages: [Duration; 5],
}

#[derive(Resource)]
pub struct RenderSettings(pub TraceSettings);

/// Exposure of the displayed picture over time, in stops.
#[derive(Resource)]
pub struct ExposureTrack(pub Animated<f64>);

#[derive(Resource)]
pub struct Sink<S: FilmSink>(pub S);

#[derive(Resource)]
pub struct RunProgress(pub Arc<ProgressMeter>);

/// The current moment of the frame.
#[derive(Resource)]
pub struct CurrentMoment(pub Moment);

/// How to trace the current frame: the layers, if they differ from those that it weightings, and whether to keep its film.
#[derive(Default, Resource)]
pub struct TraceRequest {
    pub lit: Option<Weights>,
    /// The weights of all frames of the film, if they decide how it is sampled.
    pub weightings: Weightings,
    /// Index of this frame's weights.
    pub own: usize,
    pub keep: bool,
    /// Whether the film is a part of a frame's film: then it is kept, and neither counted nor pushed.
    pub is_part: bool,
    /// The films to trace, if they are to be denoised later: then they are kept.
    pub films: Option<FilmSet>,
    /// How many films are traced before these for the frame, and how many in all.
    pub parts: [u32; 2],
    /// Whether to stop before Trace, because the scene is traced together with others.
    pub only_prepare: bool,
}

/// The film between Trace and Encode, the sums over moments, and the film to keep.
#[derive(Default, Resource)]
pub struct FilmInProgress {
    film: Option<Film>,
    sums: Vec<DVec3>,
    pub kept: Option<Film>,
    /// Samples of a frame that has not reached its target error yet: of several moments, or no longer to be denoised.
    rounds: Option<AdaptiveFrame>,
    /// Samples of a frame that will be denoised.
    sets: Option<SampleSets>,
    /// The rays of the part that is traced now, over its moments.
    part_rays: u64,
    /// Films that are to be denoised later, and what their pixels see.
    pub sampled: Vec<Film>,
    pub hits: Option<PrimaryHits>,
    /// The memory of filters, for one frame after the other.
    pub memory: Memory,
}

impl FilmInProgress {
    /// Whether the frame needs another round over its moments.
    pub fn needs_another_round(&self) -> bool {
        self.rounds.is_some() || self.sets.is_some()
    }
}

/// The first error of a frame. A failing system does not stop a chain, so later systems check this resource.
#[derive(Default, Resource)]
pub struct FirstError(Option<FrameError>);

impl FirstError {
    pub fn take(&mut self) -> Result<(), FrameError> {
        self.0.take().map_or(Ok(()), Err)
    }

    /// Takes the error if it is a missing camera.
    pub fn no_camera(&mut self) -> Option<NoCamera> {
        if let Some(FrameError::Camera { why, .. }) = self.0.take() { Some(why) } else { None }
    }
}

#[derive(Default, Resource)]
pub struct Stopwatch {
    start: Option<Instant>,
    /// The span of the current stage.
    span: Option<Span>,
}

impl Stopwatch {
    pub fn start(&mut self) {
        self.start = Some(Instant::now());
    }

    /// Returns the time since the last start, and restarts.
    fn lap(&mut self) -> Duration {
        if let Some(span) = self.span.take() {
            // Entered in `begin`. A guard cannot be kept in a resource, because it must stay on its thread.
            span.with_subscriber(|(id, subscriber)| subscriber.exit(id));
        }
        let now = Instant::now();
        self.start.replace(now).map_or(Duration::ZERO, |start| now - start)
    }

    fn begin(&mut self, span: Span) {
        if !span.is_disabled() {
            span.with_subscriber(|(id, subscriber)| subscriber.enter(id));
            self.span = Some(span);
        }
    }
}

/// A system that begins the span of `stage`, which its [`lap`] ends.
pub fn begin(stage: FrameStage) -> impl FnMut(ResMut<Stopwatch>, Res<Now>) {
    move |mut watch, now| watch.begin(stage.span(now.0.frame))
}

/// A system that adds the time since the last lap to `stage`.
pub fn lap(stage: FrameStage) -> impl FnMut(ResMut<Stopwatch>, ResMut<Stats>) {
    move |mut watch, mut stats| stats.stages[stage as usize] += watch.lap()
}

pub fn no_error(first: Res<FirstError>) -> bool {
    first.0.is_none()
}

pub fn keep_camera_error(In(camera): In<Result<(), NoCamera>>, now: Res<Now>, mut first: ResMut<FirstError>) {
    if let Err(why) = camera {
        first.0.get_or_insert(FrameError::Camera { frame: now.0.frame, why });
    }
}

pub fn keep_mesh_fault(In(loaded): In<Result<(), StepError>>, now: Res<Now>, mut first: ResMut<FirstError>) {
    if let Err(why) = loaded {
        first.0.get_or_insert(FrameError::Mesh { frame: now.0.frame, why });
    }
}

pub fn keep_error(In(encoded): In<Result<(), EncodeError>>, mut first: ResMut<FirstError>) {
    if let Err(error) = encoded {
        first.0.get_or_insert(FrameError::Encode(error));
    }
}

pub fn count_geometry(geometry: Res<Current<Geometry>>, mut stats: ResMut<Stats>) {
    stats.geometry_packs += 1;
    stats.primitives_packed = geometry.0.revision();
}

pub fn count_shading(mut stats: ResMut<Stats>) {
    stats.shading_packs += 1;
}

/// No tree yet, for the rays of an integrator. Most of Whitted's rays start at neighbours and end at the same lamps.
pub fn empty_bvh(quality: &Quality) -> Current<Bvh> {
    Current(Bvh::for_rays(match quality.integrator {
        Integrator::Whitted => Coherence::Coherent,
        Integrator::Path(_) => Coherence::Incoherent,
    }))
}

pub fn accelerate(geometry: Res<Current<Geometry>>, mut bvh: ResMut<Current<Bvh>>, mut stats: ResMut<Stats>) {
    match bvh.0.update(&geometry.0) {
        BvhUpdate::None => {}
        BvhUpdate::Refit => stats.bvh_refits += 1,
        BvhUpdate::Build => stats.bvh_builds += 1,
    }
}

/// The data that tracing reads.
type Traced<'w> = (
    Res<'w, Current<Geometry>>,
    Res<'w, Current<Bvh>>,
    Res<'w, Current<Shading>>,
    Res<'w, Current<Weights>>,
    Res<'w, Current<Option<Camera>>>,
);

pub fn trace_frame(
    now: Res<Now>,
    (geometry, bvh, shading, weights, camera): Traced,
    (settings, exposure, current, request): (
        Res<RenderSettings>,
        Res<ExposureTrack>,
        Res<CurrentMoment>,
        Res<TraceRequest>,
    ),
    progress: Res<RunProgress>,
    mut in_progress: ResMut<FilmInProgress>,
    mut stats: ResMut<Stats>,
) {
    let Some(camera) = camera.0.as_ref().filter(|_| !request.only_prepare) else { return };
    let weighted = request.lit.as_ref().unwrap_or(&weights.0);
    let scene = Scene { geometry: &geometry.0, shading: &shading.0, weights: weighted, camera };
    let weightings = match request.weightings.is_empty() {
        true => [weights.0.0.clone()].into(),
        false => Weightings::clone(&request.weightings),
    };
    let (settings, mut sets) = (&settings.0, in_progress.sets.take());
    if sets.is_none() && in_progress.rounds.is_none() && is_denoised(&scene, settings, current.0) {
        sets = Some(SampleSets::new(
            request.films.unwrap_or(FilmSet::All),
            &settings.quality,
            &in_progress.memory,
        ));
    }
    if request.films == Some(FilmSet::Halves) && current.0.index == current.0.of / 2 {
        in_progress.hits.get_or_insert_with(|| PrimaryHits::find(&scene, &bvh.0, settings));
    }
    let of_set = sets.as_ref().map(|sets| sets.settings(settings));
    sets.iter().for_each(|sets| sets.show(&progress.0, request.parts));
    let traced = of_set.as_ref().unwrap_or(settings);
    let (mut film, counts) = match current.0 {
        Moment::ONLY if in_progress.rounds.is_none() => {
            let (film, counts) = trace_weighted(&scene, &bvh.0, traced, &weightings, &progress.0);
            (Some(film), counts)
        }
        moment => in_progress.add_moment(&scene, &bvh.0, traced, (moment, &weightings), &progress.0),
    };
    stats.counts += counts;
    if let Some(sets) = sets {
        in_progress.part_rays += counts.rays.total();
        let next = match film.take() {
            Some(film) => {
                let part = (film, std::mem::take(&mut in_progress.part_rays));
                sets.add(part, &settings.quality, &weightings, &progress.0)
            }
            None => NextStep::Part(sets),
        };
        match next {
            NextStep::Part(sets) => in_progress.sets = Some(sets),
            NextStep::Samples(rounds) => in_progress.rounds = Some(rounds),
            NextStep::Done(done) => film = Some(done),
            NextStep::Sampled(films) => in_progress.sampled = films,
        }
    }
    let Some(film) = film else { return };
    let mut film = film.shown_as(request.own, &weights.0.0);
    film.expose(exposure.0.at(now.0.start));
    film.unfinished = progress.0.unfinished.load(Relaxed);
    in_progress.kept = request.keep.then(|| film.clone());
    progress.0.thousandths.store(0, Relaxed);
    if request.is_part {
        return;
    }
    in_progress.film = Some(film);
    stats.traced += 1;
    progress.0.frames.fetch_add(1, Relaxed);
}

/// Whether a frame is denoised: only random samples are noisy.
fn is_denoised(scene: &Scene, settings: &TraceSettings, moment: Moment) -> bool {
    settings.quality.denoise != Denoise::Off
        && (moment.of > 1 || is_random(scene, settings.quality.integrator))
}

impl FilmInProgress {
    /// Adds a moment. The last moment completes the film.
    fn add_moment(
        &mut self,
        scene: &Scene,
        bvh: &Bvh,
        settings: &TraceSettings,
        (moment, weightings): (Moment, &Weightings),
        meter: &ProgressMeter,
    ) -> (Option<Film>, Counts) {
        if let Some(target) = settings.quality.noise {
            let rounds = self.rounds.take();
            let mut rounds =
                rounds.unwrap_or_else(|| AdaptiveFrame::new(scene, settings, target, weightings));
            let counts = rounds.trace(scene, bvh, settings, moment, meter);
            if moment.index + 1 == moment.of && rounds.settle(meter) {
                return (Some(rounds.film()), counts);
            }
            self.rounds = Some(rounds);
            return (None, counts);
        }
        let (width, height) = settings.size;
        if moment.index == 0 {
            let pixels = width as usize * height as usize;
            self.sums.clear();
            let layers = lit(&scene.weights.0).count() + settings.aovs.layers();
            self.sums.resize(pixels * layers, DVec3::ZERO);
        }
        let counts = trace_moment(scene, bvh, settings, moment, &mut self.sums, meter);
        let last = moment.index + 1 == moment.of;
        let film = last.then(|| {
            let mut film = Film::with_aovs(width, height, scene.weights.0.clone(), settings.aovs);
            film.data_mut().iter_mut().zip(&self.sums).for_each(|(layer, sum)| *layer = sum.as_vec3());
            film
        });
        (film, counts)
    }
}

pub fn encode<S: FilmSink>(
    now: Res<Now>,
    mut in_progress: ResMut<FilmInProgress>,
    mut sink: ResMut<Sink<S>>,
) -> Result<(), EncodeError> {
    in_progress.film.take().map_or(Ok(()), |film| sink.0.push(now.0.frame, film))
}
