//! Playing a range of frames in time. Frames that take too long are dropped and counted.

use std::time::{Duration, Instant};

/// A range of frames that plays.
#[derive(Clone, Debug)]
pub struct Playback {
    from: u32,
    to: u32,
    repeats: bool,
    per_second: f64,
    start: Instant,
    /// The frame at the start, counted from `from`.
    first: u32,
    /// The number of the last frame that was shown, counted on from the start over all rounds.
    last: Option<u64>,
    pub shown: u64,
    pub dropped: u64,
}

impl Playback {
    /// Plays the frames `from..=to` from `at` on.
    pub fn new((from, to): (u32, u32), at: u32, repeats: bool, per_second: f64, now: Instant) -> Self {
        let to = to.max(from);
        let at = if (from..to).contains(&at) || (at == to && repeats) { at } else { from };
        let per_second = if per_second.is_finite() { per_second.clamp(0.01, 1000.0) } else { 24.0 };
        Self { from, to, repeats, per_second, start: now, first: at - from, last: None, shown: 0, dropped: 0 }
    }

    /// The frame that is due, and whether it is a new one. None after the end.
    pub fn due(&mut self, now: Instant) -> Option<(u32, bool)> {
        let passed = (now.saturating_duration_since(self.start).as_secs_f64() * self.per_second) as u64;
        let count = u64::from(self.to - self.from) + 1;
        let place = u64::from(self.first) + passed;
        if !self.repeats && place >= count {
            return None;
        }
        let is_new = self.last != Some(passed);
        if is_new {
            self.dropped += self.last.map_or(passed, |last| passed - last - 1);
            self.shown += 1;
            self.last = Some(passed);
        }
        Some((self.from + (place % count) as u32, is_new))
    }

    /// The time until the next frame is due.
    pub fn until_next(&self, now: Instant) -> Duration {
        let next = self.last.map_or(0, |last| last + 1) as f64 / self.per_second;
        (self.start + Duration::from_secs_f64(next)).saturating_duration_since(now)
    }

    /// Pictures per second so far.
    pub fn rate(&self, now: Instant) -> f64 {
        self.shown as f64 / now.saturating_duration_since(self.start).as_secs_f64().max(1.0 / self.per_second)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_come_in_time_and_late_ones_are_dropped() {
        let start = Instant::now();
        let at = |ms: u64| start + Duration::from_millis(ms);
        let mut play = Playback::new((2, 5), 3, true, 10.0, start);
        let due: Vec<_> = [0, 50, 100, 250, 350, 450].map(|ms| play.due(at(ms))).into();
        let expected = [(3, true), (3, false), (4, true), (5, true), (2, true), (3, true)];
        assert_eq!(due, expected.map(Some));
        assert_eq!((play.shown, play.dropped), (5, 0));
        assert_eq!(play.due(at(850)), Some((3, true)));
        assert_eq!((play.shown, play.dropped), (6, 3));
        assert_eq!(play.until_next(at(850)), Duration::from_millis(50));
        let mut once = Playback::new((2, 5), 3, false, 10.0, start);
        assert_eq!([0, 299, 300].map(|ms| once.due(at(ms))), [Some((3, true)), Some((5, true)), None]);
    }
}
