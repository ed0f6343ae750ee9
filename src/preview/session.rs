//! A session: one sequence file that changes, and the picture of one of its frames that becomes finer.

use super::camera::ViewCamera;
use super::film_cache::FilmCache;
use super::heat::{HeatKind, HeatMap, heat_map};
use super::light_isolation::isolated;
use super::overrides::Overrides;
use super::picture::{Developer, png};
use super::scene_in_use::SceneInUse;
use super::stages::Pace;
use crate::base::cancel::Stop;
use crate::base::color::Rgb;
use crate::base::digest::Digest;
use crate::base::escape;
use crate::base::files::{FileStamp, Root};
use crate::base::machine;
use crate::base::stats::Counts;
use crate::base::time::Clock;
use crate::camera::Camera;
use crate::encode::{Existing, Picture};
use crate::film::{LayerId, lit};
use crate::pipeline::render::{self, RenderError, Request, Reuse};
use crate::pipeline::schedule::{FrameError, FrameState};
use crate::scene::Scene;
use crate::scene::top_level::Bvh;
use crate::sequence::{Sequence, load_watched};
use crate::trace::{ProgressiveFilm, Refinement, StageEnd, TraceSettings, rays_per_sample};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The files whose changes matter, with their stamps before they were read. Missing files have none.
pub type WatchedFiles = BTreeMap<PathBuf, Option<FileStamp>>;

/// What a session shows.
#[derive(Clone, Debug)]
pub struct SessionOptions {
    /// The sequence file.
    pub file: PathBuf,
    /// Whether it may name files outside of its root.
    pub allow_outside: bool,
    /// Whether the page may change single values of the file.
    pub edit: bool,
    /// A size instead of the file's.
    pub size: Option<(u32, u32)>,
}

/// The end of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// The picture is finer.
    Refined,
    /// A change came before the step was complete.
    Stopped,
    /// There is nothing to do.
    Done,
}

/// The most memory for films, in bytes, and its share of the free memory.
const MOST_FILMS: u64 = 1 << 30;
const FILM_SHARE: u64 = 4;

/// Cells of the heat map of rays, in pixels.
const HEAT_CELL: u32 = 4;

/// A sequence that is watched.
pub struct Session {
    pub(super) options: SessionOptions,
    /// The file's last sequence without mistakes.
    pub(super) loaded: Option<Arc<Sequence>>,
    /// The text of `kinora check` if the file has mistakes now.
    diagnostics: Option<String>,
    /// Why the frame has no picture.
    problem: Option<String>,
    watched: WatchedFiles,
    /// Counts the changes of the file.
    pub(super) generation: u64,
    pub(super) overrides: Overrides,
    pub(super) view: Option<ViewCamera>,
    pub(super) heat: Option<HeatKind>,
    most_samples: Option<u32>,
    pub(super) frame: u32,
    pub(super) scene: Option<SceneInUse>,
    films: FilmCache,
    pub(super) film: Option<(Digest, ProgressiveFilm)>,
    pace: Pace,
    developer: Option<Developer>,
    heat_of_rays: Option<(Digest, HeatMap)>,
    /// When the last change came, and how long the first picture after it took.
    changed: Instant,
    pub(super) first_picture: Option<Duration>,
    pub(super) tracing: Duration,
    pub(super) counts: Counts,
}

impl Session {
    /// A session without a sequence; [`Session::reload`] loads it.
    pub fn new(options: SessionOptions) -> Self {
        let budget = (machine::free_memory() / FILM_SHARE).clamp(1 << 20, MOST_FILMS);
        let overrides = Overrides { size: options.size, ..Overrides::default() };
        let watched = WatchedFiles::from([(options.file.clone(), FileStamp::of(&options.file))]);
        Self {
            options,
            loaded: None,
            diagnostics: None,
            problem: None,
            watched,
            generation: 0,
            overrides,
            view: None,
            heat: None,
            most_samples: None,
            frame: 0,
            scene: None,
            films: FilmCache::new(budget),
            film: None,
            pace: Pace::default(),
            developer: None,
            heat_of_rays: None,
            changed: Instant::now(),
            first_picture: None,
            tracing: Duration::ZERO,
            counts: Counts::default(),
        }
    }

    /// Loads the file again. With mistakes, the last good sequence stays, and the diagnostics say what `kinora check`
    /// says.
    pub fn reload(&mut self) {
        self.note_change();
        self.generation += 1;
        let (file, root) = (&self.options.file, self.root());
        // A change after this line is one that the load may have missed.
        let stamp = FileStamp::of(file);
        let loaded = load_watched(file, root.clone(), &Arc::default());
        let mut read = root.stamps();
        read.insert(file.clone(), stamp);
        match loaded {
            Ok(sequence) => {
                self.watched = read;
                self.adopt(sequence);
            }
            Err(error) => {
                // A missing file may come back.
                self.watched.extend(read);
                self.diagnostics = Some(error.render(false).trim_end().to_owned());
            }
        }
    }

