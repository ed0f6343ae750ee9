//! Transforms of objects over time.

use crate::base::math::{Angle, DAffine3, DMat3, DQuat, DVec3, axis_angle, euler_xyz, is_flat, orthonormal};
use crate::base::time::Time;
use crate::geometry::motion::Motion;
use crate::track::{Animated, SegmentCache};

/// Translation, rotation and scale over time. A point p goes to
/// translation + pivot + R(scale · (p - pivot)). If a program moves the object, p is moved first.
#[derive(Clone, Debug, PartialEq)]
#[warn(missing_docs)]
pub struct TransformTracks {
    /// Moves the object, after everything else.
    pub translation: Animated<DVec3>,
    /// Turns it about the pivot.
    pub rotation: Rotation,
    /// Scales it along its axes, away from the pivot.
    pub scale: Animated<DVec3>,
    /// The fixed point of rotation and scale.
    pub pivot: DVec3,
    /// What a program does besides keys.
    pub motion: Option<Motion>,
    /// Moves it away from its place, for an exploded view.
    pub explode: Option<ExplodeOffset>,
}

/// The offset of a part in an exploded view.
#[derive(Clone, Debug, PartialEq)]
#[warn(missing_docs)]
pub struct ExplodeOffset {
    /// The offset at a factor of 1.
    pub offset: DVec3,
    /// Multiplies the offset.
    pub factor: Animated<f64>,
}

/// A rotation over time.
#[derive(Clone, Debug, PartialEq)]
#[warn(missing_docs)]
pub enum Rotation {
    /// Unit quaternions, interpolated along the shorter arc.
    Quaternion(Animated<DQuat>),
    /// About an axis of any nonzero length, by any angle, also more than a turn.
    AxisAngle {
        /// The axis.
        axis: Animated<DVec3>,
        /// The angle, counterclockwise if the axis points to the eye.
        angle: Animated<Angle>,
    },
    /// About the fixed axes x, then y, then z.
    Euler {
        /// The angle about the x axis.
        x: Animated<Angle>,
        /// The angle about the y axis.
        y: Animated<Angle>,
        /// The angle about the z axis.
        z: Animated<Angle>,
    },
}

impl Default for TransformTracks {
    fn default() -> Self {
        Self {
            translation: DVec3::ZERO.into(),
            rotation: Rotation::Quaternion(DQuat::IDENTITY.into()),
            scale: DVec3::ONE.into(),
            pivot: DVec3::ZERO,
            motion: None,
            explode: None,
        }
    }
}

#[warn(missing_docs)]
impl Rotation {
    /// Whether any part has keys.
    pub fn is_keyed(&self) -> bool {
        match self {
            Self::Quaternion(quaternion) => quaternion.is_keyed(),
            Self::AxisAngle { axis, angle } => axis.is_keyed() || angle.is_keyed(),
            Self::Euler { x, y, z } => x.is_keyed() || y.is_keyed() || z.is_keyed(),
        }
    }

    /// The times of all keys, in no particular order.
    pub fn key_times(&self) -> Vec<Time> {
        match self {
            Self::Quaternion(quaternion) => quaternion.key_times().collect(),
            Self::AxisAngle { axis, angle } => axis.key_times().chain(angle.key_times()).collect(),
            Self::Euler { x, y, z } => [x, y, z].into_iter().flat_map(|angle| angle.key_times()).collect(),
        }
    }

    /// The rotation at a time.
    pub fn at(&self, time: Time) -> DMat3 {
        self.at_cached(time, &mut SegmentCache::default())
    }

    /// [`Rotation::at`] with the segment that was found for the last of several tracks.
    pub(super) fn at_cached(&self, time: Time, cache: &mut SegmentCache) -> DMat3 {
        match self {
            Self::Quaternion(quaternion) => DMat3::from_quat(quaternion.at_cached(time, cache)),
            Self::AxisAngle { axis, angle } => {
                // A keyed axis may pass through zero on its way to the opposite direction.
                let axis = axis.at_cached(time, cache).try_normalize().unwrap_or(DVec3::Y);
                axis_angle(axis, angle.at_cached(time, cache))
            }
            Self::Euler { x, y, z } => {
                let [x, y, z] = [x, y, z].map(|angle| angle.at_cached(time, cache));
                euler_xyz(x, y, z)
            }
        }
    }
}

