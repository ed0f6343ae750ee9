//! Exponentials and arc tangents in lanes. They use basic operations only, so every processor gives the same bits.

use crate::base::lanes::Real;
use std::f64::consts::FRAC_PI_4;

/// π / 4 - [`FRAC_PI_4`].
const FRAC_PI_4_REST: f64 = 3.061_616_997_868_383e-17;

/// ln 2 with its last 21 bits clear, so that products with exponents are exact; and the remainder.
const LN_2: f64 = 0.693_147_180_369_123_8;
const LN_2_REST: f64 = 1.908_214_929_270_587_7e-10;

/// 1 / n! for n = 2, 3, ….
const EXP: [f64; 12] = [
    1.0 / 2.0,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5_040.0,
    1.0 / 40_320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
    1.0 / 39_916_800.0,
    1.0 / 479_001_600.0,
    1.0 / 6_227_020_800.0,
];

/// The same coefficients in all lanes.
#[inline(always)]
fn splats<F: Real, const N: usize>(coefficients: [f64; N]) -> [F; N] {
    let mut lanes = [F::splat(0.0); N];
    for (lanes, coefficient) in lanes.iter_mut().zip(coefficients) {
        *lanes = F::splat(coefficient);
    }
    lanes
}

/// exp(x) as 2^n · (1 + rest): the integer n, and the rest.
#[inline(always)]
fn parts_of_exp<F: Real>(x: F) -> (F, F) {
    let n = (x * F::splat(std::f64::consts::LOG2_E) + F::splat(0.5)).floor();
    // |r| is at most half of ln 2. The first difference is exact.
    let r = (x - n * F::splat(LN_2)) - n * F::splat(LN_2_REST);
    // Taylor series of exp(r) - 1 up to the 13th power, by Estrin's scheme. Its relative error is below 2^-56.
    let [c2, c3, c4, c5, c6, c7, c8, c9, c10, c11, c12, c13] = splats(EXP);
    let (r2, r4) = (r * r, r * r * (r * r));
    let low = (c2 + r * c3) + r2 * (c4 + r * c5);
    let middle = (c6 + r * c7) + r2 * (c8 + r * c9);
    let high = (c10 + r * c11) + r2 * (c12 + r * c13);
    (n, r + r2 * (low + r4 * (middle + r4 * high)))
}

/// exp(x), within 2 units of roundoff if the result is a normal number.
#[inline(always)]
pub fn exp<F: Real>(x: F) -> F {
    // Beyond these limits the result is 0 or infinite.
    let (n, rest) = parts_of_exp(x.max(F::splat(-746.0)).min(F::splat(710.0)));
    // Scale in two steps, because 2^n itself may overflow or underflow.
    let half = (n * F::splat(0.5)).floor();
    (half.exp2_whole() + half.exp2_whole() * rest) * (n - half).exp2_whole()
}

/// exp(x) - 1, within 3 units of roundoff, for x up to 709.
#[inline(always)]
pub fn exp_m1<F: Real>(x: F) -> F {
    let (n, rest) = parts_of_exp(x.max(F::splat(-64.0)).min(F::splat(709.0)));
    let power = n.exp2_whole();
    (power - F::splat(1.0)) + power * rest
}

/// Coefficients of x², x⁴, … of atan(x) / x - 1, for x up to tan(π / 8): Chebyshev interpolation of degree 12. The
/// error is below 3e-18.
const ATAN: [f64; 12] = [
    -0.333_333_333_333_333_26,
    0.199_999_999_999_970_15,
    -0.142_857_142_853_297_1,
    0.111_111_110_853_221_09,
    -0.090_909_080_590_311_91,
    0.076_922_810_999_377_44,
    -0.066_662_052_599_765_26,
    0.058_768_340_046_141_61,
    -0.052_173_125_740_615_91,
    0.044_995_007_289_840_32,
    -0.033_387_824_501_211_95,
    0.015_113_765_096_600_925,
];

