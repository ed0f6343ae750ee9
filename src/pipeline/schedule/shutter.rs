//! Motion blur: several moments of a frame while the shutter is open.

use crate::base::time::{Clock, Timeline};
use crate::camera::path::moments;
use crate::sequence::Sequence;
use crate::trace::Moment;
use crate::track::Animated;

/// The shutters of all cameras, and the active camera over time.
pub struct Shutter {
    active: Animated<usize>,
    /// The open time of each camera, as a share of the time between two frames.
    open: Vec<Animated<f64>>,
    steps: u32,
}

impl Shutter {
    pub fn new(sequence: &Sequence) -> Self {
        Self {
            active: sequence.active_camera.clone(),
            open: sequence.cameras.iter().map(|camera| camera.value.shutter.clone()).collect(),
            steps: sequence.quality.shutter_steps,
        }
    }

    /// The moments of a frame.
    pub fn moments(&self, timeline: &Timeline, frame: u32) -> Vec<(Clock, Moment)> {
        let camera = self.active.at(timeline.clock(frame).start);
        let open = self.open.get(camera).unwrap_or(&Animated::Constant(0.0));
        let clocks = moments(open, self.steps, timeline, frame);
        let of = clocks.len() as u32;
        (0..).zip(clocks).map(|(index, clock)| (clock, Moment { index, of })).collect()
    }
}