    /// The folder that holds all files that the sequence may name.
    pub(super) fn root(&self) -> Root {
        match self.options.allow_outside {
            true => Root::anywhere(),
            false => Root::of(self.options.file.parent().unwrap_or(Path::new(""))),
        }
    }

    fn adopt(&mut self, sequence: Sequence) {
        let checked = render::check(&sequence, &request(&sequence));
        self.diagnostics =
            checked.as_ref().err().map(|error| format!("error: {}", escape::lines(&error.to_string())));
        if matches!(checked, Err(RenderError::TooLarge { .. })) && self.overrides.size.is_none() {
            return;
        }
        self.frame = self.frame.min(sequence.timeline.frames.saturating_sub(1));
        self.loaded = Some(Arc::new(sequence));
        self.scene = None;
    }

    /// The messages about mistakes of the file, as `kinora check` prints them; or why the frame has no picture.
    pub fn diagnostics(&self) -> Option<&str> {
        self.diagnostics.as_deref().or(self.problem.as_deref())
    }

    /// The files whose changes matter.
    pub fn watched(&self) -> &WatchedFiles {
        &self.watched
    }

    pub fn frames(&self) -> u32 {
        self.loaded.as_ref().map_or(0, |sequence| sequence.timeline.frames)
    }

    /// Shows another frame.
    pub fn go_to(&mut self, frame: u32) {
        self.note_change();
        self.frame = frame.min(self.frames().saturating_sub(1));
    }

    /// Limits the samples per pixel.
    pub fn limit_samples(&mut self, most: Option<u32>) {
        self.most_samples = most.map(|most| most.max(1));
    }

    /// Changes overrides. Switches of lights keep the scene if they have layers of their own.
    pub(super) fn set_overrides(&mut self, overrides: Overrides) {
        self.note_change();
        let lights: BTreeSet<&String> = self.overrides.lights.keys().collect();
        let own = |name: &&String| !lights.contains(name);
        let newly_switched = overrides.lights.keys().filter(own).any(|name| !self.has_own_layer(name));
        let switches_only =
            Overrides { lights: overrides.lights.clone(), ..self.overrides.clone() } == overrides;
        if newly_switched || !switches_only {
            self.scene = None;
        }
        self.overrides = overrides;
    }

    /// The file's sequence with the settings of the session, for plans and forecasts.
    pub(super) fn changed_sequence(&self) -> Option<Sequence> {
        Some(self.overrides.apply(Sequence::clone(self.loaded.as_ref()?)))
    }

    /// Whether the current frame has a film that can be shown.
    pub(super) fn has_picture(&mut self) -> bool {
        self.select().is_some() && self.film.as_ref().is_some_and(|(_, film)| film.done().is_some())
    }

    /// Whether every pixel of the current frame has a sample.
    pub(super) fn has_all_pixels(&mut self) -> bool {
        self.select().is_some()
            && self.film.as_ref().is_some_and(|(_, film)| film.done() >= Some(Refinement::ALL_PIXELS))
    }

    /// The predicted time of the next stage. None if there is none, or if nothing is known.
    pub(super) fn time_of_next_stage(&mut self) -> Option<Duration> {
        let (state, ..) = self.select()?;
        let most = self.most_samples(&state);
        let (_, film) = self.film.as_ref()?;
        let pixels = u64::from(film.size().0) * u64::from(film.size().1);
        let goal = self.pace.next(film.done(), pixels, most)?;
        self.pace.predict(samples_of(Some(goal), pixels).saturating_sub(samples_of(film.done(), pixels)))
    }

    fn has_own_layer(&self, light: &str) -> bool {
        let Some(scene) = &self.scene else { return false };
        let mut lights = scene.sequence.lights.iter().zip(&scene.layers.lights);
        lights.find(|(other, _)| other.name == light).is_some_and(|(_, layer)| *layer != LayerId::CONSTANT)
    }

    pub(super) fn note_change(&mut self) {
        self.changed = Instant::now();
        self.first_picture = None;
        self.problem = None;
    }

    /// The scene with the session's changes. None before the file was good once.
    pub(super) fn scene(&mut self) -> Option<&mut SceneInUse> {
        if self.scene.is_none() {
            let sequence = self.overrides.apply(Sequence::clone(self.loaded.as_ref()?));
            let switched = |name: &str| self.overrides.lights.contains_key(name);
            self.scene = Some(SceneInUse::new(isolated(sequence, switched), self.films.budget()));
        }
        self.scene.as_mut()
    }

