//! The thread of a session: takes commands, traces, and publishes pictures.

use super::camera::ViewCamera;
use super::command::{CameraMove, Command, LightField};
use super::overrides::Overrides;
use super::pick::key_time;
use super::playback::Playback;
use super::render_task::RenderTask;
use super::session::{Session, SessionOptions, Step, WatchedFiles};
use super::{forecast, planned};
use crate::base::cancel::Stop;
use crate::base::math::DVec2;
use serde_json::{Value, json};
use std::sync::atomic::Ordering::Relaxed;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender, TryRecvError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// A picture with the state of the session.
#[derive(Clone, Debug)]
pub struct Update {
    /// Counts the updates.
    pub number: u64,
    pub state: String,
    /// A PNG file. None before there is a picture.
    pub picture: Option<Arc<Vec<u8>>>,
}

/// Takes updates; called on the thread of the session.
pub type Publish = Box<dyn FnMut(Update) + Send>;

/// Takes the answer to a command.
type Reply = Box<dyn FnOnce(Value) + Send>;

enum Message {
    Command(Command, Reply),
    FilesChanged,
    Planned { generation: u64, spans: Value },
    Forecast { generation: u64, rows: Value },
    RenderEnded,
    Quit,
}

/// Sends messages to a session's thread.
#[derive(Clone)]
pub struct EngineHandle {
    sender: Sender<Message>,
    stop: Stop,
    watched: Arc<Mutex<WatchedFiles>>,
}

impl EngineHandle {
    /// Sends a command. What is being traced stops for it; `reply` gets the answer.
    pub fn command(&self, command: Command, reply: impl FnOnce(Value) + Send + 'static) {
        self.send(Message::Command(command, Box::new(reply)));
    }

    /// Tells that files have changed.
    pub fn files_changed(&self) {
        self.send(Message::FilesChanged);
    }

    /// The files whose changes matter.
    pub fn watched(&self) -> WatchedFiles {
        self.watched.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Ends the thread.
    pub fn quit(&self) {
        self.send(Message::Quit);
    }

    fn send(&self, message: Message) {
        // Nobody listens once the session has ended. The order matters: see `Engine::run`.
        let _ = self.sender.send(message);
        self.stop.flag().store(1, Relaxed);
    }
}

/// The pause between reports of a running render.
const REPORT: Duration = Duration::from_millis(500);

/// A session on its own thread.
pub struct Engine {
    session: Session,
    handle: EngineHandle,
    messages: Receiver<Message>,
    publish: Publish,
    number: u64,
    playback: Option<Playback>,
    /// The plan of a generation, and the stop of the thread that makes one.
    plan: Option<(u64, Value)>,
    planning: Option<(u64, Stop)>,
    forecast: Option<(u64, Value)>,
    forecasting: bool,
    render: Option<RenderTask>,
    picture: Option<Arc<Vec<u8>>>,
    /// Whether the page does not know the latest state.
    is_stale: bool,
}

impl Engine {
    /// Starts a session. It ends after [`EngineHandle::quit`].
    pub fn start(
        options: SessionOptions,
        publish: Publish,
    ) -> std::io::Result<(EngineHandle, JoinHandle<()>)> {
        let (sender, messages) = mpsc::channel();
        let session = Session::new(options);
        let watched = Arc::new(Mutex::new(session.watched().clone()));
        let handle = EngineHandle { sender, stop: Stop::default(), watched };
        let engine = Self {
            session,
            handle: handle.clone(),
            messages,
            publish,
            number: 0,
            playback: None,
            plan: None,
            planning: None,
            forecast: None,
            forecasting: false,
            render: None,
            picture: None,
            is_stale: true,
        };
        let thread = thread::Builder::new().name("preview".to_owned()).spawn(move || engine.run())?;
        Ok((handle, thread))
    }

