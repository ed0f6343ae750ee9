//! Cosines and sines of shares of a turn, for one number or for several at once: what directions are drawn with.

use super::Real;

/// 1 / n!, of even and of odd n from 2 on, with the signs of the series of the cosine and the sine.
const COSINE: [f64; 8] = [
    -1.0 / 2.0,
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
    1.0 / 20_922_789_888_000.0,
];
const SINE: [f64; 8] = [
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5_040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
    1.0 / 355_687_428_096_000.0,
];

#[inline(always)]
fn series<T: Real>(coefficients: &[f64; 8], square: T) -> T {
    let [a, b, c, d, e, f, g, h] = *coefficients;
    // By Estrin's scheme: Horner's would be one long chain.
    let fourth = square * square;
    let eighth = fourth * fourth;
    let low = (T::of(a) + T::of(b) * square) + (T::of(c) + T::of(d) * square) * fourth;
    let high = (T::of(e) + T::of(f) * square) + (T::of(g) + T::of(h) * square) * fourth;
    low + high * eighth
}

/// The cosine and the sine of `r` quarter turns, for r in -1/2..=1/2, by Taylor's series up to the 16th and the 17th
/// power, which leave out less than 2^-58: both are within 2 units of roundoff.
#[inline(always)]
pub fn cos_sin_of_quarters<T: Real>(r: T) -> (T, T) {
    let angle = r * T::of(std::f64::consts::FRAC_PI_2);
    let square = angle * angle;
    let cosine = T::of(1.0) + square * series(&COSINE, square);
    let sine = angle + angle * (square * series(&SINE, square));
    (cosine, sine)
}

/// The cosine and the sine of `u` turns, for u in 0..=1; exact at every quarter.
#[inline(always)]
pub fn cos_sin_of_turns<T: Real>(u: T) -> (T, T) {
    let quarters = u * T::of(4.0);
    let place = quarters + T::of(0.5);
    let (zero, one) = (T::of(0.0), T::of(1.0));
    // The nearest quarter, 4 again being 0. What is left is exact.
    let nearest = place.at_least(1.0, one, zero)
        + place.at_least(2.0, one, zero)
        + place.at_least(3.0, one, zero)
        + place.at_least(4.0, one, zero);
    let (c, s) = cos_sin_of_quarters(quarters - nearest);
    let (minus_c, minus_s) = (zero - c, zero - s);
    (of_quarter(place, [c, minus_s, minus_c, s]), of_quarter(place, [s, c, minus_s, minus_c]))
}

/// The one of the quarter before 1, 2, 3 or 4.
// No closure: it would be compiled for less than the lanes need.
#[inline(always)]
fn of_quarter<T: Real>(place: T, [a, b, c, d]: [T; 4]) -> T {
    let late = place.at_least(4.0, a, d);
    place.at_least(1.0, place.at_least(2.0, place.at_least(3.0, late, c), b), a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::UNIT_ROUNDOFF;

    #[test]
    fn turns_are_those_of_the_library() {
        let count = 400_000;
        for i in 0..=count {
            let u = f64::from(i) / f64::from(count);
            let (c, s) = cos_sin_of_turns(u);
            // The remainder is exact, so that the library's own argument is rounded as little as ours.
            let quarter = (4.0 * u + 0.5).floor();
            let rest = (4.0 * u - quarter) * std::f64::consts::FRAC_PI_2;
            let (cosine, sine) = (libm::cos(rest), libm::sin(rest));
            let expected = match quarter as u32 % 4 {
                0 => (cosine, sine),
                1 => (-sine, cosine),
                2 => (-cosine, -sine),
                _ => (sine, -cosine),
            };
            let near = |a: f64, b: f64| (a - b).abs() <= 3.0 * UNIT_ROUNDOFF * b.abs();
            assert!(near(c, expected.0) && near(s, expected.1), "{u}: {c} {s} for {expected:?}");
            assert!((c * c + s * s - 1.0).abs() <= 4.0 * UNIT_ROUNDOFF);
        }
    }

    #[test]
    fn quarter_turns_are_exact() {
        let expected = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0), (1.0, 0.0)];
        for (quarters, expected) in expected.into_iter().enumerate() {
            assert_eq!(cos_sin_of_turns(quarters as f64 / 4.0), expected);
        }
    }
}
