//! The plan: the whole timeline evaluated before anything is traced, as animation depends on time alone.
//!
//! ```text
//! Sequence, frames ──survey──▶ Survey ──takes──▶ Plan ──run──▶ the frame loop
//!                     what each frame       which films are traced,
//!                       evaluates to        and which frames are made of each
//! ```
//!
//! What a plan decides never shows in a picture: a frame that is rendered by itself has the same bytes.

mod changes;
mod effects;
mod films;
mod outline;
mod outlook;
mod pilot;
mod run;
mod shared;
mod survey;
#[cfg(test)]
mod tests;

pub use changes::{Change, Part};
pub use effects::{Caller, Effect};
pub use films::{Room, Take};
pub use outline::{Outline, Reason, Span, outline};
pub use outlook::{FilmForecast, Outlook, Patience, Range, RunForecast, look_ahead};
pub use pilot::{Effort, Expected, Nowhere, Work, pilot, samples, shrunk, work};
pub use run::run;
pub use shared::{Shared, run_shared};
pub use survey::{Survey, survey, survey_until, with_shared};

use crate::film::Extras;
use crate::sequence::Sequence;

/// What a run will trace.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    pub survey: Survey,
    pub room: Room,
    /// The films in the order in which they are traced.
    pub takes: Vec<Take>,
    /// Of each frame the index of its film.
    pub of: Vec<usize>,
}

impl Plan {
    /// The plan of these frames, in this order. Films that are kept take `budget` bytes at most; with none, every frame
    /// is traced by itself.
    pub fn new(sequence: &Sequence, frames: &[u32], extras: Extras, budget: u64) -> Self {
        Self::of(survey(sequence, frames), sequence, extras, budget)
    }

    /// The same of frames that are evaluated already.
    pub fn of(survey: Survey, sequence: &Sequence, extras: Extras, budget: u64) -> Self {
        let room = Room::of(sequence, extras, budget);
        let (takes, of) = films::takes(&survey.frames, &room);
        Self { survey, room, takes, of }
    }

    /// Frames that are made of the film of another.
    pub fn reused(&self) -> usize {
        self.of.len() - self.takes.len()
    }

    /// The most bytes that films take which are kept at once.
    pub fn kept_bytes(&self) -> u64 {
        let mut most = 0;
        let mut now = 0;
        for (index, &film) in self.of.iter().enumerate() {
            let take = &self.takes[film];
            let (first, last) = (take.frames.first(), take.frames.last());
            let bytes = self.room.bytes(take.lit.len());
            let kept = first != last;
            if kept && first == Some(&index) {
                now += bytes;
            }
            most = most.max(now);
            if kept && last == Some(&index) {
                now -= bytes;
            }
        }
        most
    }

    /// Trees that are built: one for each film whose geometry is not that of the film before, and for each moment at
    /// which it has moved while a shutter is open.
    pub fn builds(&self) -> u64 {
        let mut before = None;
        let mut builds = 0;
        for take in &self.takes {
            let look = &self.survey.frames[take.frames[0]];
            builds += u64::from(before != Some(look.geometry.0)) + u64::from(look.rebuilds);
            before = Some(look.geometry.1);
        }
        builds
    }
}