    fn run(mut self) {
        self.reload();
        loop {
            // A message that arrives after this line stops the step below. One that arrived before is handled now.
            self.handle.stop.flag().store(0, Relaxed);
            if !self.take_messages() {
                break;
            }
            self.follow_playback();
            // Films that exist show at once.
            if self.is_stale && self.session.has_picture() {
                self.publish();
            }
            if self.may_step() {
                let stop = self.handle.stop.clone();
                match self.session.step(&stop) {
                    Step::Refined => {
                        if self.playback.is_none() || self.is_stale {
                            self.publish();
                        }
                        if self.session.has_all_pixels() {
                            self.begin_plan();
                        }
                        continue;
                    }
                    Step::Stopped => continue,
                    Step::Done => {}
                }
            }
            // There is no picture to wait for.
            if self.is_stale {
                self.publish();
            }
            self.begin_plan();
            if !self.wait() {
                break;
            }
        }
        if let Some((_, stop)) = &self.planning {
            stop.flag().store(1, Relaxed);
        }
        if let Some(render) = &self.render {
            render.stop();
        }
    }

    /// Whether to trace now. Whole runs and forecasts have the machine to themselves once there is a picture; while
    /// frames play, a stage must end in time.
    fn may_step(&mut self) -> bool {
        let has_picture = self.session.has_all_pixels();
        let is_busy = self.forecasting || self.render.as_ref().is_some_and(RenderTask::is_running);
        if is_busy && has_picture {
            return false;
        }
        match &self.playback {
            Some(playback) if has_picture => {
                let left = playback.until_next(Instant::now());
                self.session.time_of_next_stage().is_some_and(|time| time < left)
            }
            _ => true,
        }
    }

    /// Handles all messages that have arrived. Returns false at the end of the session.
    fn take_messages(&mut self) -> bool {
        let mut files = false;
        loop {
            match self.messages.try_recv() {
                Ok(message) => match message {
                    // Saves in a row are read once.
                    Message::FilesChanged => files = true,
                    message => {
                        if !self.handle_message(message) {
                            return false;
                        }
                    }
                },
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => return false,
            }
        }
        if files {
            self.reload();
        }
        true
    }

    /// Waits for a message, or until the next frame is due. Returns false at the end of the session.
    fn wait(&mut self) -> bool {
        let is_running = self.render.as_ref().is_some_and(RenderTask::is_running);
        let pause = match &self.playback {
            Some(playback) => Some(playback.until_next(Instant::now())),
            None => is_running.then_some(REPORT),
        };
        let received = match pause {
            Some(pause) => self.messages.recv_timeout(pause),
            None => self.messages.recv().map_err(|_| RecvTimeoutError::Disconnected),
        };
        match received {
            Ok(Message::FilesChanged) => {
                self.reload();
                true
            }
            Ok(message) => self.handle_message(message),
            Err(RecvTimeoutError::Timeout) => {
                self.is_stale |= is_running;
                true
            }
            Err(RecvTimeoutError::Disconnected) => false,
        }
    }

    fn handle_message(&mut self, message: Message) -> bool {
        match message {
            Message::Quit => return false,
            Message::FilesChanged => self.reload(),
            Message::Planned { generation, spans } => {
                self.planning = None;
                self.plan = Some((generation, spans));
                self.is_stale = true;
            }
            Message::Forecast { generation, rows } => {
                self.forecasting = false;
                self.forecast = Some((generation, rows));
                self.is_stale = true;
            }
            Message::RenderEnded => self.is_stale = true,
            Message::Command(command, reply) => {
                let answer = self.execute(command);
                reply(answer.unwrap_or_else(|error| json!({ "error": error })));
            }
        }
        true
    }

    fn reload(&mut self) {
        self.session.reload();
        self.follow_reload();
    }

    /// Takes up what the session has read.
    fn follow_reload(&mut self) {
        *self.handle.watched.lock().unwrap_or_else(PoisonError::into_inner) = self.session.watched().clone();
        if let Some((_, stop)) = self.planning.take() {
            stop.flag().store(1, Relaxed);
        }
        self.is_stale = true;
    }

