//! How numbers of the frame are written into text.

/// The digits of a number: `.3`, `+.1`, `6.2` or `03`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NumberFormat {
    /// Whether positive numbers have a sign.
    signed: bool,
    /// Whether missing digits are zeros, not blanks.
    zeros: bool,
    /// The least number of characters.
    width: usize,
    decimals: Option<usize>,
}

/// The largest width, and number of decimals.
const MAX_WIDTH: usize = 40;
const MAX_DECIMALS: usize = 12;
/// The decimals of numbers without a format.
const DEFAULT_DECIMALS: usize = 2;

impl NumberFormat {
    /// A number of decimals.
    pub fn decimals(decimals: usize) -> Self {
        Self { decimals: Some(decimals), ..Self::default() }
    }

    /// The same format with a number of decimals, if it has none of its own.
    pub fn or_decimals(self, decimals: usize) -> Self {
        Self { decimals: self.decimals.or(Some(decimals)), ..self }
    }

    /// Parses a format. None if it is not one.
    pub fn parse(text: &str) -> Option<Self> {
        let (signed, rest) = text.strip_prefix('+').map_or((false, text), |rest| (true, rest));
        let (width, decimals) = match rest.split_once('.') {
            Some((width, decimals)) => (width, Some(decimals.parse().ok()?)),
            None => (rest, None),
        };
        let digits = width.bytes().all(|byte| byte.is_ascii_digit());
        let zeros = width.starts_with('0');
        let width = if width.is_empty() { 0 } else { width.parse().ok()? };
        let fits = digits && width <= MAX_WIDTH && decimals.unwrap_or(0) <= MAX_DECIMALS;
        fits.then_some(Self { signed, zeros, width, decimals })
    }

    /// Writes a number, rounded to the decimals.
    pub fn write(self, value: f64) -> String {
        let decimals = self.decimals.unwrap_or(DEFAULT_DECIMALS);
        let digits = format!("{:.decimals$}", value.abs());
        // What rounds to 0 has no sign.
        let is_zero = digits.bytes().all(|byte| matches!(byte, b'0' | b'.'));
        let sign = match (value < 0.0 && !is_zero, self.signed) {
            // A minus sign is as wide as a plus sign; a hyphen is not.
            (true, _) => "−",
            (false, true) => "+",
            (false, false) => "",
        };
        let missing = self.width.saturating_sub(digits.chars().count() + sign.chars().count());
        match self.zeros {
            true => format!("{sign}{}{digits}", "0".repeat(missing)),
            // Blanks as wide as digits.
            false => format!("{}{sign}{digits}", "\u{2007}".repeat(missing)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_are_asked_for() {
        let written = |format: &str, value| NumberFormat::parse(format).map(|format| format.write(value));
        for (format, value, expected) in [
            ("", 1.0, "1.00"),
            (".1", -2.25, "−2.2"),
            ("+.1", 2.25, "+2.2"),
            (".0", -0.4, "0"),
            ("04.0", 7.0, "0007"),
            ("5.1", 7.0, "\u{2007}\u{2007}7.0"),
            ("+.2", 0.0, "+0.00"),
        ] {
            assert_eq!(written(format, value).as_deref(), Some(expected), "{format} {value}");
        }
        for format in ["x", ".", ".99", "-3", "1.2.3", "99"] {
            assert_eq!(NumberFormat::parse(format), None, "{format}");
        }
    }
}
