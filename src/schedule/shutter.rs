//! Motion blur: a frame as several moments while the shutter is open.

use crate::sequence::Sequence;
use crate::time::{Clock, Time, Timeline};
use crate::trace::Moment;
use crate::track::Animated;

/// When each camera's shutter is open, and which camera is looked through.
pub struct Shutter {
    active: Animated<usize>,
    /// Of each camera, as a share of the time between two frames.
    open: Vec<Animated<f64>>,
    steps: u32,
}

/// Shares of a frame are counted in millionths, so that times stay exact.
const MILLION: i128 = 1_000_000;

impl Shutter {
    pub fn new(sequence: &Sequence) -> Self {
        Self {
            active: sequence.active_camera.clone(),
            open: sequence.cameras.iter().map(|camera| camera.value.shutter.clone()).collect(),
            steps: sequence.quality.shutter_steps,
        }
    }

    /// The moments of a frame: its start alone if the shutter does not stay open, else the middles of equal
    /// parts of the time that it does.
    pub fn moments(&self, timeline: &Timeline, frame: u32) -> Vec<(Clock, Moment)> {
        let clock = timeline.clock(frame);
        let camera = self.active.at(clock.start);
        let open = self.open.get(camera).map_or(0.0, |open| open.at(clock.start).clamp(0.0, 1.0));
        let open = (open * MILLION as f64).round() as i128;
        if open == 0 {
            return vec![(clock, Moment::ONLY)];
        }
        let of = self.steps;
        let after = |index: u32| {
            let share = Time::new(open * i128::from(2 * index + 1), MILLION * 2 * i128::from(of));
            share / timeline.rate.per_second()
        };
        (0..of).map(|index| (clock.later(after(index)), Moment { index, of })).collect()
    }
}
