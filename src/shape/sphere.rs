use crate::math::DVec3;

/// All points at distance `radius` (above 0) from `center`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    pub center: DVec3,
    pub radius: f64,
}
