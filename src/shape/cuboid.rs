use crate::math::DVec3;

/// The surface of the axis-aligned box from `min` to `max`, each of whose sides is longer than 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    pub min: DVec3,
    pub max: DVec3,
}
