use crate::math::DVec3;

/// The parallelogram `corner` + a·`u` + b·`v` for a and b in 0..=1; `u` and `v` are not parallel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    pub corner: DVec3,
    pub u: DVec3,
    pub v: DVec3,
}
