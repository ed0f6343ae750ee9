//! Shards: parts of a run for several processes. `2/4` is the second of four.

use std::fmt;
use std::num::NonZeroU32;
use std::str::FromStr;

/// The maximum number of shards of a run.
const MAX: u32 = 1_000_000;

/// Shard `number` of `count`, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    number: NonZeroU32,
    count: NonZeroU32,
}

impl Shard {
    /// The frames of this shard. Every frame belongs to exactly one shard, and the sizes of shards differ by at most
    /// one frame. The frames of a shard are consecutive, so that work shared by neighbours is done once.
    pub fn of(self, frames: &[u32]) -> &[u32] {
        let end =
            |number: u32| (frames.len() as u64 * u64::from(number) / u64::from(self.count.get())) as usize;
        frames.get(end(self.number.get() - 1)..end(self.number.get())).unwrap_or(&[])
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let whole = |digits: &str| {
            let plain = digits.bytes().all(|byte| byte.is_ascii_digit());
            digits.parse::<NonZeroU32>().ok().filter(|_| plain)
        };
        let parts = text.split_once('/').and_then(|(number, count)| Some((whole(number)?, whole(count)?)));
        match parts {
            Some((number, count)) if number <= count && count.get() <= MAX => Ok(Self { number, count }),
            _ => Err(format!(
                "write NUMBER/COUNT, such as 2/4 for the second of four; both count from 1, and COUNT is at most {MAX}"
            )),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_frame_is_in_one_shard() {
        for (frames, count) in [(0u32, 3u32), (1, 3), (7, 3), (48, 5), (48, 48), (5, 8)] {
            let frames: Vec<u32> = (0..frames).map(|frame| 2 * frame).collect();
            let shards: Vec<&[u32]> = (1..=count)
                .map(|number| format!("{number}/{count}").parse::<Shard>().expect("a shard").of(&frames))
                .collect();
            assert_eq!(shards.concat(), frames);
            let sizes = || shards.iter().map(|shard| shard.len());
            assert!(sizes().max() <= sizes().min().map(|least| least + 1), "{shards:?}");
        }
    }

    #[test]
    fn errors_suggest_a_correction() {
        for text in
            ["", "2", "0/4", "5/4", "1/0", "-1/4", "+1/4", "1/+4", "1/2/3", "a/b", "1/1000001", "1 / 4"]
        {
            let message = text.parse::<Shard>().expect_err(text);
            assert!(message.contains("such as 2/4"), "{message}");
        }
        assert_eq!("2/4".parse::<Shard>().expect("a shard").to_string(), "2/4");
    }
}
