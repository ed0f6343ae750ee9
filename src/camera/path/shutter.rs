//! The moments of a frame while the shutter is open.

use crate::base::time::{Clock, Time, Timeline};
use crate::track::Animated;

/// Shares of a frame are multiples of a millionth, so that times stay exact.
const MILLION: i128 = 1_000_000;

/// The moments of a frame. If the shutter does not stay open, only the start of the frame; otherwise the midpoints of
/// `steps` equal parts of the time that it is open. `open` is a share of the time between two frames.
pub fn moments(open: &Animated<f64>, steps: u32, timeline: &Timeline, frame: u32) -> Vec<Clock> {
    let clock = timeline.clock(frame);
    let open = (open.at(clock.start).clamp(0.0, 1.0) * MILLION as f64).round() as i128;
    if open == 0 {
        return vec![clock];
    }
    let after = |index: u32| {
        let share = Time::new(open * i128::from(2 * index + 1), MILLION * 2 * i128::from(steps));
        share / timeline.rate.per_second()
    };
    (0..steps).map(|index| clock.later(after(index))).collect()
}
