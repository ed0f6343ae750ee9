//! Transforms of objects over time.

use crate::base::math::{Angle, DAffine3, DMat3, DQuat, DVec3, axis_angle, euler_xyz};
use crate::base::time::Time;
use crate::track::Animated;
use bevy_ecs::component::Component;

/// Translation, rotation and scale over time. A point p goes to
/// translation + pivot + R(scale · (p - pivot)).
#[derive(Clone, Component, Debug, PartialEq)]
pub struct TransformTracks {
    pub translation: Animated<DVec3>,
    pub rotation: Rotation,
    pub scale: Animated<DVec3>,
    /// The fixed point of rotation and scale.
    pub pivot: DVec3,
}

/// A rotation over time.
#[derive(Clone, Debug, PartialEq)]
pub enum Rotation {
    /// Unit quaternions, interpolated along the shorter arc.
    Quaternion(Animated<DQuat>),
    /// About an axis of any nonzero length, by any angle, also more than a turn.
    AxisAngle { axis: Animated<DVec3>, angle: Animated<Angle> },
    /// About the fixed axes x, then y, then z.
    Euler { x: Animated<Angle>, y: Animated<Angle>, z: Animated<Angle> },
    /// An exact change of axes, not over time.
    Fixed(DMat3),
}

impl Default for TransformTracks {
    fn default() -> Self {
        Self {
            translation: DVec3::ZERO.into(),
            rotation: Rotation::Quaternion(DQuat::IDENTITY.into()),
            scale: DVec3::ONE.into(),
            pivot: DVec3::ZERO,
        }
    }
}

impl Rotation {
    pub fn at(&self, time: Time) -> DMat3 {
        match self {
            Self::Quaternion(quaternion) => DMat3::from_quat(quaternion.at(time)),
            Self::AxisAngle { axis, angle } => {
                // A keyed axis may pass through zero on its way to the opposite direction.
                axis_angle(axis.at(time).try_normalize().unwrap_or(DVec3::Y), angle.at(time))
            }
            Self::Euler { x, y, z } => euler_xyz(x.at(time), y.at(time), z.at(time)),
            Self::Fixed(matrix) => *matrix,
        }
    }
}

impl TransformTracks {
    /// Whether any part has keys.
    pub fn is_keyed(&self) -> bool {
        let turns = match &self.rotation {
            Rotation::Quaternion(quaternion) => quaternion.is_keyed(),
            Rotation::AxisAngle { axis, angle } => axis.is_keyed() || angle.is_keyed(),
            Rotation::Euler { x, y, z } => x.is_keyed() || y.is_keyed() || z.is_keyed(),
            Rotation::Fixed(_) => false,
        };
        turns || self.translation.is_keyed() || self.scale.is_keyed()
    }

    /// The map from the object to its parent. A scale of 0 along any axis gives a singular map, which hides the
    /// object.
    pub fn at(&self, time: Time) -> DAffine3 {
        let (scale, rotation) = (self.scale.at(time), self.rotation.at(time));
        let translation = self.translation.at(time);
        let matrix = rotation * DMat3::from_diagonal(scale);
        // The identity maps the pivot to itself exactly, so pure translations stay exact.
        DAffine3::from_mat3_translation(matrix, translation + (self.pivot - matrix * self.pivot))
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
        };
        let affine = tracks.at(Time::from_integer(0));
        assert_eq!(affine.transform_point3(DVec3::X), DVec3::new(1.0, 0.0, 5.0));
        assert_eq!(affine.transform_point3(DVec3::X * 2.0), DVec3::new(1.0, 2.0, 5.0));
    }
}