    /// The current frame's state and the camera of the session. None if there is no frame.
    pub(super) fn current(&mut self) -> Option<(FrameState, Option<Camera>)> {
        let (frame, view) = (self.frame, self.view.clone());
        let scene = self.scene()?;
        let clock = scene.sequence.timeline.clock(frame);
        let state = scene.state(frame).clone();
        Some((state, view.and_then(|view| view.camera(&clock))))
    }

    /// The weights of the current frame's layers, with the switches of the session.
    pub(super) fn weights(&self, state: &FrameState) -> Vec<Rgb> {
        let mut weights = state.weights.clone();
        if let Some(scene) = &self.scene {
            let time = scene.sequence.timeline.clock(state.frame).start;
            self.overrides.weigh(&scene.sequence, &scene.layers, time, &mut weights);
        }
        weights
    }

    /// Most samples per pixel of a frame.
    pub(super) fn most_samples(&self, state: &FrameState) -> u32 {
        let Some(scene) = &self.scene else { return 1 };
        let quality = &scene.sequence.quality;
        let most = match state.random {
            true => quality.noise.map_or(quality.samples, |target| target.most),
            false => quality.antialias * quality.antialias,
        };
        self.most_samples.map_or(most, |limit| limit.min(most))
    }

    /// Makes the film of the current frame the current film, if there is one. Returns what it shows.
    fn select(&mut self) -> Option<(FrameState, Option<Camera>, Vec<Rgb>)> {
        let (state, camera) = self.current()?;
        if let Some(why) = state.fault {
            let error = RenderError::Camera { frame: state.frame, why };
            self.problem = Some(format!("error: {error}"));
            return None;
        }
        let key = match &camera {
            Some(camera) => Digest::of(&(state.scene_hash, *camera)),
            None => state.scene_hash,
        };
        let weights = self.weights(&state);
        if self.film.as_ref().is_none_or(|(known, _)| *known != key) {
            if let Some((known, film)) = self.film.take().filter(|(_, film)| film.done().is_some()) {
                self.films.put(known, film, self.generation);
            }
            self.film = self.films.take(key).map(|film| (key, film));
        }
        // A layer that was dark when the film was traced may shine now.
        let shows = |film: &ProgressiveFilm| {
            film.lights() == weights.len() && lit(&weights).all(|layer| film.lit().contains(&layer))
        };
        if self.film.as_ref().is_none_or(|(_, film)| !shows(film)) {
            let all: BTreeSet<LayerId> = lit(&weights).chain(lit(&state.weights)).collect();
            let scene = self.scene()?;
            let film = scene.tracer().film(&state, all.into_iter().collect());
            self.film = Some((key, film));
        }
        Some((state, camera, weights))
    }

    /// Traces the next stage of the picture.
    pub fn step(&mut self, stop: &Stop) -> Step {
        let Some((state, camera, weights)) = self.select() else { return Step::Done };
        let most = self.most_samples(&state);
        let Some((key, mut film)) = self.film.take() else { return Step::Done };
        let pixels = u64::from(film.size().0) * u64::from(film.size().1);
        let goal =
            self.pace.next(film.done(), pixels, most).filter(|_| !self.reaches_target(&film, &weights));
        let Some(goal) = goal else {
            self.film = Some((key, film));
            return Step::Done;
        };
        // Sums over moments lose their meaning in between.
        let whole = (state.moments > 1).then(|| film.clone());
        if state.random && film.done().is_some_and(|done| done.samples.is_power_of_two()) {
            film.begin_half();
        }
        let (start, before) = (Instant::now(), samples_of(film.done(), pixels));
        let Some(scene) = self.scene() else { return Step::Done };
        let traced = scene.tracer().trace(&state, camera.as_ref(), &mut film, goal, stop);
        match traced {
            Ok((StageEnd::Complete, counts)) => {
                let took = start.elapsed();
                self.pace.note(samples_of(film.done(), pixels).saturating_sub(before), took);
                self.tracing += took;
                self.counts += counts;
                self.film = Some((key, film));
                Step::Refined
            }
            Ok((StageEnd::Stopped, counts)) => {
                self.counts += counts;
                self.film = Some((key, whole.unwrap_or(film)));
                Step::Stopped
            }
            Err(error) => {
                self.problem = Some(frame_error(error));
                Step::Done
            }
        }
    }

    /// Whether the film has the error that the file asks for.
    fn reaches_target(&self, film: &ProgressiveFilm, weights: &[Rgb]) -> bool {
        let target = self.scene.as_ref().and_then(|scene| scene.sequence.quality.noise);
        // As many as a frame has everywhere if it is good enough at once.
        let enough = |done: Refinement| done.samples >= 2 * crate::trace::MIN_SAMPLES;
        target.is_some_and(|target| {
            film.done().is_some_and(enough) && film.error(weights).is_some_and(|error| error <= target.error)
        })
    }

