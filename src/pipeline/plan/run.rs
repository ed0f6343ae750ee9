//! Executes a plan.

use super::render_plan::Plan;
use super::tries::Tries;
use crate::film::Film;
use crate::pipeline::schedule::{FilmSink, FrameError, FrameLoop, FrameState, PathGroup};
use std::collections::HashMap;

/// Renders the plan's frames in order while `on` returns true. Then it pushes frames only as far as the last film that was
/// traced together with others and is in no frame yet. Returns the number of finished frames. If a film stops before it
/// reaches its target error, the next frames of the same film are pushed too, but do not count.
pub fn run<S: FilmSink>(
    plan: &Plan,
    frames: &mut FrameLoop<S>,
    on: impl Fn() -> bool,
) -> Result<usize, FrameError> {
    let mut kept: HashMap<usize, Film> = HashMap::new();
    // The first film that has not been tried to trace together with others.
    let (mut untried, mut tries) = (0, Tries::default());
    let mut done = 0;
    for (index, (state, &film)) in plan.states.frames.iter().zip(&plan.film_of).enumerate() {
        let shared = &plan.films[film];
        let _span = tracing::info_span!("frame", frame = state.frame).entered();
        let (is_first, again) = (shared.frames.first() == Some(&index), shared.frames.last() != Some(&index));
        if on() && is_first && film >= untried && !kept.contains_key(&film) {
            untried = trace_together(plan, film, frames, (&mut kept, &mut tries))?;
        }
        // If the run is stopped, films that were traced together and not pushed yet are not lost. Films that were pushed
        // are no reason to go on, however many frames repeat them.
        let is_new = |film: &usize| plan.films[*film].frames.first().is_some_and(|first| *first >= index);
        if !(on() || kept.contains_key(&film) && kept.keys().any(is_new)) {
            break;
        }
        done += 1;
        match kept.remove(&film) {
            Some(traced) => {
                if is_first {
                    frames.push(state, &traced)?
                } else {
                    frames.reuse(state, &traced)?
                }
                if again {
                    kept.insert(film, traced);
                }
            }
            None => {
                let traced = frames.trace(state, &shared.lit)?;
                if traced.is_none() {
                    return Ok(index);
                }
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

/// Traces films from number `first` on together, as many as the plan and memory allow. Returns the number of the first
/// film that may be tried next.
fn trace_together<S: FilmSink>(
    plan: &Plan,
    first: usize,
    frames: &mut FrameLoop<S>,
    (kept, tries): (&mut HashMap<usize, Film>, &mut Tries),
) -> Result<usize, FrameError> {
    let views = plan.view_group(first).map(|group| group.films.len());
    let together = views.unwrap_or_else(|| plan.together(first));
    if together < 2 {
        return Ok(first + 1);
    }
    let films = &plan.films[first..first + together];
    let states: Vec<&FrameState> = films.iter().map(|film| &plan.states.frames[film.frames[0]]).collect();
    let group = match views {
        Some(_) => {
            PathGroup { films: frames.trace_views(&states, &Plan::lit(films))?, end: None, pays: true }
        }
        None => frames.trace_together(&states, &Plan::lit(films), plan.scenes_budget())?,
    };
    let traced = group.films.len();
    let next = tries.next(together, traced, group.pays);
    kept.extend((first..).zip(group.films));
    Ok(first + next)
}
