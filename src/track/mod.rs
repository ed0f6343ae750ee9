//! Values over time: a constant, or keys with easings between them.
//!
//! In: keys, easings and times.
//! Out: the value at a time.
//! May use: `base`.

mod ease;
mod interpolate;
mod segment;
mod spline;
mod switch;

pub use ease::Ease;
pub use interpolate::{Animate, LogScale, Modes};
pub use segment::SegmentCache;
pub use switch::Switch;

use crate::base::time::{Fraction, Time};
use segment::Segment;
use std::error::Error;
use std::fmt;
use std::sync::Arc;

/// A constant or keyed value.
#[derive(Clone, Debug, PartialEq)]
#[warn(missing_docs)]
pub enum Animated<T> {
    /// The same at all times.
    Constant(T),
    /// Given by keys.
    Keyed(Track<T>),
}

/// One key: at `time` the value is `value`, and `ease` interpolates to the next key.
#[derive(Clone, Debug, PartialEq)]
#[warn(missing_docs)]
pub struct Key<T> {
    /// Seconds from the start of the sequence.
    pub time: Time,
    /// The value at this time.
    pub value: T,
    /// How the value changes up to the next key.
    pub ease: Ease,
}

/// What a track does outside its keys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[warn(missing_docs)]
pub enum Repeat {
    /// The first value before the first key, the last one after the last.
    #[default]
    Hold,
    /// The keys repeat; the time of the last key is the time of the first one in the next round.
    Loop,
    /// The keys repeat, alternately forwards and backwards.
    PingPong,
}

/// Keys in strictly increasing order of time; at least one. Clones share them.
#[derive(Clone, Debug, PartialEq)]
#[warn(missing_docs)]
pub struct Track<T>(Arc<Keys<T>>);

/// Behind one pointer: objects have many values that seldom have keys.
#[derive(Clone, Debug, PartialEq)]
struct Keys<T> {
    keys: Box<[Key<T>]>,
    repeat: Repeat,
    /// Whether splines treat the first and the last key, which have the same value, as one point.
    closed: bool,
    /// For each segment between two keys its tangents at both ends, times its length; empty without such curves.
    curves: Box<[[T; 2]]>,
}

/// Why keys are not a track. The numbers are indices of keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[warn(missing_docs)]
pub enum TrackError {
    /// There are no keys.
    Empty,
    /// The key's time is not after the one before it.
    NotAscending(usize),
}

impl fmt::Display for TrackError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("a track needs at least one key"),
            Self::NotAscending(key) => write!(f, "key {key} must be after the key before it"),
        }
    }
}

impl Error for TrackError {}

#[warn(missing_docs)]
impl<T: Animate> Track<T> {
    /// A track of keys. `closed` says that the last key repeats the first, so that splines go on smoothly there.
    pub fn new(keys: Vec<Key<T>>, repeat: Repeat, closed: bool) -> Result<Self, TrackError> {
        if keys.is_empty() {
            return Err(TrackError::Empty);
        }
        if let Some(before) = keys.windows(2).position(|pair| pair[1].time <= pair[0].time) {
            return Err(TrackError::NotAscending(before + 1));
        }
        Ok(Self(Arc::new(Keys { keys: keys.into(), repeat, closed, curves: Box::default() })))
    }

    /// Bends the segments between keys, except those that step: cubic Hermite curves with these tangents at both ends,
    /// times the length of the segment. Without tangents, or with another number of them, nothing changes.
    pub fn with_curves(mut self, curves: Vec<[T; 2]>) -> Self {
        let curves = if curves.len() + 1 == self.0.keys.len() { curves } else { Vec::new() };
        Arc::make_mut(&mut self.0).curves = curves.into();
        self
    }

    /// The same track with changed values and without curves. The change must keep the times.
    pub fn map(self, change: impl Fn(Key<T>) -> Key<T>) -> Self {
        let Keys { keys, repeat, closed, .. } = &*self.0;
        let keys = keys.iter().cloned().map(change).collect();
        Self(Arc::new(Keys { keys, repeat: *repeat, closed: *closed, curves: Box::default() }))
    }

