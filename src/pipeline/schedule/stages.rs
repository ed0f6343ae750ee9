//! The systems that are not animation or extraction, and the resources that only they need.

use crate::base::math::DVec3;
use crate::base::stats::{Counts, Meter};
use crate::camera::Camera;
use crate::camera::path::NoCamera;
use crate::encode::EncodeError;
use crate::film::{Film, lit};
use crate::scene::top_level::Bvh;
use crate::scene::{Geometry, Scene, Shading, Weights};
use crate::trace::{Moment, Rounds, TraceSettings, Weightings, trace_moment, trace_shown};
use crate::track::Animated;
use crate::world::{Current, Now};
use bevy_ecs::resource::Resource;
use bevy_ecs::schedule::SystemSet;
use bevy_ecs::system::{In, Res, ResMut};
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::time::{Duration, Instant};

/// The stages of a frame, in their order.
#[derive(Clone, Copy, Debug, Hash, PartialEq, Eq, SystemSet)]
pub enum Stage {
    Animate,
    Extract,
    Accelerate,
    Trace,
    Encode,
}

impl Stage {
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
}

/// Where films go.
pub trait FilmSink: Send + Sync + 'static {
    fn push(&mut self, frame: u32, film: Film) -> Result<(), EncodeError>;
}

/// Keeps films instead of writing them.
#[derive(Debug, Default)]
pub struct Films(pub Vec<Film>);

impl FilmSink for Films {
    fn push(&mut self, _frame: u32, film: Film) -> Result<(), EncodeError> {
        self.0.push(film);
        Ok(())
    }
}

/// Why a frame was not made.
#[derive(Debug)]
pub enum NoFrame {
    Camera { frame: u32, why: NoCamera },
    Encode(EncodeError),
}

/// Work done, exactly, and the wall time that each [`Stage`] took, in their order.
#[derive(Clone, Debug, Default, Resource)]
pub struct Tally {
    pub counts: Counts,
    pub bvh_builds: u64,
    /// How often each kind of data was packed anew.
    pub geometry_packs: u64,
    pub shading_packs: u64,
    /// Frames that were traced, and those that were made of the film of another.
    pub traced: u32,
    pub reused: u32,
    pub stages: [Duration; 5],
}

#[derive(Resource)]
pub struct Settings(pub TraceSettings);

/// How much brighter the film is shown than traced, in stops.
#[derive(Resource)]
pub struct Exposure(pub Animated<f64>);

#[derive(Resource)]
pub struct Sink<S: FilmSink>(pub S);

#[derive(Resource)]
pub struct Watched(pub Arc<Meter>);

/// The moment of the frame in hand.
#[derive(Resource)]
pub struct Shown(pub Moment);

/// Which layers of light the frame in hand is traced with, if not with those that it shows; and whether its film is kept.
#[derive(Default, Resource)]
pub struct Wanted {
    pub lit: Option<Weights>,
    /// The weights that the film is shown with, where that decides how it is sampled.
    pub shown: Weightings,
    /// Which of them the frame has.
    pub own: usize,
    pub keep: bool,
}

/// The film between Trace and Encode, what several moments add up to before they are a film, and the film that is kept.
#[derive(Default, Resource)]
pub struct Exposed {
    film: Option<Film>,
    sums: Vec<DVec3>,
    pub kept: Option<Film>,
    /// Samples of a frame of several moments that is not good enough yet.
    rounds: Option<Rounds>,
}

impl Exposed {
    /// Whether the frame's moments are to be looked at again.
    pub fn goes_on(&self) -> bool {
        self.rounds.is_some()
    }
}

/// The first error of a frame. A failing system does not stop a chain: the systems after it look here.
#[derive(Default, Resource)]
pub struct Faults(Option<NoFrame>);

impl Faults {
    pub fn take(&mut self) -> Result<(), NoFrame> {
        self.0.take().map_or(Ok(()), Err)
    }

    /// Why there is no camera, if that was the error.
    pub fn no_camera(&mut self) -> Option<NoCamera> {
        if let Some(NoFrame::Camera { why, .. }) = self.0.take() { Some(why) } else { None }
    }
}

#[derive(Default, Resource)]
pub struct Stopwatch(Option<Instant>);

impl Stopwatch {
    pub fn start(&mut self) {
        self.0 = Some(Instant::now());
    }

