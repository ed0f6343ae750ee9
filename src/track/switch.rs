//! Switches of several parts.

use super::Animated;
use crate::base::time::Time;
use std::sync::Arc;

/// Whether all of several values are true, such as the switch of a light and the visibility of what carries it.
#[derive(Clone, Debug, PartialEq)]
pub struct Switch {
    /// Empty if it is always on. A single constant if it is always off. Otherwise, all parts have keys.
    parts: Arc<[Animated<bool>]>,
}

impl Switch {
    pub fn all_of(parts: impl IntoIterator<Item = Animated<bool>>) -> Self {
        let mut keyed = Vec::new();
        for part in parts {
            match part {
                // A track that is never true needs no keys.
                part if part.values().all(|on| !on) => return Self { parts: Arc::from([false.into()]) },
                Animated::Constant(_) => {}
                part => keyed.push(part),
            }
        }
        Self { parts: keyed.into() }
    }

    pub fn parts(&self) -> &[Animated<bool>] {
        &self.parts
    }

    pub fn at(&self, time: Time) -> bool {
        self.parts.iter().all(|part| part.at(time))
    }

    /// The state, if it is the same at all times.
    pub fn constant(&self) -> Option<bool> {
        match &*self.parts {
            [] => Some(true),
            [Animated::Constant(on)] => Some(*on),
            _ => None,
        }
    }

    pub fn is_keyed(&self) -> bool {
        self.parts.iter().any(Animated::is_keyed)
    }

    /// Whether it is off at all times.
    pub fn is_never_on(&self) -> bool {
        self.parts.contains(&Animated::Constant(false))
    }
}

impl From<bool> for Switch {
    fn from(on: bool) -> Self {
        Self::all_of([on.into()])
    }
}

impl From<Animated<bool>> for Switch {
    fn from(on: Animated<bool>) -> Self {
        Self::all_of([on])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::track::{Ease, Key, Repeat, Track};

    fn track(keys: &[(i128, bool)]) -> Animated<bool> {
        let key = |&(time, value)| Key { time: Time::from_integer(time), value, ease: Ease::Step };
        Animated::Keyed(Track::new(keys.iter().map(key).collect(), Repeat::Loop, false).expect("a track"))
    }

    #[test]
    fn a_switch_is_on_while_all_parts_are() {
        let (a, b) =
            (track(&[(0, true), (1, false), (3, true)]), track(&[(0, false), (2, true), (5, false)]));
        let both = Switch::all_of([a.clone(), true.into(), b.clone()]);
        for time in (-40..40).map(|half| Time::new(half, 2)) {
            assert_eq!(both.at(time), a.at(time) && b.at(time), "{time}");
        }
        assert!(both.is_keyed() && both.parts().len() == 2);
    }

    #[test]
    fn constant_parts_vanish() {
        let keyed = track(&[(0, true), (1, false)]);
        assert_eq!(Switch::all_of([true.into(), true.into()]), true.into());
        assert_eq!(Switch::all_of([keyed.clone(), false.into()]), false.into());
        assert_eq!(Switch::from(track(&[(0, false), (1, false)])), false.into());
        assert_eq!(Switch::all_of([true.into(), keyed.clone()]), keyed.into());
        assert!(Switch::from(false).is_never_on() && !Switch::from(true).is_never_on());
    }
}
