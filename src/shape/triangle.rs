use crate::math::DVec3;

/// The flat triangle between three corners that are not in one line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    pub corners: [DVec3; 3],
}
