//! Transforms of many objects that move.

use super::motion::Motion;
use super::transform::{ExplodeOffset, Rotation, TransformTracks, about_pivot, placed};
use crate::base::math::{DAffine3, DMat3, DVec3, is_identity};
use crate::base::time::Time;
use crate::track::{Animated, SegmentCache};
use bevy_ecs::component::Component;

/// [`TransformTracks`] of an object that moves, with what is the same at all times computed once. It takes a quarter of
/// their memory: with many objects, reading it takes as long as computing.
#[derive(Clone, Component, Debug)]
pub struct PreparedTransform {
    translation: Animated<DVec3>,
    turn: Turn,
    explode: Option<Box<ExplodeOffset>>,
    motion: Option<Motion>,
}

/// Rotation and scale about a pivot.
#[derive(Clone, Debug)]
enum Turn {
    /// Neither. Most objects are only moved.
    Identity,
    /// Without keys: the parts of [`about_pivot`].
    Constant(Box<(DMat3, DVec3)>),
    Keyed(Box<KeyedTurn>),
}

#[derive(Clone, Debug)]
struct KeyedTurn {
    rotation: Rotation,
    scale: Animated<DVec3>,
    pivot: DVec3,
}

impl Turn {
    fn new(rotation: &Rotation, scale: &Animated<DVec3>, pivot: DVec3) -> Self {
        if rotation.is_keyed() || scale.is_keyed() {
            return Self::Keyed(Box::new(KeyedTurn {
                rotation: rotation.clone(),
                scale: scale.clone(),
                pivot,
            }));
        }
        let start = Time::from_integer(0);
        let (matrix, offset) = about_pivot(rotation.at(start), scale.at(start), pivot);
        let is_zero = offset.to_array().map(f64::to_bits) == [0; 3];
        if is_identity(&matrix) && is_zero {
            Self::Identity
        } else {
            Self::Constant(Box::new((matrix, offset)))
        }
    }

    #[inline]
    fn at(&self, time: Time, cache: &mut SegmentCache) -> (DMat3, DVec3) {
        match self {
            Self::Identity => (DMat3::IDENTITY, DVec3::ZERO),
            Self::Constant(parts) => **parts,
            Self::Keyed(keyed) => {
                let KeyedTurn { rotation, scale, pivot } = &**keyed;
                about_pivot(rotation.at_cached(time, cache), scale.at_cached(time, cache), *pivot)
            }
        }
    }
}

impl From<&TransformTracks> for PreparedTransform {
    fn from(tracks: &TransformTracks) -> Self {
        let TransformTracks { translation, rotation, scale, pivot, motion, explode } = tracks;
        Self {
            translation: translation.clone(),
            turn: Turn::new(rotation, scale, *pivot),
            explode: explode.clone().map(Box::new),
            motion: motion.clone(),
        }
    }
}

impl PreparedTransform {
    /// [`TransformTracks::at`], bit for bit, with the segment that was found for the last of several objects.
    #[inline]
    pub fn at(&self, time: Time, cache: &mut SegmentCache) -> DAffine3 {
        let (translation, turn) = (self.translation.at_cached(time, cache), self.turn.at(time, cache));
        placed(turn, translation, (self.explode.as_deref(), self.motion.as_ref()), time)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::Angle;
    use crate::testing::Random;
    use crate::track::{Animate, Ease, Key, Repeat, Track};

    fn keyed<T: Animate>(values: [T; 2]) -> Animated<T> {
        let key = |(time, value)| Key { time: Time::from_integer(time), value, ease: Ease::Smooth };
        Animated::Keyed(
            Track::new((0..).zip(values).map(key).collect(), Repeat::PingPong, false).expect("a track"),
        )
    }

    /// Every combination of parts that are missing, constant and keyed gives the bits of the tracks.
    #[test]
    fn what_is_computed_once_changes_no_bit() {
        let mut random = Random(4);
        let mut point = || random.point(3.0);
        let zeros = DVec3::new(-0.0, 0.0, -0.0);
        let about = |axis: DVec3, angle| Rotation::AxisAngle { axis: axis.into(), angle };
        let translations = [DVec3::ZERO.into(), zeros.into(), point().into(), keyed([zeros, point()])];
        let rotations = [
            TransformTracks::default().rotation,
            about(point(), Angle(30.0).into()),
            about(point(), keyed([Angle(0.0), Angle(400.0)])),
        ];
        let scales = [DVec3::ONE.into(), point().into(), keyed([DVec3::ONE, point()])];
        let explodes = [None, Some(ExplodeOffset { offset: point(), factor: keyed([0.0, 1.0]) })];
        let motions = [None, Some(Motion::new(DAffine3::from_rotation_y))];
        let pivots = [DVec3::ZERO, zeros, point()];
        let mut cache = SegmentCache::default();
        let bits = |map: DAffine3| map.to_cols_array().map(f64::to_bits);
        let mut variants = 0;
        for (translation, rotation) in translations.iter().flat_map(|t| rotations.iter().map(move |r| (t, r)))
        {
            for (scale, pivot) in scales.iter().flat_map(|scale| pivots.map(|pivot| (scale, pivot))) {
                for (explode, motion) in explodes.iter().flat_map(|e| motions.iter().map(move |m| (e, m))) {
                    let tracks = TransformTracks {
                        translation: translation.clone(),
                        rotation: rotation.clone(),
                        scale: scale.clone(),
                        pivot,
                        motion: motion.clone(),
                        explode: explode.clone(),
                    };
                    let prepared = PreparedTransform::from(&tracks);
                    for time in (-3..12).map(|time| Time::new(time, 4)) {
                        assert_eq!(bits(prepared.at(time, &mut cache)), bits(tracks.at(time)), "{tracks:?}");
                    }
                    variants += 1;
                }
            }
        }
        assert_eq!(variants, 4 * 3 * 3 * 3 * 4);
    }
}
