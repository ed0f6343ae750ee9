//! The start times of frames, in the units of formats that cannot store exact fractions.

use crate::base::time::Rate;

/// The start of the frame of index k, in units of 1/`per_second` s, rounded half up: floor((2·per_second·k·den + num) /
/// (2·num)). Starts are rounded instead of durations, so that errors do not accumulate.
pub fn ticks(index: usize, rate: Rate, per_second: i128) -> i128 {
    let (num, den) = (rate.per_second().numer().to_owned(), rate.per_second().denom().to_owned());
    (2 * per_second * index as i128 * den + num) / (2 * num)
}

/// The duration of the frame of index k, in units of 1/`per_second` s.
pub fn duration(index: usize, rate: Rate, per_second: i128) -> i128 {
    ticks(index + 1, rate, per_second) - ticks(index, rate, per_second)
}

/// The duration of the frame of index k in seconds, as a fraction of two 16-bit numbers. It is exact if the rate's own
/// fraction fits into 16 bits. Otherwise it is rounded to 1/10 000 s, and errors do not accumulate.
pub fn fraction(index: usize, rate: Rate) -> (u16, u16) {
    let rate_parts = (*rate.per_second().denom(), *rate.per_second().numer());
    if let (Ok(seconds), Ok(frames)) = (u16::try_from(rate_parts.0), u16::try_from(rate_parts.1)) {
        return (seconds, frames);
    }
    const FINE: u16 = 10_000;
    match u16::try_from(duration(index, rate, FINE.into())) {
        Ok(duration) => (duration, FINE),
        // Durations of more than six seconds are rounded to whole seconds and clamped.
        Err(_) => (u16::try_from(duration(index, rate, 1)).unwrap_or(u16::MAX), 1),
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
        let durations: Vec<i128> = (0..6).map(|k| duration(k, rate(24, 1), 1000)).collect();
        assert_eq!(durations, [42, 41, 42, 42, 41, 42]);
        assert_eq!(ticks(24, rate(24, 1), 1000), 1000);
    }
}
