//! Axis-aligned boxes.

use super::{DAffine3, DVec3};

/// An axis-aligned bounding box in f64. It is empty if `min` exceeds `max` on any axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    pub min: DVec3,
    pub max: DVec3,
}

impl Aabb {
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    pub fn corners(self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { self.min[axis] } else { self.max[axis] };
            DVec3::new(pick(0), pick(1), pick(2))
        })
    }

    /// The bounds of this box transformed by `affine`, padded by the rounding error of the transform.
    pub fn transformed(self, affine: &DAffine3) -> Self {
        let abs = affine.matrix3.abs();
        let moved = Self::around(self.corners().map(|c| affine.transform_point3(c)));
        let reach = abs * self.min.abs().max(self.max.abs()) + affine.translation.abs();
        moved.padded(reach * super::gamma(4))
    }

    pub fn padded(self, by: DVec3) -> Self {
        Self { min: self.min - by, max: self.max + by }
    }

    pub fn center(self) -> DVec3 {
        self.min * 0.5 + self.max * 0.5
    }

    pub fn size(self) -> DVec3 {
        self.max - self.min
    }

    /// The surface area.
    pub fn area(self) -> f64 {
        let side = self.size();
        2.0 * (side.x * side.y + side.y * side.z + side.z * side.x)
    }

    pub fn is_empty(self) -> bool {
        !self.min.cmple(self.max).all()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transformed_box_holds_its_transformed_corners() {
        let b = Aabb { min: DVec3::new(-1.0, 0.0, 2.0), max: DVec3::new(3.0, 0.0, 5.0) };
        let affine = DAffine3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 1.0)
            * DAffine3::from_scale(DVec3::new(2.0, -3.0, 0.1));
        let moved = b.transformed(&affine);
        for corner in b.corners() {
            let p = affine.transform_point3(corner);
            assert!(moved.min.cmple(p).all() && p.cmple(moved.max).all());
        }
        assert!(!moved.is_empty() && Aabb::EMPTY.is_empty());
    }
}
