//! The search for the keys around a time.

use super::Key;
use crate::base::time::{Fraction, Time, is_after, is_same};

/// Where a time lies among the keys of a track.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Segment {
    /// The value is that of this key: the time is the key's own, or outside the keys.
    At(usize),
    /// After the key with this index, at this fraction of the way to the next one.
    After(usize, Fraction),
}

impl Segment {
    /// Finds a time among keys, of which there is at least one.
    fn find<T>(keys: &[Key<T>], time: Time) -> Self {
        let next = keys.partition_point(|key| !is_after(key.time, time));
        match (next.checked_sub(1), keys.get(next)) {
            (None, _) => Self::At(0),
            (Some(from), Some(to)) if !is_same(time, keys[from].time) => {
                Self::After(from, Fraction::between(time, keys[from].time, to.time))
            }
            (Some(from), _) => Self::At(from),
        }
    }
}

/// The last segment between two keys that was found. Tracks of many objects often have keys at the same times, so that most
/// searches are a comparison.
#[derive(Clone, Copy, Debug, Default)]
pub struct SegmentCache(Option<Found>);

/// At a time, between keys with these times.
#[derive(Clone, Copy, Debug)]
struct Found {
    time: Time,
    keys: [Time; 2],
    from: usize,
    share: Fraction,
}

impl SegmentCache {
    /// Finds a time among keys, of which there is at least one.
    #[inline]
    pub fn find<T>(&mut self, keys: &[Key<T>], time: Time) -> Segment {
        if let Some(known) = self.known(keys, time) {
            return known;
        }
        let segment = Segment::find(keys, time);
        if let Segment::After(from, share) = segment {
            self.0 = Some(Found { time, keys: [keys[from].time, keys[from + 1].time], from, share });
        }
        segment
    }

    /// The last segment, if this search would find it again.
    #[inline]
    fn known<T>(&self, keys: &[Key<T>], time: Time) -> Option<Segment> {
        let found = self.0.as_ref()?;
        let [a, b] = keys.get(found.from..found.from + 2)? else { return None };
        let is_known = is_identical(time, found.time)
            && is_identical(a.time, found.keys[0])
            && is_identical(b.time, found.keys[1]);
        is_known.then_some(Segment::After(found.from, found.share))
    }
}

/// Whether numerators and denominators are equal. Comparing ratios takes longer.
#[inline]
fn is_identical(a: Time, b: Time) -> bool {
    let [a, b] = [a, b].map(Time::into_raw);
    a == b
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;
    use crate::track::Ease;

    /// Tracks that share some of their times, in turns.
    #[test]
    fn what_was_found_before_changes_nothing() {
        let mut random = Random(11);
        let mut number = |most: u32| i128::from((random.unit() * f64::from(most)) as u32);
        let mut keys = || {
            let mut time = Time::from_integer(number(2));
            let mut keys = Vec::new();
            for _ in 0..=number(3) {
                keys.push(Key { time, value: (), ease: Ease::Linear });
                time += Time::new(1 + number(2), 1 + number(2));
            }
            keys
        };
        let tracks: Vec<_> = (0..40).map(|_| keys()).collect();
        let (mut cache, mut hits) = (SegmentCache::default(), 0);
        for step in 0..60 {
            let time = Time::new(step, 12);
            for track in &tracks {
                let expected = Segment::find(track, time);
                hits += u32::from(cache.known(track, time).is_some());
                assert_eq!(cache.find(track, time), expected, "{time}");
            }
        }
        assert!(hits > 100, "{hits}");
    }
}
