//! How far the frames of a job have come, whoever makes them.

use crate::base::digest::Digest;
use crate::encode::{Found, Holder};
use std::time::{Duration, SystemTime};

/// A frame of a job.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    pub number: u32,
    /// The film that it is made of.
    pub film: Digest,
    /// Rays of the camera that it takes, as its share of the film's.
    pub work: f64,
    pub found: Found,
}

/// How far a job has come.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Status {
    pub done: Vec<u32>,
    /// There, but not as they would be made now.
    pub stale: Vec<u32>,
    pub missing: Vec<u32>,
    /// Frames that are not done, by who has them in hand.
    pub in_work: Vec<(Holder, Vec<u32>)>,
    /// What the rest will take if it goes on as from the first frame that is done to the last.
    pub left: Option<Duration>,
}

impl Status {
    /// Of frames, and of who has films in hand.
    pub fn of(frames: &[Frame], holder: impl Fn(Digest) -> Option<Holder>) -> Self {
        let mut status = Self::default();
        let mut films: Vec<(Digest, Option<usize>)> = Vec::new();
        for frame in frames {
            if let Found::Done(_) = frame.found {
                status.done.push(frame.number);
                continue;
            }
            let known = films.iter().find(|(film, _)| *film == frame.film).map(|(_, place)| *place);
            let place = known.unwrap_or_else(|| {
                let place = holder(frame.film).map(|holder| {
                    status.in_work.push((holder, Vec::new()));
                    status.in_work.len() - 1
                });
                films.push((frame.film, place));
                place
            });
            match (place, frame.found) {
                (Some(place), _) => status.in_work[place].1.push(frame.number),
                (None, Found::Stale) => status.stale.push(frame.number),
                (None, _) => status.missing.push(frame.number),
            }
        }
        status.left = left(frames);
        status
    }
}

/// How long the rest will take. When the first frame was begun is not known, so that it is not counted.
fn left(frames: &[Frame]) -> Option<Duration> {
    let mut done: Vec<(SystemTime, f64)> = Vec::new();
    let mut rest = 0.0;
    for frame in frames {
        match frame.found {
            Found::Done(made) => done.push((made, frame.work)),
            _ => rest += frame.work,
        }
    }
    done.sort_by_key(|(made, _)| *made);
    let (first, last) = (done.first()?.0, done.last()?.0);
    let took = last.duration_since(first).ok()?.as_secs_f64();
    let work: f64 = done.iter().skip(1).map(|(_, work)| work).sum();
    Duration::try_from_secs_f64(took * rest / work).ok().filter(|_| took > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(number: u32, film: u128, found: Found) -> Frame {
        Frame { number, film: Digest(film), work: 10.0, found }
    }

    fn at(seconds: u64) -> Found {
        Found::Done(SystemTime::UNIX_EPOCH + Duration::from_secs(seconds))
    }

    #[test]
    fn frames_are_counted_once() {
        let frames = [
            frame(0, 1, at(100)),
            frame(1, 1, Found::Missing),
            frame(2, 2, Found::Missing),
            frame(3, 2, Found::Stale),
            frame(4, 3, Found::Stale),
            frame(5, 4, at(140)),
            frame(6, 5, at(160)),
        ];
        let someone = Holder::unknown(Duration::from_secs(3));
        let status = Status::of(&frames, |film| (film == Digest(2)).then(|| someone.clone()));
        assert_eq!((status.done, status.stale, status.missing), (vec![0, 5, 6], vec![4], vec![1]));
        assert_eq!(status.in_work, [(someone, vec![2, 3])]);
        // Two frames in a minute, four to come.
        assert_eq!(status.left, Some(Duration::from_secs(120)));
    }

    #[test]
    fn of_one_frame_no_time_is_told() {
        assert_eq!(left(&[]), None);
        assert_eq!(left(&[frame(0, 1, at(5)), frame(1, 2, Found::Missing)]), None);
        assert_eq!(left(&[frame(0, 1, at(5)), frame(1, 2, at(5)), frame(2, 3, Found::Missing)]), None);
        assert_eq!(left(&[frame(0, 1, at(5)), frame(1, 2, at(6))]), Some(Duration::ZERO));
    }
}