    /// The picture of the current frame as it is. None before its first stage.
    pub fn picture(&mut self) -> Option<(Picture, u32)> {
        let (state, camera, weights) = self.select()?;
        let (_, film) = self.film.as_ref()?;
        let (size, stride) = (film.size(), film.done()?.stride());
        if let Some(map) = self.heat_picture(&weights, &state, camera.as_ref()) {
            return Some(map);
        }
        let (_, film) = self.film.as_ref()?;
        let mut radiance = film.film(&weights)?;
        radiance.exposure = state.exposure;
        let view = self.view.clone();
        let drawing = self.scene()?.drawing(state.frame, view.as_ref());
        let tonemap = self.scene()?.sequence.output.tonemap;
        let developer = Developer::of(self.developer.take(), tonemap);
        let picture = developer.picture(&radiance, drawing.as_deref(), stride, size);
        self.developer = Some(developer);
        if self.first_picture.is_none() {
            self.first_picture = Some(self.changed.elapsed());
        }
        Some((picture, stride))
    }

    /// [`Session::picture`] as a PNG file.
    pub fn png(&mut self) -> Option<Vec<u8>> {
        let (picture, _) = self.picture()?;
        png(&picture).ok()
    }

    /// The heat map that is shown instead of the picture.
    fn heat_picture(
        &mut self,
        weights: &[Rgb],
        state: &FrameState,
        camera: Option<&Camera>,
    ) -> Option<(Picture, u32)> {
        let (key, film) = self.film.as_ref()?;
        let (key, (width, height)) = (*key, film.size());
        match self.heat? {
            HeatKind::Error => {
                let map = heat_map(&film.error_map(weights)?, width, height);
                let picture = map.picture.clone();
                self.heat_of_rays = Some((Digest::default(), map));
                Some((picture, 1))
            }
            HeatKind::Rays => {
                if self.heat_of_rays.as_ref().is_none_or(|(known, _)| *known != key) {
                    let random = state.random;
                    let see = |scene: &Scene, bvh: &Bvh, settings: &TraceSettings| {
                        rays_per_sample(scene, bvh, settings, random, HEAT_CELL, &Stop::default())
                    };
                    let rays = self.scene()?.tracer().see(state, camera, see).ok()??;
                    let (columns, rows) = (width.div_ceil(HEAT_CELL), height.div_ceil(HEAT_CELL));
                    self.heat_of_rays = Some((key, heat_map(&rays, columns, rows)));
                }
                self.heat_of_rays.as_ref().map(|(_, map)| (map.picture.clone(), HEAT_CELL))
            }
        }
    }

    /// The ends of the scale of the heat map that was shown last.
    pub(super) fn heat_scale(&self) -> Option<(f32, f32)> {
        self.heat?;
        self.heat_of_rays.as_ref().map(|(_, map)| (map.from, map.to))
    }

    /// The number of films in memory.
    pub fn films(&self) -> usize {
        self.films.len()
    }

    /// Changes the camera of the session, which begins as that of the frame.
    pub(super) fn move_camera(&mut self, change: impl FnOnce(&mut ViewCamera)) {
        let Some(mut view) = self.view_camera() else { return };
        change(&mut view);
        let clock = self.clock();
        // A camera without a direction is not taken over.
        if clock.is_some_and(|clock| view.camera(&clock).is_some()) {
            self.view = Some(view);
        }
        self.note_change();
    }

    /// The camera of the session, or of the frame.
    pub(super) fn view_camera(&mut self) -> Option<ViewCamera> {
        if let Some(view) = &self.view {
            return Some(view.clone());
        }
        let frame = self.frame;
        let scene = self.scene()?;
        let clock = scene.sequence.timeline.clock(frame);
        let index = scene.sequence.active_camera.at(clock.start).min(scene.cameras.len() - 1);
        Some(ViewCamera::of(&scene.cameras[index], &clock))
    }

    fn clock(&self) -> Option<Clock> {
        self.loaded.as_ref().map(|sequence| sequence.timeline.clock(self.frame))
    }
}

/// The number of samples of a film, of all its pixels.
fn samples_of(done: Option<Refinement>, pixels: u64) -> u64 {
    match done {
        None => 0,
        Some(done) => pixels / u64::from(done.stride()).pow(2) * u64::from(done.samples),
    }
}

/// The request of `kinora render` without options.
pub fn request(sequence: &Sequence) -> Request {
    Request {
        confined: true,
        existing: Existing::Keep,
        reuse: Reuse::Share,
        ..Request::new(sequence, sequence.output.files.clone())
    }
}

fn frame_error(error: FrameError) -> String {
    format!("error: {}", escape::lines(&RenderError::from(error).to_string()))
}
