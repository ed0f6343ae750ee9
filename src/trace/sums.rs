//! Samples that are added to the sums of their pixels, without invalid ones.

use crate::base::math::DVec3;
use crate::base::stats::Dropped;

/// What a sample of a layer adds to a sum. An invalid sample is counted and left out, because it would spoil the pixel. In
/// the mean it counts as black.
#[inline]
pub fn valid(sample: DVec3, limit: Option<f64>, dropped: &mut Dropped) -> DVec3 {
    if sample.is_finite() && sample.min_element() >= 0.0 {
        limit.map_or(sample, |limit| sample.min(DVec3::splat(limit)))
    } else {
        count_dropped(sample, dropped);
        DVec3::ZERO
    }
}

#[cold]
fn count_dropped(sample: DVec3, dropped: &mut Dropped) {
    if sample.is_nan() {
        dropped.undefined += 1;
    } else if !sample.is_finite() {
        dropped.infinite += 1;
    } else {
        dropped.negative += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    /// Invalid samples, one in a thousand of each kind, are counted by their cause and do not spoil the pixel. If
    /// validity were tested after averaging, one NaN would spoil the whole pixel.
    #[test]
    fn sa_08_what_is_no_light_is_dropped_and_counted() {
        const SAMPLES: u32 = 1_000_000;
        let bad = [f64::NAN, f64::INFINITY, -1.0, 1e30];
        for limit in [None, Some(10.0)] {
            let (mut random, mut sum, mut dropped) = (Random(8), DVec3::ZERO, Dropped::default());
            let mut injected = [0u64; 4];
            for k in 0..SAMPLES {
                let kind = (1000.0 * random.unit()) as usize;
                let mut sample = DVec3::splat(0.5);
                if kind < 4 {
                    injected[kind] += 1;
                    // In any of the channels.
                    sample[k as usize % 3] = bad[kind];
                }
                sum += valid(sample, limit, &mut dropped);
            }
            let [undefined, infinite, negative, bright] = injected;
            assert!(injected.iter().all(|count| *count > 800));
            assert_eq!(dropped, Dropped { undefined, infinite, negative });
            assert!(sum.is_finite());
            let kept = f64::from(SAMPLES) - (undefined + infinite + negative) as f64;
            let expected = 3.0 * 0.5 * kept + bright as f64 * (limit.unwrap_or(bad[3]) - 0.5);
            assert!((sum.element_sum() / expected - 1.0).abs() < 1e-9, "{sum} with {limit:?}");
        }
        let mut dropped = Dropped::default();
        for sample in [
            DVec3::new(f64::NAN, f64::INFINITY, -1.0),
            DVec3::new(0.0, f64::NEG_INFINITY, 0.0),
            DVec3::new(0.0, -0.0, -1e-300),
        ] {
            assert_eq!(valid(sample, None, &mut dropped), DVec3::ZERO);
        }
        assert_eq!(dropped, Dropped { undefined: 1, infinite: 1, negative: 1 });
    }
}
