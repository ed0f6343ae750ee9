//! What the whole film costs by the file's own setting.

use super::Point;
use crate::accuracy::studio::Studio;
use crate::film::Extras;
use crate::pipeline::filmstrip::spread;
use crate::pipeline::plan::Plan;
use crate::pipeline::render::{RenderError, Reuse};
use crate::sequence::Sequence;
use crate::sequence::quality::Quality;

/// All frames of a sequence in its own size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Whole {
    pub frames: u32,
    /// Pictures that are traced: frames in which only lights change are made of the same one.
    pub films: usize,
    /// Seconds of tracing, on the threads of the measurement.
    pub wall: f64,
    /// Of all processors together, where the system tells.
    pub cpu: Option<f64>,
}

/// Films whose cost is compared with that of the frames that were measured.
const LOOKS: u32 = 5;
/// Their samples, at most.
const SAMPLES: u32 = 4;

impl Whole {
    /// The measured frames say what a frame costs; a few samples of films that are spread over the sequence say how much
    /// more or less the others do.
    pub fn of(sequence: &Sequence, studio: &Studio, own: &Point) -> Result<Self, RenderError> {
        let all: Vec<u32> = (0..sequence.timeline.frames).collect();
        let room = Reuse::default().budget(sequence, Extras::default());
        let plan = studio.install(|| Plan::new(sequence, &all, Extras::default(), room));
        let few = Quality { samples: SAMPLES.min(sequence.quality.samples), noise: None, ..sequence.quality };
        // What is done for the first time takes longer.
        studio.shoot(&few)?;
        let frames = studio.frames() as f64;
        let measured = studio.shoot(&few)?.took.alone() / frames;
        let (mut sum, mut count) = (0.0, 0.0);
        for place in spread(plan.takes.len() as u32, LOOKS) {
            let take = &plan.takes[place as usize];
            let look = &plan.survey.frames[take.frames[0]];
            if look.fault.is_none() {
                sum += studio.take(&few, Extras::default(), look, &take.lit)?.took.alone() / measured;
                count += 1.0;
            }
        }
        let films = plan.takes.len();
        let (width, height) = sequence.output.size;
        let larger = f64::from(width) * f64::from(height) / (studio.pixels() / frames);
        let more = if count > 0.0 { sum / count } else { 1.0 } * films as f64 * larger;
        let cpu = own.cpu.map(|cpu| cpu.median * more);
        // Pictures of few pixels do not keep all threads busy; those of the film do.
        let wall = cpu.map_or(own.wall.median * more, |cpu| cpu / studio.threads() as f64);
        Ok(Self { frames: sequence.timeline.frames, films, wall, cpu })
    }
}
