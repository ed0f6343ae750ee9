//! Times of keys as exact fractions.
//!
//! A file holds the time of frame 7 at 24 frames per second as the float nearest to 7/24, which is before or after the
//! frame. A key must take effect in its frame, so the fraction is found again: of all numbers that round to the float,
//! the time of a frame at a usual rate, or else the one with the smallest denominator.

use crate::base::time::Time;

/// The latest time in seconds.
const LATEST: f32 = 1e9;

/// The largest denominator. Other times are rounded to billionths of a second, as those of sequences are.
const FINEST: i128 = 1_000_000_000;

/// Frames per second at which the usual whole rates have frames: 24, 25, 30, 48, 50, 60, 100, 120 and 240.
const WHOLE: i128 = 1200;

/// Frames in 1001 seconds at the fastest rate of television. Its frames include those of the slower rates.
const TELEVISION: i128 = 120_000;

/// Times below this, in seconds, are rounded.
const SHORT: f32 = 1e-6;

/// The fraction that a float of a file stands for. None unless it is from 0 to 1e9.
pub fn exact_time(seconds: f32) -> Option<Time> {
    if !(0.0..=LATEST).contains(&seconds) {
        return None;
    }
    if seconds < SHORT {
        return Some(rounded(seconds));
    }
    let [below, at, above] = [seconds.next_down(), seconds, seconds.next_up()].map(fraction);
    let two = Time::from_integer(2);
    let (low, high) = ((below + at) / two, (at + above) / two);
    let usual = [Time::from_integer(WHOLE), Time::new(TELEVISION, 1001)];
    if let Some(time) = usual.into_iter().find_map(|rate| frame_between(low, high, rate)) {
        return Some(time);
    }
    let simplest = simplest_between(low, high);
    Some(if *simplest.denom() <= FINEST { simplest } else { rounded(seconds) })
}

/// The time of a frame at a rate, in an open interval.
fn frame_between(low: Time, high: Time, rate: Time) -> Option<Time> {
    let time = (high * rate).floor() / rate;
    (low < time && time < high).then_some(time)
}

fn rounded(seconds: f32) -> Time {
    Time::new((f64::from(seconds) * 1e9).round() as i128, FINEST)
}

/// A float of at least half of [`SHORT`] and at most twice [`LATEST`] as a fraction. Its last bit is at least 2⁻⁴⁵.
fn fraction(value: f32) -> Time {
    const BITS: u32 = 45;
    let scale = (1i128 << BITS) as f64;
    Time::new((f64::from(value) * scale) as i128, 1 << BITS)
}

/// The fraction of the smallest denominator in an open interval of positive numbers, by continued fractions.
fn simplest_between(low: Time, high: Time) -> Time {
    let floor = low.floor();
    let next = floor + Time::from_integer(1);
    if next < high {
        return next;
    }
    let (low, high) = (low - floor, high - floor);
    let rest = match low == Time::from_integer(0) {
        // Any number above 1 / high will do.
        true => high.recip().floor() + Time::from_integer(1),
        false => simplest_between(high.recip(), low.recip()),
    };
    floor + rest.recip()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    #[test]
    fn times_of_frames_are_found_again() {
        for (rate, of) in [(24, 1), (25, 1), (30, 1), (50, 1), (60, 1), (30000, 1001), (24000, 1001)] {
            // Ten minutes at most: later, floats of seconds are too far apart for 1001 of them.
            for frame in 0..(if of == 1 { 14_400 } else { 300 }) {
                let exact = Time::new(frame * of, rate);
                let float = (*exact.numer() as f64 / *exact.denom() as f64) as f32;
                assert_eq!(exact_time(float), Some(exact), "frame {frame} at {rate}/{of}");
            }
        }
    }

    #[test]
    fn other_times_stay_within_their_float() {
        let mut random = Random(3);
        for _ in 0..20_000 {
            let seconds = libm::exp2(-19.0 + 48.0 * random.unit()) as f32;
            let time = exact_time(seconds).expect("a time");
            let value = *time.numer() as f64 / *time.denom() as f64;
            assert!(
                (value - f64::from(seconds)).abs() <= 0.5e-9f64.max(f64::from(seconds) * 6e-8),
                "{seconds}"
            );
            assert!(exact_time(seconds.next_up()).expect("a time") > time, "{seconds}");
        }
        assert_eq!(exact_time(0.0), Some(Time::from_integer(0)));
        assert_eq!([-1.0, f32::NAN, 1.1e9, f32::INFINITY].map(exact_time), [None; 4]);
    }
}
