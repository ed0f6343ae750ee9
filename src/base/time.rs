//! Time as exact rational seconds.
//!
//! Frame times, key times and turns are fractions of integers. So a key at a frame's time is exactly there, a loop of
//! 100 turns closes, and rates do not drift. They become floating point only once, at the end, as the fraction of a
//! segment (see [`Fraction`]).

use num_rational::Ratio;

/// A time or a duration in seconds.
#[warn(missing_docs)]
pub type Time = Ratio<i128>;

/// Whether one time is after another. Comparing ratios with different denominators takes divisions, unless their
/// products fit.
pub fn is_after(a: Time, b: Time) -> bool {
    match (small(a), small(b)) {
        (Some((a, of_a)), Some((b, of_b))) => a * of_b > b * of_a,
        _ => a > b,
    }
}

/// Whether two times are equal, likewise.
pub fn is_same(a: Time, b: Time) -> bool {
    match (small(a), small(b)) {
        (Some((a, of_a)), Some((b, of_b))) => a * of_b == b * of_a,
        _ => a == b,
    }
}

/// Numerator and denominator if both fit in 32 bits: then products of three of them fit, with room for a sum.
fn small(time: Time) -> Option<(i128, i128)> {
    let fits = |number: &i128| i32::try_from(*number).is_ok();
    (fits(time.numer()) && fits(time.denom())).then(|| (*time.numer(), *time.denom()))
}

/// Frames per second, above zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[warn(missing_docs)]
pub struct Rate(Time);

#[warn(missing_docs)]
impl Rate {
    /// `frames` per `seconds`; `None` unless both are above zero.
    pub fn new(frames: i128, seconds: i128) -> Option<Self> {
        (frames > 0 && seconds > 0).then(|| Self(Ratio::new(frames, seconds)))
    }

    /// The rate as a fraction; `None` unless it is above zero.
    pub fn from_ratio(rate: Time) -> Option<Self> {
        (rate > Ratio::from_integer(0)).then_some(Self(rate))
    }

    /// Frames per second.
    pub fn per_second(self) -> Time {
        self.0
    }

    /// The time at which `frame` starts: frame / rate.
    pub fn time_of(self, frame: u32) -> Time {
        Ratio::from_integer(i128::from(frame)) / self.0
    }
}

/// Film's 24 frames per second.
impl Default for Rate {
    fn default() -> Self {
        Self(Ratio::from_integer(24))
    }
}

impl std::fmt::Display for Rate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

/// The frames of a sequence: k = 0 … `frames` - 1 at time k / `rate`. The end is exclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[warn(missing_docs)]
pub struct Timeline {
    /// Frames per second.
    pub rate: Rate,
    /// Length in seconds. Not always a whole number of frames.
    pub duration: Time,
    /// Number of frames.
    pub frames: u32,
}

#[warn(missing_docs)]
impl Timeline {
    /// `frames` frames at `rate`.
    pub fn of_frames(frames: u32, rate: Rate) -> Self {
        Self { rate, duration: rate.time_of(frames), frames }
    }

    /// Every frame that starts before `duration`, which is above zero; `None` if a `u32` cannot count them.
    pub fn of_duration(duration: Time, rate: Rate) -> Option<Self> {
        let frames = (duration * rate.per_second()).ceil().to_integer();
        Some(Self { rate, duration, frames: u32::try_from(frames).ok()? })
    }

    /// The same duration at another rate.
    pub fn resampled(&self, rate: Rate) -> Option<Self> {
        Self::of_duration(self.duration, rate)
    }

    /// The clock at `frame`.
    pub fn clock(&self, frame: u32) -> Clock {
        let start = self.rate.time_of(frame);
        Clock { frame, start, time: start, duration: self.duration }
    }

    /// The frame that is displayed at `time`, which is not negative.
    pub fn frame_at(&self, time: Time) -> u32 {
        let frame = (time * self.rate.per_second()).floor().to_integer();
        frame.clamp(0, i128::from(u32::MAX)) as u32
    }
}

/// One moment of a sequence. Animation depends on nothing else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Clock {
    pub frame: u32,
    /// When the frame starts.
    pub start: Time,
    /// The moment itself. It is later than the start if the shutter stays open.
    pub time: Time,
    /// Length of the whole sequence, for motions given in turns per duration.
    pub duration: Time,
}

