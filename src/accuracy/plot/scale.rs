//! Ranges and ticks of logarithmic axes.

use std::ops::Range;

/// A range from slightly below the smallest to slightly above the largest value, of at least half a decade.
pub fn range(values: impl Iterator<Item = f64>) -> Range<f64> {
    let positive = values.filter(|value| *value > 0.0 && value.is_finite());
    let (low, high) =
        positive.fold((f64::INFINITY, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    if high == 0.0 {
        return 0.1..1.0;
    }
    let widened = (libm::sqrt(10.0) / (high / low)).max(1.0).sqrt();
    low / widened / 1.25..high * widened * 1.25
}

/// The labelled values of an axis: powers of ten, with 2 and 5 times these if the range is at most four decades.
pub fn ticks(range: &Range<f64>) -> Vec<f64> {
    let decades = libm::log10(range.end / range.start);
    let steps: &[f64] = if decades > 4.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
    let first = libm::log10(range.start).floor() as i32;
    let last = libm::log10(range.end).ceil() as i32;
    let all =
        (first..=last).flat_map(|power| steps.iter().map(move |step| step * libm::exp10(f64::from(power))));
    all.filter(|value| range.contains(value)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers_within() {
        let ticks = ticks(&(0.03..3.0));
        let wanted = [0.05, 0.1, 0.2, 0.5, 1.0, 2.0];
        assert_eq!(ticks.len(), wanted.len());
        assert!(
            ticks.iter().zip(wanted).all(|(tick, wanted)| (tick / wanted - 1.0).abs() < 1e-12),
            "{ticks:?}"
        );
    }

    #[test]
    fn ranges_hold_their_values_and_are_never_empty() {
        for values in [vec![1.0, 1000.0], vec![2.0], vec![], vec![0.0, -1.0, f64::INFINITY]] {
            let range = range(values.iter().copied());
            assert!(range.start > 0.0 && range.end > range.start, "{values:?} {range:?}");
            assert!(values.iter().filter(|v| **v > 0.0 && v.is_finite()).all(|v| range.contains(v)));
            assert!(ticks(&range).len() > 1, "{range:?}");
        }
    }
}
