//! Numbers of expressions: exact fractions as long as possible.

use super::super::decimal::{exact, is_decimal};
use super::rounding::nearest;
use num_rational::Ratio;

/// Decimal places of a literal that are kept exactly.
const MAX_PLACES: u32 = 30;

/// Limit of numerators and denominators of exact numbers. Beyond it, numbers are rounded to `f64`.
const LARGEST_PART: i128 = 10i128.pow(30);

/// Limit of whole numbers that are written without an exponent.
const LARGEST_PLAIN: f64 = 1e15;

/// Smallest absolute value that is written without an exponent.
const SMALLEST_PLAIN: f64 = 1e-5;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Number {
    Exact(Ratio<i128>),
    /// A rounded number; may be infinite or NaN until it is checked.
    Float(f64),
}

impl Number {
    /// A decimal number of the file; `None` for other texts, and for numbers that are too large for an `f64`.
    pub fn parse(text: &str) -> Option<Self> {
        match exact(text, MAX_PLACES) {
            Ok(value) if is_small(&value) => Some(Self::Exact(value)),
            _ if is_decimal(text) => {
                text.replace('_', "").parse().ok().filter(|value: &f64| value.is_finite()).map(Self::Float)
            }
            _ => None,
        }
    }

    pub fn whole(value: i128) -> Self {
        Self::Exact(Ratio::from_integer(value))
    }

    /// The nearest `f64`.
    pub fn to_f64(self) -> f64 {
        match self {
            Self::Exact(value) => nearest(&value),
            Self::Float(value) => value,
        }
    }

    /// The exact fraction, if the number is one.
    pub fn ratio(self) -> Option<Ratio<i128>> {
        match self {
            Self::Exact(value) => Some(value),
            Self::Float(_) => None,
        }
    }

    pub fn is_zero(self) -> bool {
        self.to_f64() == 0.0
    }

    /// The number in the notation of the file. Terminating decimals are exact, other numbers have the shortest text
    /// that reads as the same `f64`.
    pub fn text(self) -> String {
        if let Self::Exact(value) = self
            && let Some(text) = terminating(value)
        {
            return text;
        }
        let value = self.to_f64();
        match value.abs() {
            0.0 => "0".to_owned(),
            size if (SMALLEST_PLAIN..LARGEST_PLAIN).contains(&size) => format!("{value}"),
            _ => format!("{value:e}"),
        }
    }

    /// The result of an exact operation if it exists and is small, otherwise that of a rounded one.
    fn combined(
        self,
        other: Self,
        exact: impl Fn(&Ratio<i128>, &Ratio<i128>) -> Option<Ratio<i128>>,
        float: impl Fn(f64, f64) -> f64,
    ) -> Self {
        let exact = match (self, other) {
            (Self::Exact(a), Self::Exact(b)) => exact(&a, &b).filter(is_small),
            _ => None,
        };
        exact.map_or_else(|| Self::Float(float(self.to_f64(), other.to_f64())), Self::Exact)
    }

    /// The result of a function that maps fractions to fractions.
    pub fn mapped(self, exact: impl Fn(Ratio<i128>) -> Ratio<i128>, float: impl Fn(f64) -> f64) -> Self {
        match self {
            Self::Exact(value) => Self::Exact(exact(value)),
            Self::Float(value) => Self::Float(float(value)),
        }
    }

    pub fn plus(self, other: Self) -> Self {
        self.combined(other, sum, |a, b| a + b)
    }

    pub fn minus(self, other: Self) -> Self {
        self.plus(other.negated())
    }

    pub fn negated(self) -> Self {
        self.mapped(|value| -value, |value| -value)
    }

    pub fn times(self, other: Self) -> Self {
        self.combined(other, product, |a, b| a * b)
    }

    /// A quotient. The divisor is not 0.
    pub fn over(self, other: Self) -> Self {
        self.combined(other, |a, b| product(a, &reciprocal(b)?), |a, b| a / b)
    }