impl Clock {
    /// The moment that is `by` seconds later within the same frame.
    pub fn later(&self, by: Time) -> Self {
        Self { time: self.time + by, ..*self }
    }

    /// The elapsed fraction of the sequence: 0 at its start, 1 at its exclusive end.
    pub fn progress(&self) -> Fraction {
        Fraction::new(self.time, self.duration)
    }
}

/// A quotient that is not rounded yet: `num / den` with `den` above zero.
///
/// If the numbers are integers, interpolation by `(a·den + (b - a)·num) / den` is exact before its only division. So
/// a keyed turn closes bit for bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fraction {
    pub num: f64,
    pub den: f64,
}

impl Fraction {
    /// `part / whole` in lowest terms, so that equal quotients give equal numbers.
    pub fn new(part: Time, whole: Time) -> Self {
        let quotient = part / whole;
        Self { num: *quotient.numer() as f64, den: *quotient.denom() as f64 }
    }

    /// The share of the span from `first` to `last` at which `time` lies, in lowest terms.
    pub fn between(time: Time, first: Time, last: Time) -> Self {
        let (Some((t, of_t)), Some((a, of_a)), Some((b, of_b))) = (small(time), small(first), small(last))
        else {
            return Self::new(time - first, last - first);
        };
        // (t - a) / (b - a), where both differences have the denominator of a.
        let (num, den) = ((t * of_a - a * of_t) * of_b, (b * of_a - a * of_b) * of_t);
        match (i64::try_from(num), i64::try_from(den)) {
            // Reducing takes many divisions, which are much faster in 64 bits.
            (Ok(num), Ok(den)) if den > 0 => {
                let quotient = Ratio::new(num, den);
                Self { num: *quotient.numer() as f64, den: *quotient.denom() as f64 }
            }
            _ => Self::new(time - first, last - first),
        }
    }

    /// A number that is already rounded.
    pub fn real(value: f64) -> Self {
        Self { num: value, den: 1.0 }
    }

    /// The quotient, rounded.
    pub fn value(self) -> f64 {
        self.num / self.den
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    fn rate(frames: i128, seconds: i128) -> Rate {
        Rate::new(frames, seconds).expect("a positive rate")
    }

    #[test]
    fn ca_07_frame_of_time_of_frame_is_the_frame() {
        for r in [rate(24, 1), rate(25, 1), rate(30, 1), rate(60, 1), rate(24000, 1001), rate(30000, 1001)] {
            let timeline = Timeline::of_frames(100_000, r);
            for k in 0..100_000 {
                assert_eq!(timeline.frame_at(r.time_of(k)), k, "at {r} frames per second");
            }
        }
    }

    /// Products instead of divisions give the same, for all sizes of numbers.
    #[test]
    fn shares_and_comparisons_are_exact() {
        let mut random = Random(5);
        let mut number = |most: f64| (most * (random.unit() - 0.5)) as i128;
        for size in [4.0, 100.0, 1e4, 1e9, 1e12] {
            for _ in 0..3000 {
                let mut time = || Ratio::new(number(size), 1 + number(size).abs());
                let (a, b, c) = (time(), time(), time());
                assert_eq!(is_after(a, b), a > b, "{a} {b}");
                assert_eq!((is_same(a, b), is_same(a, a)), (a == b, true), "{a} {b}");
                if b > a {
                    assert_eq!(Fraction::between(c, a, b), Fraction::new(c - a, b - a), "{c} in {a}, {b}");
                }
            }
        }
    }

    #[test]
    fn the_end_is_exclusive() {
        let three_seconds = Timeline::of_frames(72, rate(24, 1));
        assert_eq!(three_seconds.resampled(rate(30, 1)).map(|t| t.frames), Some(90));
        assert_eq!(three_seconds.resampled(rate(1, 2)).map(|t| t.frames), Some(2));
        assert!(three_seconds.clock(71).time < three_seconds.duration);
    }

    #[test]
    fn rates_must_be_above_zero() {
        assert_eq!(Rate::new(0, 1), None);
        assert_eq!(Rate::new(-24, 1), None);
    }
}
