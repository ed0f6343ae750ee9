//! f64 geometry, exact angles, stable frames, and the error bounds that replace epsilons.

mod affine;
mod angle;
mod basis;
mod bounds;
mod elementary;
mod error;
pub mod exact;
mod ray;
mod root;
mod rotation;
mod turn;
mod up;

pub use crate::base::lanes::{NEAR_ZERO, next_away};
pub use affine::{absolute, inverse, is_flat, is_identity};
pub use angle::Angle;
pub use basis::{Basis, look_at, perpendicular};
pub use bounds::Aabb;
pub use elementary::{atan2, exp, exp_m1};
pub use error::{UNIT_ROUNDOFF, difference_of_products, dot_plus, gamma};
pub use glam::{DAffine3, DMat3, DQuat, DVec2, DVec3};
pub use ray::{LaneRay, Ray};
pub use root::{Function, root_between};
pub use rotation::{
    NotRigid, ROUNDED, axis_angle, euler_xyz, orthonormal, rotation_and_scale, slerp, unit_quaternion,
};
pub use turn::{cos_sin_of_quarters, cos_sin_of_turns};
pub use up::UpAxis;

use crate::base::lanes::Real;

/// The larger number; `b` if either is NaN. This is one instruction, unlike `f64::max`.
#[inline(always)]
pub fn max(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The smaller number; `b` if either is NaN.
#[inline(always)]
pub fn min(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// `base` to the power of an integer, by repeated squaring. The order of the multiplications is fixed.
#[inline(always)]
pub fn power<F: Real>(base: F, exponent: u32) -> F {
    let (mut result, mut square, mut rest) = (F::splat(1.0), base, exponent);
    while rest > 0 {
        if rest & 1 == 1 {
            result = result * square;
        }
        square = square * square;
        rest >>= 1;
    }
    result
}

#[cfg(test)]
mod tests {
    use super::power;

    #[test]
    fn powers_of_two_are_exact() {
        for exponent in 0..64 {
            assert_eq!(power(2.0, exponent), (1u64 << exponent) as f64);
        }
        assert_eq!(power(0.0, 0), 1.0);
    }
}
