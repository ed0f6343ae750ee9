//! Executes a plan.

use super::render_plan::Plan;
use crate::film::Film;
use crate::pipeline::schedule::{FilmSink, FrameError, FrameLoop};
use std::collections::HashMap;

/// Renders the plan's frames in order while `on` returns true. Returns the number of finished frames. If a film stops
/// before it reaches its target error, the next frames of the same film are pushed too, but do not count.
pub fn run<S: FilmSink>(
    plan: &Plan,
    frames: &mut FrameLoop<S>,
    on: impl Fn() -> bool,
) -> Result<usize, FrameError> {
    let mut kept: HashMap<usize, Film> = HashMap::new();
    let mut done = 0;
    for (index, (state, &film)) in plan.states.frames.iter().zip(&plan.film_of).enumerate() {
        if !on() {
            break;
        }
        done += 1;
        let shared = &plan.films[film];
        let again = shared.frames.last() != Some(&index);
        match kept.remove(&film) {
            Some(traced) => {
                frames.reuse(state, &traced)?;
                if again {
                    kept.insert(film, traced);
                }
            }
            None => {
                let traced = frames.trace(state, &shared.lit)?;
                if let Some(film) = traced.as_ref().filter(|film| film.unfinished) {
                    let next = plan.states.frames.iter().zip(&plan.film_of).skip(index + 1);
                    let alike = next.take_while(|(_, other)| **other == plan.film_of[index]);
                    alike.into_iter().try_for_each(|(state, _)| frames.reuse(state, film))?;
                    return Ok(index);
                }
                kept.extend(traced.filter(|_| again).map(|traced| (film, traced)));
            }
        }
    }
    Ok(done)
}