    /// The remainder with the sign of the divisor, which is not 0: from 0 to below the divisor. Exact for exact numbers,
    /// unless their products are too large.
    pub fn modulo(self, divisor: Self) -> Self {
        self.combined(divisor, exact_modulo, float_modulo)
    }

    /// A power; exact for whole exponents, as long as the result is small.
    pub fn power(self, exponent: Self) -> Self {
        /// Larger exponents give results beyond all limits, unless the base is nearly 1.
        const MOST: i128 = 128;
        let exact = || {
            let (base, exponent) = (self.ratio()?, exponent.ratio()?);
            let count = exponent.numer().unsigned_abs();
            if !exponent.is_integer() || count > MOST as u128 {
                return None;
            }
            let base = if *exponent.numer() < 0 { reciprocal(&base)? } else { base };
            (0..count).try_fold(Ratio::from_integer(1), |power, _| product(&power, &base).filter(is_small))
        };
        exact().map_or_else(|| Self::Float(libm::pow(self.to_f64(), exponent.to_f64())), Self::Exact)
    }

    pub fn is_less(self, other: Self) -> bool {
        match (self, other) {
            (Self::Exact(a), Self::Exact(b)) => a < b,
            _ => self.to_f64() < other.to_f64(),
        }
    }
}

fn is_small(value: &Ratio<i128>) -> bool {
    value.numer().abs() <= LARGEST_PART && *value.denom() <= LARGEST_PART
}

fn sum(a: &Ratio<i128>, b: &Ratio<i128>) -> Option<Ratio<i128>> {
    if a.denom() == b.denom() {
        let numerator = a.numer().checked_add(*b.numer())?;
        return Some(reduced(numerator, *a.denom()));
    }
    let left = a.numer().checked_mul(*b.denom())?;
    let right = b.numer().checked_mul(*a.denom())?;
    Some(reduced(left.checked_add(right)?, a.denom().checked_mul(*b.denom())?))
}

fn product(a: &Ratio<i128>, b: &Ratio<i128>) -> Option<Ratio<i128>> {
    Some(reduced(a.numer().checked_mul(*b.numer())?, a.denom().checked_mul(*b.denom())?))
}

fn exact_modulo(a: &Ratio<i128>, b: &Ratio<i128>) -> Option<Ratio<i128>> {
    let (left, right) = (a.numer().checked_mul(*b.denom())?, b.numer().checked_mul(*a.denom())?);
    let rest = left % right;
    let rest = if rest != 0 && (rest < 0) != (right < 0) { rest + right } else { rest };
    Some(reduced(rest, a.denom().checked_mul(*b.denom())?))
}

/// `fmod` is exact. Only the move to the sign of the divisor rounds, and may reach the divisor.
fn float_modulo(a: f64, b: f64) -> f64 {
    let rest = libm::fmod(a, b);
    if rest == 0.0 {
        return 0.0;
    }
    if (rest < 0.0) == (b < 0.0) {
        return rest;
    }
    match rest + b {
        moved if moved != b => moved,
        _ if b > 0.0 => b.next_down(),
        _ => b.next_up(),
    }
}

fn reciprocal(value: &Ratio<i128>) -> Option<Ratio<i128>> {
    (*value.numer() != 0).then(|| value.recip())
}

/// A fraction in lowest terms. The denominator is above 0.
fn reduced(numerator: i128, denominator: i128) -> Ratio<i128> {
    if denominator == 1 { Ratio::from_integer(numerator) } else { Ratio::new(numerator, denominator) }
}

