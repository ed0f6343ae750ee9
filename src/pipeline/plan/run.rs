//! Executes a plan.

use super::render_plan::Plan;
use super::tries::Tries;
use crate::film::Film;
use crate::pipeline::schedule::{FilmSink, FrameError, FrameLoop, FrameState};
use std::collections::HashMap;

/// Renders the plan's frames in order while `on` returns true. Then it pushes frames only as far as the last film that was
/// traced together with others and is in no frame yet. Returns the number of finished frames. If a film stops before it
/// reaches its target error, the next frames of the same film are pushed too, but do not count.
pub fn run<S: FilmSink>(
    plan: &Plan,
    frames: &mut FrameLoop<S>,
    on: impl Fn() -> bool,
) -> Result<usize, FrameError> {
    let mut pending = Pending { plan, kept: HashMap::new(), next: 0 };
    // The first film that has not been tried to trace together with others.
    let (mut untried, mut tries) = (0, Tries::default());
    while let Some((state, &film)) = plan.states.frames.get(pending.next).zip(plan.film_of.get(pending.next))
    {
        let (index, shared) = (pending.next, &plan.films[film]);
        let (is_first, again) = (shared.frames.first() == Some(&index), shared.frames.last() != Some(&index));
        if on() && is_first && film >= untried && !pending.kept.contains_key(&film) {
            untried = trace_together(plan, film, frames, (&mut pending, &mut tries))?;
            continue;
        }
        // If the run is stopped, films that were traced together and not pushed yet are not lost. Films that were pushed
        // are no reason to go on, however many frames repeat them.
        let is_new = |film: &usize| plan.films[*film].frames.first().is_some_and(|first| *first >= index);
        if !(on() || pending.kept.contains_key(&film) && pending.kept.keys().any(is_new)) {
            break;
        }
        if pending.push_next(frames)? {
            continue;
        }
        let _span = tracing::info_span!("frame", frame = state.frame).entered();
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
        pending.kept.extend(traced.filter(|_| again).map(|traced| (film, traced)));
        pending.next += 1;
    }
    Ok(pending.next)
}

/// The frames that are still to be pushed.
struct Pending<'p> {
    plan: &'p Plan,
    /// Films that some of them show, by their numbers.
    kept: HashMap<usize, Film>,
    /// The index of the first of them.
    next: usize,
}

impl Pending<'_> {
    /// Pushes the next frame, if its film is kept.
    fn push_next<S: FilmSink>(&mut self, frames: &mut FrameLoop<S>) -> Result<bool, FrameError> {
        let Self { plan, kept, next } = self;
        let Some((state, film)) = plan.states.frames.get(*next).zip(plan.film_of.get(*next)) else {
            return Ok(false);
        };
        let Some(traced) = kept.remove(film) else { return Ok(false) };
        let _span = tracing::info_span!("frame", frame = state.frame).entered();
        let shown_in = &plan.films[*film].frames;
        if shown_in.first() == Some(next) {
            frames.push(state, &traced)?;
        } else {
            frames.reuse(state, &traced)?;
        }
        if shown_in.last() != Some(next) {
            kept.insert(*film, traced);
        }
        *next += 1;
        Ok(true)
    }
}

/// Traces films from number `first` on together, as many as the plan and memory allow. Frames are pushed as soon as their
/// films are complete, in order. Returns the number of the first film that may be tried next.
fn trace_together<S: FilmSink>(
    plan: &Plan,
    first: usize,
    frames: &mut FrameLoop<S>,
    (pending, tries): (&mut Pending<'_>, &mut Tries),
) -> Result<usize, FrameError> {
    let views = plan.view_group(first).map(|group| group.films.len());
    let together = views.unwrap_or_else(|| plan.together(first));
    if together < 2 {
        return Ok(first + 1);
    }
    let films = &plan.films[first..first + together];
    let states: Vec<&FrameState> = films.iter().map(|film| &plan.states.frames[film.frames[0]]).collect();
    let lit = Plan::lit(films);
    if views.is_some() {
        let films = frames.trace_views(&states, &lit)?;
        let traced = films.len();
        pending.kept.extend((first..).zip(films));
        return Ok(first + tries.next(together, traced, true));
    }
    let mut number = first;
    let group = frames.trace_together(&states, &lit, plan.scenes_budget(), &mut |frames, film| {
        pending.kept.insert(number, film);
        // Not the frames that repeat it: a stop may leave these out.
        let is_due = |next: usize| plan.films[number].frames.first().is_some_and(|first| next <= *first);
        while is_due(pending.next) && pending.push_next(frames)? {}
        number += 1;
        Ok(())
    })?;
    Ok(first + tries.next(together, group.films, group.pays))
}
