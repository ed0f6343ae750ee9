//! The cost of the whole sequence at the file's own setting.

use super::point::Point;
use crate::accuracy::renderer::Renderer;
use crate::film::AovSet;
use crate::pipeline::filmstrip::spread;
use crate::pipeline::plan::Plan;
use crate::pipeline::render::{RenderError, Reuse};
use crate::sequence::Sequence;
use crate::sequence::quality::Quality;

/// The cost of all frames of a sequence at its own size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SequenceCost {
    pub frames: u32,
    /// Films that are traced. Frames in which only lights change share one film.
    pub films: usize,
    /// Predicted wall time of tracing on the threads of the measurement, in seconds.
    pub wall: f64,
    /// Predicted processor time of all threads, in seconds, if the system reports processor times.
    pub cpu: Option<f64>,
}

/// Number of films whose cost is compared with that of the measured frames.
const LOOKS: u32 = 5;
/// The largest number of samples of these films.
const SAMPLES: u32 = 4;

impl SequenceCost {
    /// Predicts the cost from the measured frames `own`, and from a few samples of films that are spread over the
    /// sequence: these give the ratio of the cost of other films to that of the measured frames.
    pub fn of(sequence: &Sequence, renderer: &Renderer, own: &Point) -> Result<Self, RenderError> {
        let all: Vec<u32> = (0..sequence.timeline.frames).collect();
        let room = Reuse::default().budget(sequence, AovSet::default());
        let plan = renderer.install(|| Plan::new(sequence, &all, AovSet::default(), room));
        let few = Quality { samples: SAMPLES.min(sequence.quality.samples), noise: None, ..sequence.quality };
        // A warm-up, because the first render takes longer.
        renderer.render(&few)?;
        let frames = renderer.frames() as f64;
        let measured = renderer.render(&few)?.took.on_one_thread() / frames;
        let (mut sum, mut count) = (0.0, 0.0);
        for place in spread(plan.films.len() as u32, LOOKS) {
            let take = &plan.films[place as usize];
            let look = &plan.states.frames[take.frames[0]];
            if look.fault.is_none() {
                sum += renderer.render_film(&few, AovSet::default(), look, &take.lit)?.took.on_one_thread()
                    / measured;
                count += 1.0;
            }
        }
        let films = plan.films.len();
        let (width, height) = sequence.output.size;
        let larger = f64::from(width) * f64::from(height) / (renderer.pixels() / frames);
        let more = if count > 0.0 { sum / count } else { 1.0 } * films as f64 * larger;
        let cpu = own.cpu.map(|cpu| cpu.median * more);
        // Small pictures do not keep all threads busy; pictures of full size do.
        let wall = cpu.map_or(own.wall.median * more, |cpu| cpu / renderer.threads() as f64);
        Ok(Self { frames: sequence.timeline.frames, films, wall, cpu })
    }
}
