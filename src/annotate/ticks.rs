//! Ticks at round numbers.

use crate::appearance::texture::DataScale;

/// A round number of a range.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    pub value: f64,
    /// The place within the range, 0..=1.
    pub share: f64,
    pub label: String,
}

/// The largest power of ten that is written with zeros, and the smallest.
const PLAIN: std::ops::Range<i32> = -4..5;
/// Decades from one tick to the next.
const DECADES: [usize; 9] = [1, 2, 5, 10, 20, 50, 100, 200, 500];
/// Ticks on one axis at most.
const MAX_TICKS: usize = 100;

/// Up to `most` round numbers from `low` to `high`; at least one if that is possible.
pub fn ticks(scale: DataScale, [low, high]: [f64; 2], most: usize) -> Vec<Tick> {
    let most = most.clamp(1, MAX_TICKS);
    if low == high || !(high - low).is_finite() {
        let label = shortest(low);
        return vec![Tick { value: low, share: 0.0, label }];
    }
    let numbers = match scale {
        DataScale::Linear => linear(low, high, most),
        DataScale::Log => decades(low, high, most).unwrap_or_else(|| linear(low, high, most)),
    };
    let share = |value: f64| scale.share(value, [low, high]);
    numbers.into_iter().map(|(value, label)| Tick { value, share: share(value), label }).collect()
}

/// As many round numbers as have room beside each other on an axis of a length, in pixels: `extent` is what a label needs.
pub fn spaced_ticks(
    (scale, range): (DataScale, [f64; 2]),
    most: usize,
    length: f64,
    extent: impl Fn(&str) -> f64,
) -> Vec<Tick> {
    let mut count = most;
    loop {
        let ticks = ticks(scale, range, count);
        let ends = |tick: &Tick| {
            let (middle, half) = (tick.share * length, 0.5 * extent(&tick.label));
            (middle - half, middle + half)
        };
        if count <= 1 || ticks.array_windows().all(|[a, b]| ends(a).1 <= ends(b).0) {
            return ticks;
        }
        count -= 1;
    }
}

/// A range that ends at round numbers, for charts.
pub fn rounded_range([low, high]: [f64; 2], most: usize) -> [f64; 2] {
    let span = high - low;
    if span <= 0.0 || !span.is_finite() {
        let around = if low == 0.0 { 1.0 } else { low.abs() * 0.5 };
        return [low - around, high + around];
    }
    let (step, exponent) = round_step(low, high, most.max(1));
    let count = |value: f64| value / decimal(step, exponent);
    [decimal(step * count(low).floor() as i64, exponent), decimal(step * count(high).ceil() as i64, exponent)]
}

/// `mantissa` times ten to the power of `exponent`, correctly rounded.
fn decimal(mantissa: i64, exponent: i32) -> f64 {
    format!("{mantissa}e{exponent}").parse().unwrap_or(f64::NAN)
}

/// The largest exponent of ten whose power is at most a number above 0.
fn exponent_of(value: f64) -> i32 {
    let text = format!("{value:e}");
    text.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0)
}

/// A step of 1, 2 or 5 times a power of ten, of which at most `most` fit: the factor and the exponent.
fn round_step(low: f64, high: f64, most: usize) -> (i64, i32) {
    let least = (high - low) / most as f64;
    let exponent = exponent_of(least);
    let fits = |(factor, exponent): &(i64, i32)| {
        let step = decimal(*factor, *exponent);
        (high / step).floor() - (low / step).ceil() + 1.0 <= most as f64
    };
    let steps = (exponent..).flat_map(|exponent| [1, 2, 5].map(|factor| (factor, exponent)));
    steps.take(30).find(fits).unwrap_or((1, exponent + 10))
}

fn linear(low: f64, high: f64, most: usize) -> Vec<(f64, String)> {
    // A narrow range may lie between two round numbers. Then one of the next finer ones will do.
    let finer =
        (most..most + 10).map(|count| multiples(low, high, count)).find(|numbers| !numbers.is_empty());
    let mut numbers = finer.unwrap_or_default();
    if numbers.len() > most {
        numbers = vec![numbers.swap_remove((numbers.len() - 1) / 2)];
    }
    numbers
}

/// The multiples within a range of a round step of which at most `most` fit.
fn multiples(low: f64, high: f64, most: usize) -> Vec<(f64, String)> {
    let (factor, exponent) = round_step(low, high, most);
    let step = decimal(factor, exponent);
    // Quotients are rounded, so the numbers decide which are within the range.
    let (first, last) = ((low / step).floor() as i64 - 1, (high / step).ceil() as i64 + 1);
    let numbers = (first..=last).map(|count| count * factor);
    let numbers = numbers.filter(|count| (low..=high).contains(&decimal(*count, exponent)));
    let largest = exponent_of(low.abs().max(high.abs()));
    numbers.map(|count| (decimal(count, exponent) + 0.0, written(count, exponent, largest))).collect()
}

/// `count` · 10^`exponent` in a list of numbers up to about 10^`largest`.
fn written(count: i64, exponent: i32, largest: i32) -> String {
    let sign = if count < 0 { "−" } else { "" };
    let size = count.unsigned_abs();
    if size == 0 {
        return "0".to_owned();
    }
    let moved = if PLAIN.contains(&largest) { 0 } else { largest };
    let decimals = (moved - exponent).max(0) as usize;
    let zeros = (exponent - moved).max(0) as usize;
    let digits = format!("{size}{}", "0".repeat(zeros));
    let digits = format!("{digits:0>width$}", width = decimals + 1);
    let (whole, fraction) = digits.split_at(digits.len() - decimals);
    let point = if decimals > 0 { "." } else { "" };
    let power = if moved == 0 { String::new() } else { format!("·10{}", raised(moved)) };
    format!("{sign}{whole}{point}{fraction}{power}")
}

