//! A plan carried out.

use super::Plan;
use crate::film::Film;
use crate::schedule::{FilmSink, FrameLoop, NoFrame};
use std::collections::HashMap;

/// Makes the plan's frames one after the other, as long as `on` says so. Gives the number of those that were begun.
pub fn run<S: FilmSink>(
    plan: &Plan,
    frames: &mut FrameLoop<S>,
    on: impl Fn() -> bool,
) -> Result<usize, NoFrame> {
    let mut kept: HashMap<usize, Film> = HashMap::new();
    let mut done = 0;
    for (index, (look, &film)) in plan.survey.frames.iter().zip(&plan.of).enumerate() {
        if !on() {
            break;
        }
        done += 1;
        let take = &plan.takes[film];
        let again = take.frames.last() != Some(&index);
        match kept.remove(&film) {
            Some(traced) => {
                frames.reuse(look, &traced)?;
                if again {
                    kept.insert(film, traced);
                }
            }
            None => {
                let traced = frames.trace(look, &take.lit)?;
                kept.extend(traced.filter(|_| again).map(|traced| (film, traced)));
            }
        }
    }
    Ok(done)
}
