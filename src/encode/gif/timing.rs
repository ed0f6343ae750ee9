//! The frames that a GIF shows, and their delays in centiseconds.

use crate::base::time::Rate;
use crate::encode::movie::clock::ticks;
use num_rational::Ratio;

/// A frame that is shown, by its index in the job's list, and its delay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimedFrame {
    pub index: usize,
    /// Centiseconds, at least 2, because viewers play a delay of 1 as 10.
    pub delay: u64,
}

/// The fastest rate whose delays all viewers support, in frames per second.
pub const MAX_RATE: i128 = 50;

/// The longest animation: 100 days. Longer animations are mistakes and would fill the disk.
const MAX_CENTISECONDS: i128 = 100 * 86_400 * 100;

/// The frames that are shown of `frames` frames at `rate`. `None` if the animation would play for more than 100 days.
///
/// The frame of index k starts at c_k = k / rate, rounded half up to centiseconds. So rounding errors do not
/// accumulate: at every frame, the sum of the delays is within half a centisecond of the true time. Above 50 frames per
/// second, the animation is resampled at 50 frames per second over the same duration.
pub fn timed_frames(frames: usize, rate: Rate) -> Option<Vec<TimedFrame>> {
    let start_of = |index: usize| ticks(index, rate, 100);
    let total = start_of(frames);
    if total > MAX_CENTISECONDS {
        return None;
    }
    if rate.per_second() <= Ratio::from_integer(MAX_RATE) {
        let frame = |index| TimedFrame { index, delay: (start_of(index + 1) - start_of(index)) as u64 };
        return Some((0..frames).map(frame).collect());
    }
    // Each delay is 2 cs. The last frame also gets a remaining odd centisecond.
    let count = (total / 2).max(1);
    let frame = |j: i128| {
        let index = (Ratio::new(j, MAX_RATE) * rate.per_second()).floor().to_integer();
        let delay = if j + 1 == count { (total - 2 * j).max(2) } else { 2 };
        TimedFrame { index: (index as usize).min(frames - 1), delay: delay as u64 }
    };
    Some((0..count).map(frame).collect())
}

/// Splits a delay into delays that fit into a GIF. None of them is so short that viewers would lengthen it.
pub fn pieces(total: u64) -> impl Iterator<Item = u16> {
    let count = total.div_ceil(u64::from(u16::MAX)).max(1);
    (0..count).map(move |i| ((i + 1) * total / count - i * total / count) as u16)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn delays(frames: usize, num: i128, den: i128) -> Vec<u64> {
        let rate = Rate::new(num, den).expect("a rate");
        timed_frames(frames, rate).expect("short").iter().map(|frame| frame.delay).collect()
    }

    /// |sum of the delays up to k - 100 (k + 1) / fps| <= 1/2, exactly.
    fn assert_true_to_time(delays: &[u64], num: i128, den: i128) {
        let mut sum = 0;
        for (k, &delay) in delays.iter().enumerate() {
            sum += i128::from(delay);
            assert!(2 * (sum * num - 100 * (k as i128 + 1) * den).abs() <= num, "frame {k}: {sum} cs");
        }
    }

    #[test]
    fn ca_08_delays() {
        let thirty = delays(300, 30, 1);
        assert_eq!(thirty[..6], [3, 4, 3, 3, 4, 3]);
        let twenty_four = delays(240, 24, 1);
        assert_eq!(twenty_four[..9], [4, 4, 5, 4, 4, 4, 4, 4, 5]);
        let sixty = delays(600, 60, 1);
        assert_eq!(sixty, [2; 500]);
        for (delays, fps) in [(thirty, 30), (twenty_four, 24), (sixty, MAX_RATE)] {
            assert_eq!(delays.iter().sum::<u64>(), 1000);
            assert_true_to_time(&delays, fps, 1);
        }
    }

    #[test]
    fn ca_08_fractional_rates_do_not_drift() {
        for (num, den) in [(24_000, 1001), (30_000, 1001), (1, 3), (50, 1), (49, 1), (12_345, 678)] {
            let delays = delays(5000, num, den);
            assert_true_to_time(&delays, num, den);
            assert!(delays.iter().all(|&delay| delay >= 2));
        }
    }

    #[test]
    fn ca_08_fast_rates_are_resampled_over_the_same_time() {
        let shown = timed_frames(60, Rate::new(60, 1).expect("a rate")).expect("short");
        let indices: Vec<_> = shown.iter().map(|frame| frame.index).collect();
        assert_eq!(indices[..7], [0, 1, 2, 3, 4, 6, 7]);
        for (frames, num, den) in [(601, 60, 1), (7, 240, 1), (1001, 60_000, 1001), (3, 51, 1)] {
            let delays = delays(frames, num, den);
            let total = ticks(frames, Rate::new(num, den).expect("a rate"), 100);
            assert_eq!(i128::from(delays.iter().sum::<u64>() as u32), total);
            assert!(delays.iter().all(|&delay| (2..=3).contains(&delay)));
        }
        assert_eq!(delays(1, 1000, 1), [2]);
    }

    #[test]
    fn long_holds_are_split() {
        assert_eq!(delays(2, 1, 1000), [100_000, 100_000]);
        for total in [0, 2, 65_535, 65_536, 100_000, 1_000_001] {
            let pieces: Vec<_> = pieces(total).collect();
            assert_eq!(pieces.iter().map(|&piece| u64::from(piece)).sum::<u64>(), total);
            assert!(total < 2 || pieces.iter().all(|&piece| piece >= 2));
        }
        assert_eq!(timed_frames(1, Rate::new(1, i128::from(u32::MAX)).expect("a rate")), None);
    }
}
