//! A plan carried out.

use super::Plan;
use crate::film::Film;
use crate::pipeline::schedule::{FilmSink, FrameLoop, NoFrame};
use std::collections::HashMap;

/// Makes the plan's frames one after the other, as long as `on` says so. Gives the number of those that are made. If a film
/// was stopped before it was good enough, those frames that come next and are made of it are pushed too, and do not count.
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
                if let Some(film) = traced.as_ref().filter(|film| film.unfinished) {
                    let next = plan.survey.frames.iter().zip(&plan.of).skip(index + 1);
                    let alike = next.take_while(|(_, other)| **other == plan.of[index]);
                    alike.into_iter().try_for_each(|(look, _)| frames.reuse(look, film))?;
                    return Ok(index);
                }
                kept.extend(traced.filter(|_| again).map(|traced| (film, traced)));
            }
        }
    }
    Ok(done)
}
