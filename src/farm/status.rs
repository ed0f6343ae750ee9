//! The progress of a job, whichever processes render its frames.

use crate::base::digest::Digest;
use crate::encode::{FrameStatus, LeaseHolder};
use std::time::{Duration, SystemTime};

/// The state of one frame of a job.
#[derive(Clone, Debug, PartialEq)]
pub struct JobFrame {
    pub number: u32,
    /// The digest of its film.
    pub film: Digest,
    /// Its fraction of the camera rays of its film.
    pub work: f64,
    pub status: FrameStatus,
}

/// The progress of a job, by frame number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JobStatus {
    pub done: Vec<u32>,
    /// The file exists, but a render would write another one now.
    pub stale: Vec<u32>,
    pub missing: Vec<u32>,
    /// Frames that a process has claimed and not finished, by process.
    pub in_work: Vec<(LeaseHolder, Vec<u32>)>,
    /// The time for the remaining frames, at the rate between the first and the last finished frame.
    pub left: Option<Duration>,
}

impl JobStatus {
    /// Sums up the frames. `holder` finds the process that has claimed a film.
    pub fn of(frames: &[JobFrame], holder: impl Fn(Digest) -> Option<LeaseHolder>) -> Self {
        let mut status = Self::default();
        let mut films: Vec<(Digest, Option<usize>)> = Vec::new();
        for frame in frames {
            if let FrameStatus::Done(_) = frame.status {
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
            match (place, frame.status) {
                (Some(place), _) => status.in_work[place].1.push(frame.number),
                (None, FrameStatus::Stale) => status.stale.push(frame.number),
                (None, _) => status.missing.push(frame.number),
            }
        }
        status.left = left(frames);
        status
    }
}

/// Estimates the time that is left. The start of the first frame is unknown, so that frame does not count.
fn left(frames: &[JobFrame]) -> Option<Duration> {
    let mut done: Vec<(SystemTime, f64)> = Vec::new();
    let mut rest = 0.0;
    for frame in frames {
        match frame.status {
            FrameStatus::Done(made) => done.push((made, frame.work)),
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

    fn frame(number: u32, film: u128, status: FrameStatus) -> JobFrame {
        JobFrame { number, film: Digest(film), work: 10.0, status }
    }

    fn at(seconds: u64) -> FrameStatus {
        FrameStatus::Done(SystemTime::UNIX_EPOCH + Duration::from_secs(seconds))
    }

    #[test]
    fn frames_are_counted_once() {
        let frames = [
            frame(0, 1, at(100)),
            frame(1, 1, FrameStatus::Missing),
            frame(2, 2, FrameStatus::Missing),
            frame(3, 2, FrameStatus::Stale),
            frame(4, 3, FrameStatus::Stale),
            frame(5, 4, at(140)),
            frame(6, 5, at(160)),
        ];
        let someone = LeaseHolder::unknown(Duration::from_secs(3));
        let status = JobStatus::of(&frames, |film| (film == Digest(2)).then(|| someone.clone()));
        assert_eq!((status.done, status.stale, status.missing), (vec![0, 5, 6], vec![4], vec![1]));
        assert_eq!(status.in_work, [(someone, vec![2, 3])]);
        // Two frames took a minute, and four are left.
        assert_eq!(status.left, Some(Duration::from_secs(120)));
    }

    #[test]
    fn one_finished_frame_gives_no_estimate() {
        assert_eq!(left(&[]), None);
        assert_eq!(left(&[frame(0, 1, at(5)), frame(1, 2, FrameStatus::Missing)]), None);
        assert_eq!(left(&[frame(0, 1, at(5)), frame(1, 2, at(5)), frame(2, 3, FrameStatus::Missing)]), None);
        assert_eq!(left(&[frame(0, 1, at(5)), frame(1, 2, at(6))]), Some(Duration::ZERO));
    }
}