/// The angle of (x, y) in -π..=π, within 3 units of roundoff. The origin has the angle of points on +x, 0.
#[inline(always)]
pub fn atan2<F: Real>(y: F, x: F) -> F {
    let zero = F::splat(0.0);
    let (width, height) = (x.abs(), y.abs());
    let steep = width.lt(height);
    let (long, short) = (F::select(steep, height, width), F::select(steep, width, height));
    // Above tan(π / 8), the angle from the diagonal: the difference of two close numbers is exact.
    let diagonal = (long * F::splat(0.414_213_562_373_095_03)).lt(short);
    let above = F::select(diagonal, short - long, short);
    let along = F::select(diagonal, short + long, long);
    let ratio = F::select(long.eq(zero), zero, above / along);
    let z = ratio * ratio;
    let [a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12] = splats(ATAN);
    let (z2, z4) = (z * z, z * z * (z * z));
    let z8 = z4 * z4;
    let low = (a1 + z * a2) + z2 * (a3 + z * a4);
    let middle = (a5 + z * a6) + z2 * (a7 + z * a8);
    let high = (a9 + z * a10) + z2 * (a11 + z * a12);
    let from_axis = ratio + ratio * (z * (low + z4 * middle + z8 * high));
    let left = x.is_negative();
    let angle = F::select(diagonal, quarters_and(1.0, from_axis), from_axis);
    let angle = F::select(steep, quarters_and(2.0, -angle), angle);
    let angle = F::select(left, quarters_and(4.0, -angle), angle);
    angle.copysign(y)
}

/// `count` · π / 4 + `angle`. The small terms are added first.
#[inline(always)]
fn quarters_and<F: Real>(count: f64, angle: F) -> F {
    F::splat(count * FRAC_PI_4) + (angle + F::splat(count * FRAC_PI_4_REST))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::lanes::tests::on_all_levels;
    use crate::base::lanes::{Level, Row, SimdKernel, dispatch};
    use crate::base::math::UNIT_ROUNDOFF;
    use crate::testing::Random;

    /// Within `units` units of roundoff of the result of libm, whose own error is within 1.
    fn assert_near(found: f64, expected: f64, units: f64, of: &str) {
        let off = (found - expected).abs();
        assert!(off <= units * UNIT_ROUNDOFF * expected.abs(), "{of}: {found:e} for {expected:e}");
    }

    #[test]
    fn exponentials_are_those_of_the_library() {
        let mut random = Random(21);
        for round in 0..200_000 {
            let x = match round % 4 {
                0 => 1400.0 * random.unit() - 700.0,
                1 => 4.0 * random.unit() - 2.0,
                2 => libm::pow(10.0, -20.0 * random.unit()),
                _ => -libm::pow(10.0, -20.0 * random.unit()),
            };
            assert_near(exp(x), libm::exp(x), 4.0, "exp");
            assert_near(exp_m1(x), libm::expm1(x), 5.0, "exp_m1");
        }
        assert_eq!((exp(0.0), exp_m1(0.0), exp_m1(f64::NEG_INFINITY)), (1.0, 0.0, -1.0));
        assert_eq!((exp(f64::NEG_INFINITY), exp(f64::INFINITY)), (0.0, f64::INFINITY));
        for x in [-708.0, -720.0, -740.0, -745.0] {
            assert!((exp(x) - libm::exp(x)).abs() <= 1e-323, "{x}");
        }
    }

    #[test]
    fn angles_are_those_of_the_library() {
        let mut random = Random(22);
        for round in 0..200_000 {
            let turn = 8.0 * random.unit() - 4.0;
            let (y, x) = match round % 3 {
                0 => (random.unit() - 0.5, random.unit() - 0.5),
                1 => (libm::pow(10.0, 20.0 * turn), -random.unit()),
                _ => (-libm::sin(turn), libm::cos(turn)),
            };
            assert_near(atan2(y, x), libm::atan2(y, x), 5.0, "atan2");
        }
        for (y, x) in [(0.0, 1.0), (-0.0, 1.0), (1.0, 0.0), (-1.0, 0.0), (0.0, -1.0), (1.0, 1.0), (1.0, -1.0)]
        {
            assert_near(atan2(y, x), libm::atan2(y, x), 1.0, "atan2");
        }
        assert_eq!(atan2(0.0, 0.0), 0.0);
    }

    struct All([f64; 8], [f64; 8]);

    impl SimdKernel for All {
        type Output = [[f64; 8]; 3];

        #[inline(always)]
        fn run<L: Level>(self) -> Self::Output {
            let (x, y) = (L::F64::from_array(self.0), L::F64::from_array(self.1));
            [exp(x).to_array(), exp_m1(x).to_array(), atan2(y, x).to_array()]
        }
    }

    #[test]
    fn lanes_are_like_one() {
        let mut random = Random(23);
        for _ in 0..2000 {
            let (x, y) = ([0; 8].map(|_| 90.0 * random.unit() - 45.0), [0; 8].map(|_| random.unit() - 0.5));
            for (level, [a, b, c]) in on_all_levels(|| dispatch(All(x, y))) {
                for lane in 0..8 {
                    let one = (exp(x[lane]), exp_m1(x[lane]), atan2(y[lane], x[lane]));
                    assert_eq!((a[lane], b[lane], c[lane]), one, "{level:?}");
                }
            }
        }
    }
}