    /// Time since the last start, and starts again.
    fn lap(&mut self) -> Duration {
        let now = Instant::now();
        self.0.replace(now).map_or(Duration::ZERO, |start| now - start)
    }
}

/// A system that books the time since the last one on `stage`.
pub fn lap(stage: Stage) -> impl FnMut(ResMut<Stopwatch>, ResMut<Tally>) {
    move |mut watch, mut tally| tally.stages[stage as usize] += watch.lap()
}

pub fn no_fault(faults: Res<Faults>) -> bool {
    faults.0.is_none()
}

pub fn keep_camera_fault(In(camera): In<Result<(), NoCamera>>, now: Res<Now>, mut faults: ResMut<Faults>) {
    if let Err(why) = camera {
        faults.0.get_or_insert(NoFrame::Camera { frame: now.0.frame, why });
    }
}

pub fn keep_fault(In(encoded): In<Result<(), EncodeError>>, mut faults: ResMut<Faults>) {
    if let Err(error) = encoded {
        faults.0.get_or_insert(NoFrame::Encode(error));
    }
}

pub fn count_geometry(mut tally: ResMut<Tally>) {
    tally.geometry_packs += 1;
}

pub fn count_shading(mut tally: ResMut<Tally>) {
    tally.shading_packs += 1;
}

pub fn accelerate(geometry: Res<Current<Geometry>>, mut bvh: ResMut<Current<Bvh>>, mut tally: ResMut<Tally>) {
    bvh.0 = Bvh::build(&geometry.0);
    tally.bvh_builds += 1;
}

/// What tracing reads.
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
    (settings, exposure, shown, wanted): (Res<Settings>, Res<Exposure>, Res<Shown>, Res<Wanted>),
    watched: Res<Watched>,
    mut exposed: ResMut<Exposed>,
    mut tally: ResMut<Tally>,
) {
    let Some(camera) = &camera.0 else { return };
    let traced = wanted.lit.as_ref().unwrap_or(&weights.0);
    let scene = Scene { geometry: &geometry.0, shading: &shading.0, weights: traced, camera };
    let shows = match wanted.shown.is_empty() {
        true => [weights.0.0.clone()].into(),
        false => Weightings::clone(&wanted.shown),
    };
    let (film, counts) = match shown.0 {
        Moment::ONLY => {
            let (film, counts) = trace_shown(&scene, &bvh.0, &settings.0, &shows, &watched.0);
            (Some(film), counts)
        }
        moment => exposed.add_moment(&scene, &bvh.0, &settings.0, (moment, &shows), &watched.0),
    };
    tally.counts += counts;
    let Some(film) = film else { return };
    tally.traced += 1;
    let mut film = film.shown_as(wanted.own, &weights.0.0);
    film.expose(exposure.0.at(now.0.start));
    film.unfinished = watched.0.unfinished.load(Relaxed);
    exposed.kept = wanted.keep.then(|| film.clone());
    exposed.film = Some(film);
    watched.0.thousandths.store(0, Relaxed);
    watched.0.frames.fetch_add(1, Relaxed);
}

impl Exposed {
    /// Adds a moment; the last one makes the film.
    fn add_moment(
        &mut self,
        scene: &Scene,
        bvh: &Bvh,
        settings: &TraceSettings,
        (moment, shows): (Moment, &Weightings),
        meter: &Meter,
    ) -> (Option<Film>, Counts) {
        if let Some(target) = settings.quality.noise {
            let rounds = self.rounds.take();
            let mut rounds = rounds.unwrap_or_else(|| Rounds::new(scene, settings, target, shows));
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
            let layers = lit(&scene.weights.0).count() + settings.extras.layers();
            self.sums.resize(pixels * layers, DVec3::ZERO);
        }
        let counts = trace_moment(scene, bvh, settings, moment, &mut self.sums, meter);
        let last = moment.index + 1 == moment.of;
        let film = last.then(|| {
            let mut film = Film::with_extras(width, height, scene.weights.0.clone(), settings.extras);
            film.data_mut().iter_mut().zip(&self.sums).for_each(|(layer, sum)| *layer = sum.as_vec3());
            film
        });
        (film, counts)
    }
}

pub fn encode<S: FilmSink>(
    now: Res<Now>,
    mut exposed: ResMut<Exposed>,
    mut sink: ResMut<Sink<S>>,
) -> Result<(), EncodeError> {
    exposed.film.take().map_or(Ok(()), |film| sink.0.push(now.0.frame, film))
}
