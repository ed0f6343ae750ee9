//! When frames start, in the units of formats that cannot say it as a fraction.

use crate::base::time::Rate;

/// The start of the frame of index k, in units of which a second has `per_second`, rounded half up:
/// floor((2·per_second·k·den + num) / (2·num)). Starts are rounded and not lengths, so that errors never add up.
pub fn ticks(index: usize, rate: Rate, per_second: i128) -> i128 {
    let (num, den) = (rate.per_second().numer().to_owned(), rate.per_second().denom().to_owned());
    (2 * per_second * index as i128 * den + num) / (2 * num)
}

/// How many units the frame of index k stays.
pub fn length(index: usize, rate: Rate, per_second: i128) -> i128 {
    ticks(index + 1, rate, per_second) - ticks(index, rate, per_second)
}

/// How long the frame of index k stays, in seconds as a fraction of two 16-bit numbers: exactly, for all rates
/// whose own fraction has such numbers. Others are rounded to 1/10 000 s without errors that add up.
pub fn fraction(index: usize, rate: Rate) -> (u16, u16) {
    let rate_parts = (*rate.per_second().denom(), *rate.per_second().numer());
    if let (Ok(seconds), Ok(frames)) = (u16::try_from(rate_parts.0), u16::try_from(rate_parts.1)) {
        return (seconds, frames);
    }
    const FINE: u16 = 10_000;
    match u16::try_from(length(index, rate, FINE.into())) {
        Ok(length) => (length, FINE),
        // Longer than six seconds: whole seconds are near enough, as far as they go.
        Err(_) => (u16::try_from(length(index, rate, 1)).unwrap_or(u16::MAX), 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rate(frames: i128, seconds: i128) -> Rate {
        Rate::new(frames, seconds).expect("a rate")
    }

    #[test]
    fn usual_rates_are_exact_fractions() {
        for (frames, seconds) in [(24, 1), (30_000, 1001), (2997, 100), (1, 3), (65_535, 1)] {
            assert_eq!(fraction(7, rate(frames, seconds)), (seconds as u16, frames as u16));
        }
    }

    #[test]
    fn other_rates_do_not_drift() {
        let odd = rate(23_976_001, 1_000_000);
        let sum: i128 = (0..1000).map(|k| i128::from(fraction(k, odd).0)).sum();
        assert_eq!(sum, ticks(1000, odd, 10_000));
        assert_eq!(fraction(0, rate(1, 100_000)), (65_535, 1));
        assert_eq!(fraction(0, rate(100_001, 1_000_000)), (10, 1));
    }

    #[test]
    fn milliseconds_add_up() {
        let lengths: Vec<i128> = (0..6).map(|k| length(k, rate(24, 1), 1000)).collect();
        assert_eq!(lengths, [42, 41, 42, 42, 41, 42]);
        assert_eq!(ticks(24, rate(24, 1), 1000), 1000);
    }
}
