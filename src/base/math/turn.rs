//! Cosine and sine of fractions of a turn, in lanes, for sampling directions.

use crate::base::lanes::{Real, out_of_line};

/// ±1 / n! for even and for odd n ≥ 2: the Taylor coefficients of the cosine and the sine.
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
fn series<F: Real>(coefficients: &[f64; 8], square: F) -> F {
    let [a, b, c, d, e, f, g, h] = *coefficients;
    // Estrin's scheme, because Horner's is one long dependency chain.
    let fourth = square * square;
    let eighth = fourth * fourth;
    let low = (F::splat(a) + F::splat(b) * square) + (F::splat(c) + F::splat(d) * square) * fourth;
    let high = (F::splat(e) + F::splat(f) * square) + (F::splat(g) + F::splat(h) * square) * fourth;
    low + high * eighth
}

/// The cosine and the sine of `r` quarter turns, for r in -1/2..=1/2. The Taylor series go up to the 16th and the
/// 17th power; the remainders are below 2^-58. Both results are within 2 units of roundoff.
#[inline(always)]
pub fn cos_sin_of_quarters<F: Real>(r: F) -> (F, F) {
    let angle = r * F::splat(std::f64::consts::FRAC_PI_2);
    let square = angle * angle;
    let cosine = F::splat(1.0) + square * series(&COSINE, square);
    let sine = angle + angle * (square * series(&SINE, square));
    (cosine, sine)
}

out_of_line! {
    /// The cosine and the sine of `u` turns, for u in 0..=1; exact at every quarter.
    pub fn cos_sin_of_turns<'k, F>(u: F) -> (F, F) {
        let quarters = u * F::splat(4.0);
        let place = quarters + F::splat(0.5);
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        // The nearest quarter. The difference from it is exact.
        let nearest = F::select(one.le(place), one, zero)
            + F::select(F::splat(2.0).le(place), one, zero)
            + F::select(F::splat(3.0).le(place), one, zero)
            + F::select(F::splat(4.0).le(place), one, zero);
        let (c, s) = cos_sin_of_quarters(quarters - nearest);
        (of_quarter(place, [c, -s, -c, s]), of_quarter(place, [s, c, -s, -c]))
    }
}

/// The value for the quarter in which `place` is: a below 1, b below 2, c below 3, d below 4, then a again.
#[inline(always)]
fn of_quarter<F: Real>(place: F, [a, b, c, d]: [F; 4]) -> F {
    let late = F::select(F::splat(4.0).le(place), a, d);
    let second = F::select(F::splat(3.0).le(place), late, c);
    let first = F::select(F::splat(2.0).le(place), second, b);
    F::select(F::splat(1.0).le(place), first, a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::UNIT_ROUNDOFF;

    #[test]
    fn turns_are_those_of_the_library() {
        let count = 400_000;
        for i in 0..=count {
            let u = f64::from(i) / f64::from(count);
            let (c, s) = cos_sin_of_turns(u);
            // The remainder is exact, so the argument for libm is rounded as little as ours.
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
