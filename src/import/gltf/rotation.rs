//! Rotations as files write them.

use crate::base::math::DQuat;

/// A quaternion (x, y, z, w) of length 1; none if it is zero. Scaled first, so that its length neither underflows nor
/// overflows.
pub fn unit(parts: [f64; 4]) -> Option<DQuat> {
    let largest = parts.iter().fold(0.0, |largest: f64, part| largest.max(part.abs()));
    (largest > 0.0).then(|| DQuat::from_array(parts.map(|part| part / largest)).normalize())
}