/// The decimal digits of a fraction, if they end and have no exponent.
fn terminating(value: Ratio<i128>) -> Option<String> {
    let (mut rest, mut twos, mut fives) = (*value.denom(), 0u32, 0u32);
    while rest % 2 == 0 {
        (rest, twos) = (rest / 2, twos + 1);
    }
    while rest % 5 == 0 {
        (rest, fives) = (rest / 5, fives + 1);
    }
    let places = twos.max(fives);
    if rest != 1 || places > MAX_PLACES || (*value.numer() / *value.denom()) as f64 >= LARGEST_PLAIN {
        return None;
    }
    let scaled = value.numer().checked_mul(10i128.checked_pow(places)? / value.denom())?;
    if scaled.unsigned_abs() / 10u128.pow(places) >= LARGEST_PLAIN as u128 {
        return None;
    }
    let sign = if scaled < 0 { "-" } else { "" };
    let digits = format!("{:0>1$}", scaled.unsigned_abs(), places as usize + 1);
    let (whole, part) = digits.split_at(digits.len() - places as usize);
    Some(if part.is_empty() { format!("{sign}{whole}") } else { format!("{sign}{whole}.{part}") })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(text: &str) -> Number {
        Number::parse(text).expect(text)
    }

    #[test]
    fn decimals_stay_exact() {
        let tenth = number("0.1");
        assert_eq!(tenth.plus(number("0.2")).text(), "0.3");
        assert_eq!(tenth.times(number("3")).text(), "0.3");
        assert_eq!(number("1").over(number("8")).text(), "0.125");
        assert_eq!(number("-2.50").text(), "-2.5");
        assert_eq!(number("0.05").negated().text(), "-0.05");
        assert_eq!(number("1.1").power(number("3")).text(), "1.331");
        assert_eq!(number("2").power(number("-2")).text(), "0.25");
        assert_eq!(number("1e3").text(), "1000");
        assert_eq!(number("1").over(number("3")).times(number("3")).text(), "1");
    }

    #[test]
    fn other_numbers_are_rounded_once() {
        assert_eq!(number("1").over(number("3")).text(), (1.0f64 / 3.0).to_string());
        assert_eq!(number("1e20").times(number("1e20")).text(), "1e40");
        assert_eq!(number("1e20").text(), "1e20");
        assert_eq!(number("-1e20").text(), "-1e20");
        assert_eq!(number("1e-40").text(), "1e-40");
        assert_eq!(number("2").power(number("0.5")).text(), 2.0f64.sqrt().to_string());
        assert_eq!(Number::Float(-0.0).text(), "0");
        assert_eq!(Number::parse("1.2.3"), None);
    }

    #[test]
    fn literals_are_finite() {
        assert_eq!(Number::parse("1e999"), None);
        assert_eq!(Number::parse("-1e999"), None);
        assert_eq!(Number::parse("1e-999"), Some(Number::Float(0.0)));
    }

    #[test]
    fn remainders_are_below_the_divisor() {
        assert_eq!(number("-7").modulo(number("3")).text(), "2");
        assert_eq!(number("7").modulo(number("-3")).text(), "-2");
        assert_eq!(number("1.7").modulo(number("0.1")).text(), "0");
        assert_eq!(Number::Float(libm::exp2(101.0)).modulo(number("7")).text(), "4");
        let mut random = crate::testing::Random(5);
        let mut float = || (random.unit() - 0.5) * libm::exp10(40.0 * random.unit() - 20.0);
        for _ in 0..10_000 {
            let (a, b) = (float(), float());
            let rest = Number::Float(a).modulo(Number::Float(b)).to_f64();
            assert!(
                if b > 0.0 { (0.0..b).contains(&rest) } else { b < rest && rest <= 0.0 },
                "{a} {b} {rest}"
            );
        }
        for (a, b) in [(1.7, 0.1), (-1e-20, 1.0), (1e-20, -1.0)] {
            let rest = Number::Float(a).modulo(Number::Float(b)).to_f64();
            assert!(rest / b >= 0.0 && rest / b < 1.0, "{a} {b} {rest}");
        }
    }

    #[test]
    fn every_text_reads_as_its_number() {
        let mut random = crate::testing::Random(7);
        for _ in 0..10_000 {
            let value = (random.unit() - 0.5) * libm::exp10(60.0 * random.unit() - 30.0);
            assert_eq!(Number::Float(value).text().parse(), Ok(value));
            let (a, b) = ((random.unit() * 1e6) as i128 - 500_000, 1 + (random.unit() * 1e4) as i128);
            let ratio = Number::whole(a).over(Number::whole(b));
            assert_eq!(ratio.text().parse(), Ok(a as f64 / b as f64), "{a}/{b}");
        }
    }
}
