//! Executes a plan together with other processes: the first process to claim a film renders its frames.

use super::evaluate::FrameStates;
use super::render_plan::Plan;
use super::run::run;
use super::shared_films::{FilmCache, shared_films};
use crate::encode::{Encoder, FrameLease};
use crate::pipeline::schedule::{FrameError, FrameLoop, FrameState};
use std::thread::sleep;
use std::time::Duration;

/// Pause before checking again whether other processes have finished their films.
const PAUSE: Duration = Duration::from_millis(500);

/// The result of a shared run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SharedRun {
    /// Number of frames that this process began.
    pub done: usize,
    /// Whether all frames exist, whichever process rendered them.
    pub complete: bool,
}

/// Renders film after film while `on` returns true, except those that other processes render. Then waits for those,
/// and takes over any that nobody renders any more. Calls `there` with the number of frames that others rendered.
pub fn run_shared(
    states: &FrameStates,
    cache: FilmCache,
    frames: &mut FrameLoop<Encoder>,
    on: impl Fn() -> bool,
    there: impl Fn(usize),
) -> Result<SharedRun, FrameError> {
    let (films, _) = shared_films(&states.frames, &FilmCache { budget: u64::MAX, ..cache });
    let state = |&index: &usize| states.frames[index].clone();
    let mut open: Vec<Vec<FrameState>> =
        films.iter().map(|film| film.frames.iter().map(state).collect()).collect();
    let mut done = 0;
    loop {
        let before = open.len();
        let mut theirs = Vec::new();
        for film in open {
            if !on() {
                return Ok(SharedRun { done, complete: false });
            }
            let numbers: Vec<u32> = film.iter().map(|state| state.frame).collect();
            let name = film.first().map(|state| state.scene_hash).unwrap_or_default();
            let lease = frames
                .with_sink(|encoder| encoder.lease_frames(name, &numbers))
                .map_err(FrameError::Encode)?;
            let missing = match lease {
                FrameLease::HeldBy(_) => {
                    theirs.push(film);
                    continue;
                }
                FrameLease::Done => Vec::new(),
                FrameLease::Acquired(missing) => missing,
            };
            there(numbers.len() - missing.len());
            let states: Vec<FrameState> =
                film.into_iter().filter(|state| missing.contains(&state.frame)).collect();
            let (films, film_of) = shared_films(&states, &cache);
            let wanted = states.len();
            let begun = run(
                &Plan {
                    states: FrameStates { frames: states },
                    cache,
                    films,
                    film_of,
                    sharing_budget: 0,
                    view_groups: Vec::new(),
                },
                frames,
                &on,
            )?;
            done += begun;
            if begun < wanted {
                return Ok(SharedRun { done, complete: false });
            }
        }
        if theirs.is_empty() {
            return Ok(SharedRun { done, complete: true });
        }
        if theirs.len() == before {
            sleep(PAUSE);
        }
        open = theirs;
    }
}
