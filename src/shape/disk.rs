use crate::math::DVec3;

/// The flat disk of `radius` (above 0) around `center`, across the unit vector `normal`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    pub center: DVec3,
    pub normal: DVec3,
    pub radius: f64,
}
