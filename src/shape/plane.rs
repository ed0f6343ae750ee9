use crate::math::DVec3;

/// The infinite plane through `point` across the unit vector `normal`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    pub point: DVec3,
    pub normal: DVec3,
}