    /// The times of keys from a time to another, those of all rounds if keys repeat, in increasing order; at most about
    /// `most`.
    pub fn key_times(&self, [from, to]: [Time; 2], most: usize) -> Vec<Time> {
        let zero = Time::from_integer(0);
        let (first, last) = (self.0.keys[0].time, self.0.keys[self.0.keys.len() - 1].time);
        let span = last - first;
        let rounds = match self.0.repeat {
            Repeat::Hold => 0..=0,
            _ if span == zero => 0..=0,
            _ => ((from - first) / span).floor().to_integer()..=((to - first) / span).floor().to_integer(),
        };
        let mut times: Vec<Time> = Vec::new();
        for round in rounds {
            let start = span * Time::from_integer(round);
            let backwards = self.0.repeat == Repeat::PingPong && round.rem_euclid(2) == 1;
            let mut keys: Vec<Time> = self.0.keys.iter().map(|key| key.time).collect();
            if backwards {
                keys = keys.into_iter().rev().map(|time| first + last - time).collect();
            }
            times.extend(keys.into_iter().map(|time| time + start).filter(|time| (from..=to).contains(time)));
            if times.len() >= most {
                break;
            }
        }
        times.dedup();
        times
    }

    /// The keys, in the order of their times.
    pub fn keys(&self) -> &[Key<T>] {
        &self.0.keys
    }

    /// What the track does outside its keys.
    pub fn repeat(&self) -> Repeat {
        self.0.repeat
    }

    /// The tangents of segment `from`, as in [`Track::with_curves`].
    pub fn curve(&self, from: usize) -> Option<&[T; 2]> {
        self.0.curves.get(from)
    }

    /// The most that curves lead beyond the values of keys: `size` is a norm of values and tangents.
    ///
    /// Between two keys, a cubic Hermite curve is a mean of both values, plus the tangents times s³ - 2s² + s and
    /// s³ - s², which are at most 4/27 in size.
    pub fn overshoot(&self, size: impl Fn(&T) -> f64) -> f64 {
        let beyond = |[leaving, arriving]: &[T; 2]| 4.0 / 27.0 * (size(leaving) + size(arriving));
        self.0.curves.iter().map(beyond).fold(0.0, f64::max)
    }

    /// The value at `time`. A key takes effect exactly at its time.
    pub fn at(&self, time: Time) -> T {
        self.at_cached(time, &mut SegmentCache::default())
    }

    /// [`Track::at`] with the segment that was found for the last of several tracks.
    #[inline]
    pub(crate) fn at_cached(&self, time: Time, cache: &mut SegmentCache) -> T {
        let (from, s) = match cache.find(&self.0.keys, self.folded(time)) {
            // Curves meet their ends only up to rounding. Return the exact value at a key, so that a last key that
            // repeats the first gives the same state.
            Segment::At(key) => return self.0.keys[key].value.clone(),
            Segment::After(from, s) => (from, s),
        };
        let (a, b) = (&self.0.keys[from], &self.0.keys[from + 1]);
        match a.ease {
            Ease::Step => a.value.clone(),
            Ease::Linear if let Some(tangents) = self.0.curves.get(from) => {
                T::hermite([&a.value, &b.value], [&tangents[0], &tangents[1]], s.value())
            }
            Ease::Linear => T::mix(&a.value, &b.value, s),
            Ease::CatmullRom => T::spline(self.neighbours(from), s.value()),
            ease => T::mix(&a.value, &b.value, Fraction::real(ease.apply(s.value()))),
        }
    }

    /// Maps `time` into the time span of the keys according to `repeat`. Exact, because times are rational.
    #[inline]
    fn folded(&self, time: Time) -> Time {
        if self.0.repeat == Repeat::Hold { time } else { self.repeated(time) }
    }

