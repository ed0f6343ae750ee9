//! Which axis points up.

use super::{DMat3, DVec3};

/// The upward axis of right-handed coordinates. Kinora's own axes have y up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum UpAxis {
    #[default]
    Y,
    /// As in CAD, robotics and Blender. x stays, and y points away from the default camera.
    Z,
}

impl UpAxis {
    /// The unit vector that points up.
    pub fn unit(self) -> DVec3 {
        self.from_y_up(DVec3::Y)
    }

    /// A vector of these axes in axes with y up: (x, y, z) → (x, z, -y) for z. Exact.
    pub fn to_y_up(self, DVec3 { x, y, z }: DVec3) -> DVec3 {
        match self {
            Self::Y => DVec3 { x, y, z },
            // Subtraction gives no negative zero.
            Self::Z => DVec3 { x, y: z, z: 0.0 - y },
        }
    }

    /// The inverse of [`UpAxis::to_y_up`].
    pub fn from_y_up(self, DVec3 { x, y, z }: DVec3) -> DVec3 {
        match self {
            Self::Y => DVec3 { x, y, z },
            Self::Z => DVec3 { x, y: 0.0 - z, z: y },
        }
    }

    /// [`UpAxis::to_y_up`] as a matrix.
    pub fn matrix(self) -> DMat3 {
        let column = |e| self.to_y_up(e);
        DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn z_up_becomes_y_up_by_a_rotation() {
        let v = DVec3::new(1.0, 2.0, 3.0);
        for up in [UpAxis::Y, UpAxis::Z] {
            assert_eq!(up.to_y_up(up.unit()), DVec3::Y);
            assert_eq!(up.from_y_up(up.to_y_up(v)), v);
            assert_eq!(up.matrix() * v, up.to_y_up(v));
            assert_eq!(up.matrix().determinant(), 1.0);
        }
        assert_eq!(UpAxis::Z.to_y_up(v), DVec3::new(1.0, 3.0, -2.0));
        assert!(UpAxis::Z.to_y_up(DVec3::ZERO).z.is_sign_positive());
    }
}
