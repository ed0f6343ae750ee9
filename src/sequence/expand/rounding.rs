//! Rounds exact fractions to the nearest `f64`.

use num_rational::Ratio;

/// Whole numbers up to this are `f64` without rounding, so the quotient of two is rounded once.
const EXACT: u128 = 1 << 53;

/// Quotients from this on have more bits than an `f64` keeps, with some to spare for the rounding.
const ENOUGH: u128 = 1 << 60;

/// The nearest `f64`; of two that are equally near, the even one. Numerator and denominator are below 2^126.
pub fn nearest(value: &Ratio<i128>) -> f64 {
    let (size, divisor) = (value.numer().unsigned_abs(), value.denom().unsigned_abs());
    if divisor == 1 || size <= EXACT && divisor <= EXACT {
        return *value.numer() as f64 / *value.denom() as f64;
    }
    // Long division in binary, until the quotient has enough bits.
    let (mut quotient, mut rest, mut places) = (size / divisor, size % divisor, 0);
    while quotient < ENOUGH {
        let twice = 2 * rest;
        let bit = twice >= divisor;
        rest = if bit { twice - divisor } else { twice };
        quotient = 2 * quotient + u128::from(bit);
        places += 1;
    }
    // The last bit stands for everything below it, so the conversion rounds as the whole fraction would.
    let rounded = libm::scalbn((quotient | u128::from(rest != 0)) as f64, -places);
    if *value.numer() < 0 { -rounded } else { rounded }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_are_rounded_once() {
        // 9007199254740993 is 2^53 + 1, and rounds to 2^53 before the division.
        assert_eq!(nearest(&Ratio::new(9_007_199_254_740_993, 7)), 1_286_742_750_677_284.8);
        assert_eq!(nearest(&Ratio::new(-9_007_199_254_740_993, 7)), -1_286_742_750_677_284.8);
        assert_eq!(nearest(&Ratio::new(1, 3)), 1.0 / 3.0);
        assert_eq!(nearest(&Ratio::new(0, 1)), 0.0);
        assert_eq!(nearest(&Ratio::new(1, 10i128.pow(30))), 1e-30);
        assert_eq!(nearest(&Ratio::new(10i128.pow(30), 7)), 1e30 / 7.0);
    }

    #[test]
    fn decimals_are_read_as_by_rust() {
        let mut random = crate::testing::Random(11);
        for _ in 0..10_000 {
            let digits = (random.unit() * 1e15) as i128 * 1_000_000_000_000 + (random.unit() * 1e12) as i128;
            let places = (random.unit() * 29.0) as u32;
            let text = format!("{digits}e-{places}");
            assert_eq!(Ok(nearest(&Ratio::new(digits, 10i128.pow(places)))), text.parse(), "{text}");
        }
    }
}