    fn repeated(&self, time: Time) -> Time {
        let (first, last) = (self.0.keys[0].time, self.0.keys[self.0.keys.len() - 1].time);
        let span = last - first;
        if span == Time::from_integer(0) {
            return time;
        }
        let turns = ((time - first) / span).floor();
        let rest = time - first - turns * span;
        let backwards = self.0.repeat == Repeat::PingPong && turns.to_integer().rem_euclid(2) == 1;
        if backwards { last - rest } else { first + rest }
    }

    /// The four values around the segment that starts at key `from`. At an open end, the end itself replaces the
    /// missing neighbour. A closed track wraps around and skips the last key, which repeats the first.
    fn neighbours(&self, from: usize) -> [&T; 4] {
        let last = self.0.keys.len() - 1;
        let before = match from {
            0 if self.0.closed => last - 1,
            _ => from.saturating_sub(1),
        };
        let after = match from + 2 {
            past if past > last && self.0.closed => 1,
            past => past.min(last),
        };
        [before, from, from + 1, after].map(|i| &self.0.keys[i].value)
    }
}

#[warn(missing_docs)]
impl<T: Animate> Animated<T> {
    /// The value at a time.
    pub fn at(&self, time: Time) -> T {
        self.at_cached(time, &mut SegmentCache::default())
    }

    /// [`Animated::at`] with the segment that was found for the last of several tracks.
    #[inline]
    pub(crate) fn at_cached(&self, time: Time, cache: &mut SegmentCache) -> T {
        match self {
            Self::Constant(value) => value.clone(),
            Self::Keyed(track) => track.at_cached(time, cache),
        }
    }

    /// Whether it has keys.
    pub fn is_keyed(&self) -> bool {
        matches!(self, Self::Keyed(_))
    }

    /// The times of all keys.
    pub fn key_times(&self) -> impl Iterator<Item = Time> {
        let keys = match self {
            Self::Constant(_) => &[][..],
            Self::Keyed(track) => track.keys(),
        };
        keys.iter().map(|key| key.time)
    }

    /// The largest size of a value, also between the keys of curves. Other easings may overshoot.
    pub fn peak(&self, size: impl Fn(&T) -> f64) -> f64 {
        let beyond = match self {
            Self::Constant(_) => 0.0,
            Self::Keyed(track) => track.overshoot(&size),
        };
        self.values().map(size).fold(0.0, f64::max) + beyond
    }

    /// The constant, or every key's value.
    pub fn values(&self) -> impl Iterator<Item = &T> {
        let (constant, keys) = match self {
            Self::Constant(value) => (Some(value), &[][..]),
            Self::Keyed(track) => (None, track.keys()),
        };
        constant.into_iter().chain(keys.iter().map(|key| &key.value))
    }
}

