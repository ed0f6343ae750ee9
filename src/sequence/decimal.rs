//! Decimal numbers as exact fractions.

use crate::base::time::Time;

/// Why a text is not an exact number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotExact {
    /// It is not a decimal number.
    NotDecimal,
    /// It has more decimal places than allowed.
    TooFine,
    TooLarge,
}

/// More digits than any limit allows. Numbers of this length fit into an `i128`.
const MAX_DIGITS: usize = 30;

/// `2.5` becomes 5/2, as does `25e-1`. At most `places` decimal places are allowed, not counting trailing zeros.
pub fn exact(text: &str, places: u32) -> Result<Time, NotExact> {
    let (negative, digits, exponent) = parts(text).ok_or(NotExact::NotDecimal)?;
    let significant = digits.trim_start_matches('0');
    let trimmed = significant.trim_end_matches('0');
    if trimmed.is_empty() {
        return Ok(Time::from_integer(0));
    }
    // The value is `trimmed` · 10^exponent.
    let exponent = exponent.saturating_add((significant.len() - trimmed.len()) as i64);
    if exponent < -i64::from(places) {
        return Err(NotExact::TooFine);
    }
    if exponent > MAX_DIGITS as i64 || trimmed.len() + exponent.max(0) as usize > MAX_DIGITS {
        return Err(NotExact::TooLarge);
    }
    let whole: i128 = trimmed.parse().map_err(|_| NotExact::TooLarge)?;
    let whole = if negative { -whole } else { whole };
    let power = 10i128.pow(exponent.unsigned_abs() as u32);
    Ok(if exponent < 0 { Time::new(whole, power) } else { Time::from_integer(whole * power) })
}

/// Sign, digits, and the power of ten that scales them.
fn parts(text: &str) -> Option<(bool, String, i64)> {
    let text = text.replace('_', "");
    let (negative, rest) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text.strip_prefix('+').unwrap_or(&text)),
    };
    let (mantissa, exponent) = match rest.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, power_of_ten(exponent)?),
        None => (rest, 0),
    };
    let (whole, part) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = format!("{whole}{part}");
    let good = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
    good.then(|| (negative, digits, exponent.saturating_sub(part.len() as i64)))
}

/// Parses an exponent. Exponents beyond all limits are clamped, and stay beyond them.
fn power_of_ten(text: &str) -> Option<i64> {
    let digits = text.strip_prefix(['+', '-']).unwrap_or(text);
    if digits.is_empty() || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let size = digits.parse::<i64>().unwrap_or(i64::MAX / 4).min(i64::MAX / 4);
    Some(if text.starts_with('-') { -size } else { size })
}

/// Whether the text is a decimal number of any size.
pub fn is_decimal(text: &str) -> bool {
    is_plain(text) || parts(text).is_some()
}

/// Whether the text is a number of digits with at most one point and a sign, as most are. Copies nothing.
fn is_plain(text: &str) -> bool {
    let (mut digits, mut points) = (0, 0);
    for byte in text.strip_prefix(['+', '-']).unwrap_or(text).bytes() {
        match byte {
            b'0'..=b'9' => digits += 1,
            b'.' => points += 1,
            _ => return false,
        }
    }
    digits > 0 && points < 2
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The short way to the answer gives that of the long one.
    #[test]
    fn plain_numbers_are_decimal() {
        let mut plain = 0;
        for text in [
            "", ".", "+", "-", "-.", "5", "+5.", "-.5", "0.25", "1.2.3", "--1", "-+1", "1-", "1e5", "1_0",
            "½", "5 ",
        ] {
            assert!(!is_plain(text) || parts(text).is_some(), "{text}");
            assert_eq!(is_decimal(text), parts(text).is_some(), "{text}");
            plain += u32::from(is_plain(text));
        }
        assert_eq!(plain, 4);
    }

    #[test]
    fn decimals_are_exact() {
        for (text, num, den) in [
            ("2.5", 5, 2),
            ("29.97", 2997, 100),
            ("-0.1", -1, 10),
            ("1e3", 1000, 1),
            ("2.50e-1", 1, 4),
            ("1_000", 1000, 1),
            (".5", 1, 2),
            ("5.", 5, 1),
            ("0.000", 0, 1),
            ("1.000000000000000000000", 1, 1),
        ] {
            assert_eq!(exact(text, 9), Ok(Time::new(num, den)), "{text}");
        }
    }

    #[test]
    fn limits_hold() {
        assert_eq!(exact("0.0000000001", 9), Err(NotExact::TooFine));
        assert_eq!(exact("1e-99999999999999999999", 9), Err(NotExact::TooFine));
        assert_eq!(exact("1e99999999999999999999", 9), Err(NotExact::TooLarge));
        assert_eq!(exact("1e31", 9), Err(NotExact::TooLarge));
        for text in ["", "-", "1.2.3", "0x10", "1e", "NaN", "inf", "1u8"] {
            assert_eq!(exact(text, 9), Err(NotExact::NotDecimal), "{text}");
        }
    }
}
