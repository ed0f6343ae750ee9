//! A plan carried out together with other processes: whoever comes first to a film makes the frames of it.

use super::Plan;
use super::films::{Room, takes};
use super::run::run;
use super::survey::Survey;
use crate::encode::{Asked, Encoder};
use crate::pipeline::schedule::{FrameLoop, Look, NoFrame};
use std::thread::sleep;
use std::time::Duration;

/// How long to wait before asking again whether others have come to an end with what they have in hand.
const PAUSE: Duration = Duration::from_millis(500);

/// How it ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shared {
    /// Frames that were begun here.
    pub done: usize,
    /// Whether all frames are there, whoever made them.
    pub complete: bool,
}

/// Makes frames one film after the other, as long as `on` says so, but for those that other processes make; then waits for
/// these, and takes over what nobody makes any more. `there` is told of frames that others have made.
pub fn run_shared(
    survey: &Survey,
    room: Room,
    frames: &mut FrameLoop<Encoder>,
    on: impl Fn() -> bool,
    there: impl Fn(usize),
) -> Result<Shared, NoFrame> {
    let (films, _) = takes(&survey.frames, &Room { budget: u64::MAX, ..room });
    let look = |&index: &usize| survey.frames[index].clone();
    let mut open: Vec<Vec<Look>> = films.iter().map(|film| film.frames.iter().map(look).collect()).collect();
    let mut done = 0;
    loop {
        let before = open.len();
        let mut theirs = Vec::new();
        for film in open {
            if !on() {
                return Ok(Shared { done, complete: false });
            }
            let numbers: Vec<u32> = film.iter().map(|look| look.frame).collect();
            let name = film.first().map(|look| look.transport).unwrap_or_default();
            let asked = frames.with_sink(|encoder| encoder.ask(name, &numbers)).map_err(NoFrame::Encode)?;
            let missing = match asked {
                Asked::Theirs(_) => {
                    theirs.push(film);
                    continue;
                }
                Asked::Done => Vec::new(),
                Asked::Mine(missing) => missing,
            };
            there(numbers.len() - missing.len());
            let looks: Vec<Look> = film.into_iter().filter(|look| missing.contains(&look.frame)).collect();
            let (takes, of) = takes(&looks, &room);
            let wanted = looks.len();
            let begun = run(&Plan { survey: Survey { frames: looks }, room, takes, of }, frames, &on)?;
            done += begun;
            if begun < wanted {
                return Ok(Shared { done, complete: false });
            }
        }
        if theirs.is_empty() {
            return Ok(Shared { done, complete: true });
        }
        if theirs.len() == before {
            sleep(PAUSE);
        }
        open = theirs;
    }
}
