//! Frames and their times.

use super::measure::{Case, Verdict, Workload, method};
use super::number::Float;
use crate::base::time::{Rate, Timeline};

/// A frame, and the rate of broadcasts: 30000/1001 frames a second, called 29.97.
type Frame = (u32, Rate, Timeline);

/// The frame at the time of frame k, which should be k, rounded down.
fn there_and_back<R: Float>(frame: &Frame) -> u32 {
    let rate = R::of(30_000.0) / R::of(1001.0);
    let time = R::of(frame.0.into()) / rate;
    (time * rate).floor().wide() as u32
}

/// The same, rounded to the nearest frame.
fn rounded(frame: &Frame) -> u32 {
    let rate = 30_000.0f32 / 1001.0;
    let time = frame.0 as f32 / rate;
    (time * rate + 0.5).floor() as u32
}

fn ours((frame, rate, timeline): &Frame) -> u32 {
    timeline.frame_at(rate.time_of(*frame))
}

fn judge(frame: &Frame, found: u32) -> Verdict {
    Verdict { off: Some(f64::from(found.abs_diff(frame.0))), wrong: found != frame.0 }
}

pub fn cases(workload: Workload) -> Vec<Case> {
    let Some(rate) = Rate::new(30_000, 1001) else { return Vec::new() };
    let case = |what, first: u32| {
        let timeline = Timeline::of_frames(first + workload.inputs, rate);
        let frames: Vec<Frame> = (first..first + workload.inputs).map(|k| (k, rate, timeline)).collect();
        Case {
            id: "CA-07",
            what,
            error: "largest error, in frames",
            wrong: "another frame",
            methods: [
                method(frames.clone(), there_and_back::<f32>, judge),
                method(frames.clone(), there_and_back::<f64>, judge),
                method(frames.clone(), rounded, judge),
                method(frames, ours, judge),
            ],
        }
    };
    vec![
        case("frame at the time of frame k, at 30000/1001 frames a second, from frame 0 on", 0),
        case("the same from frame 10^6 on", 1_000_000),
        case("the same from frame 10^8 on", 100_000_000),
    ]
}
