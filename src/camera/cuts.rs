//! Cuts between cameras, and cross-fades that soften them.

use crate::base::time::Time;
use crate::track::Animated;

/// Which camera shows the scene over time. Cuts take effect at once, or mix the pictures of both cameras for a while.
#[derive(Clone, Debug, PartialEq)]
#[warn(missing_docs)]
pub struct CameraCuts {
    /// Index of the active camera; its keys are the cuts.
    pub active: Animated<usize>,
    /// The time in seconds over which a cut mixes pictures, from its key on. 0 for none.
    pub fade: Time,
}

/// Two cameras that show a frame together.
#[derive(Clone, Copy, Debug, PartialEq)]
#[warn(missing_docs)]
pub struct CrossFade {
    /// Index of the camera before the cut.
    pub from: usize,
    /// Index of the camera after the cut.
    pub to: usize,
    /// The share of the camera after the cut, above 0 and below 1. It grows evenly with time.
    pub share: f64,
}

impl From<usize> for CameraCuts {
    fn from(camera: usize) -> Self {
        Self { active: Animated::Constant(camera), fade: Time::from_integer(0) }
    }
}

#[warn(missing_docs)]
impl CameraCuts {
    /// The camera at a time; in a cross-fade, the one after the cut.
    pub fn at(&self, time: Time) -> usize {
        match self.cut(time) {
            // The fade has just begun, and shows nothing of the other camera.
            Some((at, from)) if at == time => from,
            _ => self.active.at(time),
        }
    }

    /// The cameras that show a time together, if there are two.
    pub fn cross_fade(&self, time: Time) -> Option<CrossFade> {
        let (at, from) = self.cut(time).filter(|(at, _)| *at != time)?;
        let share = (time - at) / self.fade;
        let share = *share.numer() as f64 / *share.denom() as f64;
        Some(CrossFade { from, to: self.active.at(time), share })
    }

    /// The camera with the larger share at a time.
    pub fn leading(&self, time: Time) -> usize {
        match self.cross_fade(time) {
            Some(CrossFade { from, share, .. }) if share < 0.5 => from,
            _ => self.at(time),
        }
    }

    /// The cameras that show a time: one or two.
    pub fn cameras(&self, time: Time) -> impl Iterator<Item = usize> {
        let from = self.cross_fade(time).map(|fade| fade.from);
        from.into_iter().chain([self.at(time)])
    }

    /// Whether some frames may show two cameras.
    pub fn fades(&self) -> bool {
        self.fade > Time::from_integer(0) && self.active.is_keyed()
    }

    /// The last cut whose fade has not ended at a time: when it is, and the camera before it.
    fn cut(&self, time: Time) -> Option<(Time, usize)> {
        let Animated::Keyed(track) = &self.active else { return None };
        if !self.fades() {
            return None;
        }
        let since = track.key_times([time - self.fade, time], MOST_KEYS);
        since.windows(2).rev().find_map(|pair| self.cut_between(pair)).or_else(|| {
            // The camera before the first of these keys is that of the time at which the fade would begin.
            let (first, begin) = (*since.first()?, time - self.fade);
            (first > begin).then(|| self.cut_between(&[begin, first])).flatten()
        })
    }

    /// The cut at the end of a time without other cuts, if there is one.
    fn cut_between(&self, pair: &[Time]) -> Option<(Time, usize)> {
        let &[before, at] = pair else { return None };
        let from = self.active.at(before);
        (from != self.active.at(at)).then_some((at, from))
    }
}

/// More keys than this in one fade are not looked at.
const MOST_KEYS: usize = 1 << 10;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::track::{Ease, Key, Repeat, Track};

    fn time(num: i128, den: i128) -> Time {
        Time::new(num, den)
    }

    fn cuts(keys: &[(i128, usize)], fade: Time, repeat: Repeat) -> CameraCuts {
        let key = |&(at, value): &(i128, usize)| Key { time: time(at, 1), value, ease: Ease::Step };
        let track = Track::new(keys.iter().map(key).collect(), repeat, false).expect("a track");
        CameraCuts { active: Animated::Keyed(track), fade }
    }

    #[test]
    fn a_fade_begins_at_its_key_and_grows_evenly() {
        let cuts = cuts(&[(0, 3), (2, 5), (4, 5), (6, 1)], time(1, 1), Repeat::Hold);
        let shown = |num, den| cuts.cross_fade(time(num, den)).map(|fade| (fade.from, fade.to, fade.share));
        assert_eq!((cuts.at(time(2, 1)), shown(2, 1)), (3, None));
        assert_eq!((cuts.at(time(9, 4)), shown(9, 4)), (5, Some((3, 5, 0.25))));
        assert_eq!((cuts.leading(time(9, 4)), cuts.leading(time(5, 2))), (3, 5));
        assert_eq!((cuts.at(time(3, 1)), shown(3, 1)), (5, None));
        // A key that changes nothing is no cut, and neither is the first one.
        assert_eq!((shown(9, 2), shown(1, 4), shown(-1, 4)), (None, None, None));
        assert_eq!(shown(27, 4), Some((5, 1, 0.75)));
        assert_eq!(cuts.cameras(time(27, 4)).collect::<Vec<_>>(), [5, 1]);
        assert_eq!(cuts.cameras(time(8, 1)).collect::<Vec<_>>(), [1]);
    }

    #[test]
    fn without_a_fade_cuts_take_effect_at_once() {
        let cuts = cuts(&[(0, 3), (2, 5)], time(0, 1), Repeat::Hold);
        assert_eq!((cuts.at(time(2, 1)), cuts.cross_fade(time(2, 1)), cuts.fades()), (5, None, false));
        assert_eq!((CameraCuts::from(4).at(time(2, 1)), CameraCuts::from(4).fades()), (4, false));
    }

    #[test]
    fn repeated_cuts_fade_too() {
        let cuts = cuts(&[(0, 3), (2, 5), (4, 3)], time(1, 1), Repeat::Loop);
        let expected = Some(CrossFade { from: 3, to: 5, share: 0.5 });
        assert_eq!((cuts.cross_fade(time(5, 2)), cuts.cross_fade(time(13, 2))), (expected, expected));
    }
}