    /// Goes to the frame that is due.
    fn follow_playback(&mut self) {
        let now = Instant::now();
        let Some(playback) = &mut self.playback else { return };
        match playback.due(now) {
            Some((frame, true)) => {
                self.session.go_to(frame);
                self.is_stale = true;
            }
            Some(_) => {}
            None => {
                self.playback = None;
                self.is_stale = true;
            }
        }
    }

    /// Publishes the picture as it is, with the state.
    fn publish(&mut self) {
        self.is_stale = false;
        if let Some(png) = self.session.png() {
            self.picture = Some(Arc::new(png));
        }
        let mut state = self.session.state();
        let generation = self.session.generation;
        let current = |known: &Option<(u64, Value)>| match known {
            Some((of, value)) if *of == generation => value.clone(),
            _ => Value::Null,
        };
        state["plan"] = current(&self.plan);
        state["forecast"] = current(&self.forecast);
        state["forecasting"] = self.forecasting.into();
        state["render"] = self.render.as_ref().map_or(Value::Null, RenderTask::state);
        state["playing"] = self.playback.is_some().into();
        if let Some(playback) = &self.playback {
            state["shown_per_second"] = playback.rate(Instant::now()).into();
            state["dropped"] = playback.dropped.into();
        }
        self.number += 1;
        state["number"] = self.number.into();
        let update = Update { number: self.number, state: state.to_string(), picture: self.picture.clone() };
        (self.publish)(update);
    }

    /// Makes the plan of the sequence, once there is a picture.
    fn begin_plan(&mut self) {
        let generation = self.session.generation;
        let is_known = self.plan.as_ref().is_some_and(|(known, _)| *known == generation);
        if is_known || self.planning.is_some() || self.playback.is_some() || self.forecasting {
            return;
        }
        let Some(sequence) = self.session.changed_sequence() else { return };
        let (stop, sender) = (Stop::default(), self.handle.clone());
        self.planning = Some((generation, stop.clone()));
        let plan = move || {
            let spans = planned::spans(&sequence, &stop);
            if let Some(spans) = spans.filter(|_| stop.signal().is_none()) {
                let _ = sender.sender.send(Message::Planned { generation, spans });
            }
        };
        if thread::Builder::new().name("plan".to_owned()).spawn(plan).is_err() {
            self.planning = None;
        }
    }

    fn execute(&mut self, command: Command) -> Result<Value, String> {
        let done = Ok(json!({}));
        let mut overrides = self.session.overrides.clone();
        match command {
            Command::Info => return Ok(self.session.info()),
            Command::Pick { x, y } => {
                return self.session.pick(x, y).ok_or_else(|| "there is no picture".to_owned());
            }
            Command::CopyCamera => return self.camera_text(|view, up, _| view.ron(up)),
            Command::CopyKey => return self.camera_text(|view, up, time| view.key(up, time)),
            Command::Place(names) => return self.session.place(&names),
            Command::WriteCamera => return self.write_camera(),
            Command::WriteLight { index, field } => return self.write_light(index, &field),
            Command::Frame(frame) => {
                self.playback = None;
                self.session.go_to(frame);
            }
            Command::Play { from, to, repeats, speed } => self.play((from, to), repeats, speed),
            Command::Pause => self.playback = None,
            Command::Light { index, on } => {
                let name = self.session.loaded.as_ref().and_then(|sequence| sequence.lights.get(index));
                let name = name.map(|light| light.name.clone()).ok_or("there is no such light")?;
                match on {
                    Some(on) => overrides.lights.insert(name, on),
                    None => overrides.lights.remove(&name),
                };
                self.session.set_overrides(overrides);
            }
            Command::Size(size) => {
                overrides.size = size;
                self.session.set_overrides(overrides);
            }
            Command::Bounces(bounces) => {
                overrides.bounces = bounces;
                self.session.set_overrides(overrides);
            }
            Command::Antialias(antialias) => {
                overrides.antialias = antialias;
                self.session.set_overrides(overrides);
            }
            Command::Samples(samples) => {
                overrides.samples = samples;
                self.session.set_overrides(overrides);
            }
            Command::Camera(change) => self.move_camera(change),
            Command::Reset => {
                self.session.view = None;
                let size = self.session.options.size;
                self.session.set_overrides(Overrides { size, ..Overrides::default() });
            }
            Command::Heat(heat) => self.session.heat = heat,
            Command::Forecast => self.begin_forecast()?,
            Command::Render { from } => self.begin_render(from)?,
            Command::StopRender => {
                if let Some(render) = &self.render {
                    render.stop();
                }
            }
        }
        self.is_stale = true;
        done
    }

