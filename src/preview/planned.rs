//! The plan of the whole sequence for the timeline: which frames are traced, and which reuse a film.

use crate::base::cancel::Stop;
use crate::film::AovSet;
use crate::pipeline::plan::{Plan, evaluate_until};
use crate::pipeline::render::Reuse;
use crate::sequence::Sequence;
use serde_json::{Value, json};

/// Consecutive frames of one kind: `traced`, `reused`, or `mixed` if their films share paths or samples. None if it was
/// stopped.
pub fn spans(sequence: &Sequence, stop: &Stop) -> Option<Value> {
    let frames: Vec<u32> = (0..sequence.timeline.frames).collect();
    let states = evaluate_until(sequence, &frames, stop);
    if states.frames.len() < frames.len() {
        return None;
    }
    let aovs = AovSet::of_picture(sequence.output.transparent);
    let plan = Plan::from_states(states, sequence, aovs, Reuse::Share.budget(sequence, aovs));
    let mut shared = vec![false; plan.films.len()];
    let mut film = 0;
    while film < plan.films.len() {
        let together = plan.view_group(film).map_or_else(|| plan.together(film), |group| group.films.len());
        if together > 1 {
            shared[film..(film + together).min(plan.films.len())].fill(true);
        }
        film += together.max(1);
    }
    let kind = |index: usize| {
        let film = plan.film_of[index];
        match plan.films[film].frames.first() == Some(&index) {
            true if shared[film] => "mixed",
            true => "traced",
            false => "reused",
        }
    };
    let mut spans: Vec<(usize, usize, &str)> = Vec::new();
    for index in 0..frames.len() {
        match spans.last_mut() {
            Some((_, last, other)) if *other == kind(index) => *last = index,
            _ => spans.push((index, index, kind(index))),
        }
    }
    let span =
        |(first, last, kind): (usize, usize, &str)| json!({ "first": first, "last": last, "kind": kind });
    Some(json!({
        "films": plan.films.len(),
        "reused": plan.reused(),
        "spans": spans.into_iter().map(span).collect::<Vec<_>>(),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::parse;

    #[test]
    fn spans_tell_traced_and_reused_frames() {
        let text = r#"(
            timeline: (frames: 8, fps: 4, keys: Frames), output: (size: (16, 8)),
            camera: (position: [(0, (0, 0, 5)), (2, (0, 0, 6))]),
            lights: { "a": Point(position: (1, 2, 3), intensity: [(3, 1), (7, 0)]) },
            objects: { "ball": (shape: Sphere()) },
        )"#;
        let spans = spans(&parse("a.ron", text).expect("a sequence"), &Stop::default()).expect("a plan");
        assert_eq!((spans["films"].as_u64(), spans["reused"].as_u64()), (Some(3), Some(5)));
        let kinds = spans["spans"].as_array().expect("spans");
        assert_eq!(kinds[0], json!({ "first": 0, "last": 2, "kind": "traced" }));
        assert_eq!(kinds[1], json!({ "first": 3, "last": 7, "kind": "reused" }));
        let stopped = Stop::default();
        stopped.flag().store(1, std::sync::atomic::Ordering::Relaxed);
        assert_eq!(super::spans(&parse("a.ron", text).expect("a sequence"), &stopped), None);
    }
}
