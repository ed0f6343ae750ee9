//! The sequence that a session shows, with its changes, ready to trace any frame.

use super::camera::ViewCamera;
use crate::base::digest::Digest;
use crate::camera::path::CameraPath;
use crate::drawing::Drawing;
use crate::film::AovSet;
use crate::pipeline::drawings::drawings;
use crate::pipeline::schedule::{FrameState, Preview, ProgressiveLoop};
use crate::sequence::{LightLayers, Sequence};
use crate::trace::ProgressiveFilm;
use std::collections::HashMap;
use std::sync::Arc;

/// A sequence with the session's changes, and its worlds.
pub struct SceneInUse {
    pub sequence: Sequence,
    pub layers: LightLayers,
    /// The cameras, fitted to what they frame.
    pub cameras: Vec<CameraPath>,
    evaluator: Preview,
    pub tracer: Option<ProgressiveLoop>,
    states: HashMap<u32, FrameState>,
    drawings: HashMap<(u32, Option<Digest>), Option<Arc<Drawing>>>,
    /// The divisor of the size, if films of the whole size would take too much memory.
    pub reduced: u32,
}

impl SceneInUse {
    pub fn new(mut sequence: Sequence, budget: u64) -> Self {
        let layers = sequence.light_layers();
        let all = layers.count + usize::from(sequence.output.transparent);
        let mut reduced = 1;
        // A film must leave room for another one.
        while ProgressiveFilm::bytes_of(sequence.output.size, all) > budget / 2 && sequence.output.size.0 > 64
        {
            let (width, height) = sequence.output.size;
            sequence.output.size = (width.div_ceil(2), height.div_ceil(2).max(1));
            reduced *= 2;
        }
        let cameras = (0..sequence.cameras.len()).map(|index| sequence.fitted_camera(index)).collect();
        Self {
            cameras,
            evaluator: Preview::new(&sequence),
            layers,
            tracer: None,
            states: HashMap::new(),
            drawings: HashMap::new(),
            reduced,
            sequence,
        }
    }

    pub fn state(&mut self, frame: u32) -> &FrameState {
        self.states.entry(frame).or_insert_with(|| self.evaluator.state(frame))
    }

    /// The world that traces, which is made when the first film needs it.
    pub fn tracer(&mut self) -> &mut ProgressiveLoop {
        let aovs = AovSet::of_picture(self.sequence.output.transparent);
        self.tracer.get_or_insert_with(|| ProgressiveLoop::new(&self.sequence, aovs))
    }

    /// What is drawn over a frame.
    pub fn drawing(&mut self, frame: u32, view: Option<&ViewCamera>) -> Option<Arc<Drawing>> {
        if self.sequence.annotations.is_empty() && self.sequence.output.caption.is_none() {
            return None;
        }
        let clock = self.sequence.timeline.clock(frame);
        let key = (frame, view.and_then(|view| view.camera(&clock)).map(|camera| Digest::of(&camera)));
        if let Some(known) = self.drawings.get(&key) {
            return known.clone();
        }
        let drawn = match view {
            None => drawings(&self.sequence, &[frame]),
            Some(view) => {
                let mut moved = self.sequence.clone();
                moved.cameras.iter_mut().for_each(|camera| camera.value = view.path());
                drawings(&moved, &[frame])
            }
        };
        let drawing = drawn.into_iter().next();
        self.drawings.insert(key, drawing.clone());
        drawing
    }
}