    fn play(&mut self, range: (u32, u32), repeats: bool, speed: f64) {
        let Some(sequence) = &self.session.loaded else { return };
        let rate = sequence.timeline.rate.per_second();
        let rate = *rate.numer() as f64 / *rate.denom() as f64;
        let last = self.session.frames().saturating_sub(1);
        let range = (range.0.min(last), range.1.min(last));
        let speed = if speed.is_finite() { speed.clamp(0.01, 100.0) } else { 1.0 };
        self.playback = Some(Playback::new(range, self.session.frame, repeats, rate * speed, Instant::now()));
    }

    fn move_camera(&mut self, change: CameraMove) {
        if change == CameraMove::Reset {
            self.session.view = None;
            self.session.note_change();
            return;
        }
        let change = |view: &mut ViewCamera| match change {
            CameraMove::Orbit(x, y) => view.orbit(DVec2::new(x, y)),
            CameraMove::Pan(x, y) => view.pan(DVec2::new(x, y)),
            CameraMove::Step(forward, right, up) => view.step(forward, right, up),
            CameraMove::Dolly(factor) => view.dolly(factor),
            CameraMove::Zoom(factor) => view.zoom(factor),
            CameraMove::Projection => view.switch_projection(),
            CameraMove::Reset => {}
        };
        self.session.move_camera(change);
    }

    fn camera_text(
        &mut self,
        text: impl FnOnce(&ViewCamera, crate::base::math::UpAxis, &str) -> String,
    ) -> Result<Value, String> {
        let view = self.session.view_camera().ok_or("there is no camera")?;
        let sequence = self.session.loaded.as_ref().ok_or("there is no sequence")?;
        let time = key_time(sequence.timeline.clock(self.session.frame).start);
        Ok(json!({ "text": text(&view, sequence.up, &time) }))
    }

    fn begin_forecast(&mut self) -> Result<(), String> {
        let sequence = self.session.changed_sequence().ok_or("there is no sequence")?;
        if self.forecasting {
            return Ok(());
        }
        let (generation, sender) = (self.session.generation, self.handle.clone());
        let work = move || {
            let rows = forecast::forecast(&sequence);
            let _ = sender.sender.send(Message::Forecast { generation, rows });
        };
        thread::Builder::new().name("forecast".to_owned()).spawn(work).map_err(|error| error.to_string())?;
        self.forecasting = true;
        Ok(())
    }

    fn begin_render(&mut self, from: u32) -> Result<(), String> {
        if self.render.as_ref().is_some_and(RenderTask::is_running) {
            return Err("a render is running".to_owned());
        }
        if self.session.diagnostics().is_some() {
            return Err("the file has mistakes".to_owned());
        }
        let sequence = self.session.loaded.clone().ok_or("there is no sequence")?;
        let sender = self.handle.clone();
        let ended = move || {
            let _ = sender.sender.send(Message::RenderEnded);
        };
        self.render = Some(RenderTask::start(sequence, from, ended)?);
        Ok(())
    }

    fn write_camera(&mut self) -> Result<Value, String> {
        self.session.write_camera()?;
        Ok(self.written())
    }

    fn write_light(&mut self, index: usize, field: &LightField) -> Result<Value, String> {
        self.session.write_light(index, field)?;
        Ok(self.written())
    }

    /// The answer to what was written, which the session has read.
    fn written(&mut self) -> Value {
        self.follow_reload();
        json!({ "written": true })
    }
}
