//! Motion blur: several moments of a frame while the shutter is open.

use crate::base::time::{Clock, Timeline};
use crate::camera::CameraCuts;
use crate::camera::path::moments;
use crate::sequence::Sequence;
use crate::trace::Moment;
use crate::track::Animated;

/// The shutters of all cameras, and the active camera over time.
pub struct Shutter {
    pub cuts: CameraCuts,
    /// The open time of each camera, as a share of the time between two frames.
    open: Vec<Animated<f64>>,
    steps: u32,
}

impl Shutter {
    pub fn new(sequence: &Sequence) -> Self {
        Self {
            cuts: sequence.active_camera.clone(),
            open: sequence.cameras.iter().map(|camera| camera.value.shutter.clone()).collect(),
            steps: sequence.quality.shutter_steps,
        }
    }

    /// The camera that shows a frame; in a cross-fade, the one after the cut.
    pub fn camera(&self, timeline: &Timeline, frame: u32) -> usize {
        self.cuts.at(timeline.clock(frame).start)
    }

    /// The moments of a frame; in a cross-fade, those of the camera after the cut.
    pub fn moments(&self, timeline: &Timeline, frame: u32) -> Vec<(Clock, Moment)> {
        self.moments_of(self.camera(timeline, frame), timeline, frame)
    }

    /// The moments of a frame through one of the cameras.
    pub fn moments_of(&self, camera: usize, timeline: &Timeline, frame: u32) -> Vec<(Clock, Moment)> {
        let open = self.open.get(camera).unwrap_or(&Animated::Constant(0.0));
        let clocks = moments(open, self.steps, timeline, frame);
        let of = clocks.len() as u32;
        (0..).zip(clocks).map(|(index, clock)| (clock, Moment { index, of })).collect()
    }
}