#[warn(missing_docs)]
impl TransformTracks {
    /// Whether the transform may change over time.
    pub fn is_keyed(&self) -> bool {
        let Self { translation, rotation, scale, pivot: _, motion, explode } = self;
        let explodes = explode.as_ref().is_some_and(|explode| explode.factor.is_keyed());
        translation.is_keyed() || rotation.is_keyed() || scale.is_keyed() || motion.is_some() || explodes
    }

    /// The times of all keys, in no particular order.
    pub fn key_times(&self) -> Vec<Time> {
        let mut times = self.rotation.key_times();
        times.extend(self.translation.key_times().chain(self.scale.key_times()));
        times.extend(self.explode.iter().flat_map(|explode| explode.factor.key_times()));
        times
    }

    /// The rotation from the object to its parent, without scales. Of a program's map, the z axis counts, then the side
    /// on which the y axis is.
    pub fn rotation_at(&self, time: Time) -> DMat3 {
        let rotation = self.rotation.at(time);
        self.motion.as_ref().map_or(rotation, |motion| rotation * orthonormal(motion.at(time).matrix3))
    }

    /// The map from the object to its parent. A scale of 0 along any axis gives a singular map, which hides the
    /// object.
    pub fn at(&self, time: Time) -> DAffine3 {
        let turn = about_pivot(self.rotation.at(time), self.scale.at(time), self.pivot);
        placed(turn, self.translation.at(time), (self.explode.as_ref(), self.motion.as_ref()), time)
    }
}

/// The matrix of a rotation and a scale about a pivot, and what they add to the translation.
pub(super) fn about_pivot(rotation: DMat3, scale: DVec3, pivot: DVec3) -> (DMat3, DVec3) {
    let matrix = rotation * DMat3::from_diagonal(scale);
    // The identity maps the pivot to itself exactly, so pure translations stay exact.
    (matrix, pivot - matrix * pivot)
}

/// The map from the object to its parent, from the parts of [`about_pivot`] and the tracks of the rest.
#[inline]
pub(super) fn placed(
    (matrix, offset): (DMat3, DVec3),
    mut translation: DVec3,
    (explode, motion): (Option<&ExplodeOffset>, Option<&Motion>),
    time: Time,
) -> DAffine3 {
    if let Some(ExplodeOffset { offset, factor }) = explode {
        translation += *offset * factor.at(time);
    }
    let placed = DAffine3::from_mat3_translation(matrix, translation + offset);
    match motion {
        // A flat object stays exactly flat, so that it is hidden.
        Some(motion) if !is_flat(&placed) => placed * motion.at(time),
        _ => placed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scale_then_rotation_then_translation_about_the_pivot() {
        let tracks = TransformTracks {
            translation: DVec3::new(0.0, 0.0, 5.0).into(),
            rotation: Rotation::AxisAngle { axis: DVec3::Z.into(), angle: Angle(90.0).into() },
            scale: DVec3::new(2.0, 1.0, 1.0).into(),
            pivot: DVec3::X,
            motion: None,
            explode: None,
        };
        let affine = tracks.at(Time::from_integer(0));
        assert_eq!(affine.transform_point3(DVec3::X), DVec3::new(1.0, 0.0, 5.0));
        assert_eq!(affine.transform_point3(DVec3::X * 2.0), DVec3::new(1.0, 2.0, 5.0));
    }

    #[test]
    fn flat_objects_stay_flat_when_a_program_turns_them() {
        for flat in [DVec3::new(0.0, 1.0, 1.0), DVec3::new(1.0, 0.0, 1.0)] {
            let tracks = TransformTracks {
                rotation: Rotation::AxisAngle {
                    axis: DVec3::new(1.0, 2.0, 3.0).into(),
                    angle: Angle(29.0).into(),
                },
                scale: flat.into(),
                motion: Some(Motion::new(|time| DAffine3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), time))),
                ..TransformTracks::default()
            };
            assert!((0..100).all(|time| is_flat(&tracks.at(Time::from_integer(time)))));
        }
    }
}