/// Powers of ten, and if these are few, their multiples of 2 and 5. None if the range has less than one of each.
fn decades(low: f64, high: f64, most: usize) -> Option<Vec<(f64, String)>> {
    let (first, last) = (exponent_of(low), exponent_of(high));
    let within = |value: &f64| (low..=high).contains(value);
    let powers: Vec<i32> = (first..=last).filter(|exponent| within(&decimal(1, *exponent))).collect();
    let label = |factor: i64, exponent: i32| match PLAIN.contains(&exponent) {
        true => written(factor, exponent, exponent),
        false if factor == 1 => format!("10{}", raised(exponent)),
        false => format!("{factor}·10{}", raised(exponent)),
    };
    if powers.len() >= 2 {
        // Multiples of a round number of decades, if two of them are within the range.
        let needed = powers.len().div_ceil(most);
        let every = DECADES.into_iter().find(|every| *every >= needed).unwrap_or(needed);
        let round = powers.iter().copied().filter(|exponent| exponent.rem_euclid(every as i32) == 0);
        let round: Vec<i32> = round.collect();
        let chosen = if round.len() >= 2 { round } else { powers.into_iter().step_by(needed).collect() };
        return Some(chosen.into_iter().map(|e| (decimal(1, e), label(1, e))).collect());
    }
    let parts = (first..=last).flat_map(|exponent| [1, 2, 5].map(|factor| (factor, exponent)));
    let parts: Vec<_> = parts.filter(|(factor, exponent)| within(&decimal(*factor, *exponent))).collect();
    let every = parts.len().div_ceil(most).max(1);
    let tick = |(factor, exponent): (i64, i32)| (decimal(factor, exponent), label(factor, exponent));
    (parts.len() >= 2).then(|| parts.into_iter().step_by(every).map(tick).collect())
}

/// A number in superscript digits.
fn raised(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let sign = if exponent < 0 { "⁻" } else { "" };
    let digit = |byte: u8| DIGITS[usize::from(byte - b'0') % 10];
    format!("{sign}{}", exponent.unsigned_abs().to_string().bytes().map(digit).collect::<String>())
}

/// A number in the fewest digits that tell it from its neighbours of 32 bits.
fn shortest(value: f64) -> String {
    format!("{}", value as f32 + 0.0).replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: DataScale, range: [f64; 2], most: usize) -> Vec<String> {
        ticks(scale, range, most).into_iter().map(|tick| tick.label).collect()
    }

    #[test]
    fn ticks_are_round_numbers_with_both_ends() {
        let linear = |low, high, most| labels(DataScale::Linear, [low, high], most);
        assert_eq!(linear(0.0, 0.3, 5), ["0.0", "0.1", "0.2", "0.3"].map(|s| s.replace("0.0", "0")));
        assert_eq!(linear(-1.0, 1.0, 5), ["−1.0", "−0.5", "0", "0.5", "1.0"]);
        assert_eq!(linear(0.0, 100.0, 6), ["0", "20", "40", "60", "80", "100"]);
        assert_eq!(linear(1.0e6, 3.0e6, 3), ["1·10⁶", "2·10⁶", "3·10⁶"]);
        assert_eq!(linear(0.0, 2.0e-7, 5), ["0", "0.5·10⁻⁷", "1.0·10⁻⁷", "1.5·10⁻⁷", "2.0·10⁻⁷"]);
        assert_eq!(linear(5.0, 5.0, 5), ["5"]);
        assert_eq!(linear(0.51, 0.54, 1), ["0.52"]);
        for most in 1..12 {
            let count = linear(-3.7, 12.9, most).len();
            assert!((1..=most).contains(&count), "{most}: {count}");
            let narrow = linear(0.512_3, 0.512_4, most).len();
            assert!((1..=most).contains(&narrow), "{most}: {narrow}");
        }
    }

    #[test]
    fn decades_are_ticks_of_logarithms() {
        let log = |low, high, most| labels(DataScale::Log, [low, high], most);
        assert_eq!(log(0.01, 100.0, 9), ["0.01", "0.1", "1", "10", "100"]);
        assert_eq!(log(1e-9, 1e9, 4), ["10⁻⁵", "1", "10⁵"]);
        assert_eq!(log(1.0, 8.0, 9), ["1", "2", "5"]);
        let shares: Vec<f64> =
            ticks(DataScale::Log, [0.01, 100.0], 9).iter().map(|tick| tick.share).collect();
        assert!(shares.iter().zip([0.0, 0.25, 0.5, 0.75, 1.0]).all(|(a, b)| (a - b).abs() < 1e-15));
    }

    #[test]
    fn charts_end_at_round_numbers() {
        assert_eq!(rounded_range([-0.93, 1.02], 4), [-1.0, 1.5]);
        assert_eq!(rounded_range([0.0, 10.0], 5), [0.0, 10.0]);
        assert_eq!(rounded_range([3.0, 3.0], 5), [1.5, 4.5]);
    }
}