impl<T> From<T> for Animated<T> {
    fn from(value: T) -> Self {
        Self::Constant(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::DVec3;
    use crate::testing::Random;

    fn seconds(num: i128, den: i128) -> Time {
        Time::new(num, den)
    }

    fn track<T: Animate>(keys: &[(i128, T, Ease)], repeat: Repeat, closed: bool) -> Track<T> {
        let keys =
            keys.iter().map(|(t, v, ease)| Key { time: seconds(*t, 1), value: v.clone(), ease: *ease });
        Track::new(keys.collect(), repeat, closed).expect("a track")
    }

    #[test]
    fn a_key_holds_from_its_own_time_on() {
        let on = track(&[(0, false, Ease::Step), (1, true, Ease::Step)], Repeat::Hold, false);
        assert!(!on.at(seconds(23, 24)));
        assert!(on.at(seconds(24, 24)));
        assert!(on.at(seconds(25, 24)));
        let value = track(&[(1, 5.0, Ease::Linear), (2, 7.0, Ease::Linear)], Repeat::Hold, false);
        assert_eq!([0, 1, 2, 3].map(|t| value.at(seconds(t, 1))), [5.0, 5.0, 7.0, 7.0]);
        assert_eq!(value.at(seconds(3, 2)), 6.0);
    }

    #[test]
    fn loops_and_ping_pong_repeat_exactly() {
        let keys = [(0, 0.1, Ease::Smooth), (1, 0.7, Ease::Linear), (3, 0.1, Ease::Linear)];
        let looped = track(&keys, Repeat::Loop, false);
        let bounced = track(&keys, Repeat::PingPong, false);
        for k in 0..90 {
            let t = seconds(k, 30);
            assert_eq!(looped.at(t), looped.at(t + seconds(300, 1)));
            assert_eq!(bounced.at(t), bounced.at(t + seconds(6, 1)));
            assert_eq!(bounced.at(seconds(3, 1) + t), bounced.at(seconds(3, 1) - t));
        }
    }

    #[test]
    fn catmull_rom_passes_through_its_points() {
        let p = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let points = [p(0.0, 0.0), p(1.0, 2.0), p(4.0, 2.0), p(5.0, 0.0), p(0.0, 0.0)];
        let keys: Vec<_> = (0..).zip(points).map(|(t, v)| (t, v, Ease::CatmullRom)).collect();
        for closed in [false, true] {
            let spline = track(&keys, Repeat::Hold, closed);
            for (t, point) in (0..).zip(points) {
                assert!((spline.at(seconds(t, 1)) - point).length() < 1e-12);
            }
        }
        // A closed curve leaves the first point in the direction in which it arrives at the last.
        let spline = track(&keys, Repeat::Hold, true);
        let step = seconds(1, 1 << 20);
        let leaving = (spline.at(step) - points[0]).normalize();
        let arriving = (points[4] - spline.at(seconds(4, 1) - step)).normalize();
        assert!((leaving - arriving).length() < 1e-4, "{leaving} {arriving}");
    }

    #[test]
    fn every_easing_is_exact_at_its_keys() {
        let mut random = Random(9);
        let easings: Vec<_> = Ease::names().filter_map(|name| Ease::named(&name)).collect();
        for (round, ease) in (0..10).flat_map(|round| easings.iter().map(move |ease| (round, *ease))) {
            let mut points: Vec<_> = (0..6).map(|_| random.point(10.0)).collect();
            points.push(points[0]);
            let keys: Vec<_> = (0..).zip(&points).map(|(t, v)| (t, *v, ease)).collect();
            let looped = track(&keys, Repeat::Loop, round % 2 == 0);
            assert_eq!((0..7).map(|t| looped.at(seconds(t, 1))).collect::<Vec<_>>(), points, "{ease:?}");
            let keys: Vec<_> = (0..).zip(&points).map(|(t, v)| (t, v.x, ease)).collect();
            let held = track(&keys, Repeat::Hold, round % 2 == 0);
            assert!((0..).zip(&points).all(|(t, point)| held.at(seconds(t, 1)) == point.x), "{ease:?}");
        }
    }

    #[test]
    fn curves_stay_within_their_bound_and_reach_it() {
        let keys = [(0, 0.0, Ease::Linear), (1, 0.0, Ease::Linear)];
        let curve = track(&keys, Repeat::Hold, false).with_curves(vec![[3.0, -3.0]]);
        let overshoot = curve.overshoot(|value| value.abs());
        let most = (0..=1000).map(|step| curve.at(seconds(step, 1000)).abs()).fold(0.0, f64::max);
        // Both tangents push the same way; their bounds are at 1/3 and 2/3.
        assert!(most <= overshoot && most > 0.8 * overshoot, "{most} {overshoot}");
        let one = track(&keys, Repeat::Hold, false).with_curves(vec![[27.0, 0.0]]);
        assert_eq!(one.overshoot(|value| value.abs()), 4.0);
        assert!((one.at(seconds(1, 3)) - 4.0).abs() < 1e-14);
        assert_eq!(Animated::Keyed(one).peak(|value| value.abs()), 4.0);
    }

    #[test]
    fn keys_must_ascend() {
        let key = |t| Key { time: seconds(t, 1), value: 0.0, ease: Ease::Linear };
        assert_eq!(Track::<f64>::new(vec![], Repeat::Hold, false), Err(TrackError::Empty));
        let unsorted = Track::new(vec![key(0), key(2), key(2)], Repeat::Hold, false);
        assert_eq!(unsorted, Err(TrackError::NotAscending(2)));
    }
}
