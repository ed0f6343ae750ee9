//! Indices of gathered numbers, and iteration over the lanes of masks.

/// The index of the number that each lane gathers from memory.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(
    any(not(target_arch = "x86_64"), feature = "portable-only"),
    expect(dead_code, reason = "only levels with vector registers distinguish kinds of lookups")
)]
pub struct Lookup {
    pub(super) at: [u32; 8],
    /// The smallest and the largest of the indices.
    pub(super) first: u32,
    pub(super) last: u32,
    /// Whether the indices are consecutive.
    pub(super) is_run: bool,
}

impl Lookup {
    /// From one to eight indices. Lanes beyond them repeat the last index.
    #[inline(always)]
    pub fn new(indices: &[u32]) -> Self {
        let count = indices.len();
        let mut at = [indices[count - 1]; 8];
        if let Ok(all) = indices.try_into() {
            at = all;
        } else {
            at[..count].copy_from_slice(indices);
        }
        // Without branches, for one instruction of all lanes each.
        let (mut first, mut last, mut off) = (at[0], at[0], 0);
        for lane in 0..8 {
            first = first.min(at[lane]);
            last = last.max(at[lane]);
            off |= at[lane] ^ at[0].wrapping_add(lane as u32);
        }
        Self { at, first, last, is_run: off == 0 }
    }

    /// From one to eight indices, each larger than the one before. Lanes beyond them repeat the last index.
    #[inline(always)]
    pub fn ascending(indices: &[u32]) -> Self {
        let count = indices.len();
        let (first, last) = (indices[0], indices[count - 1]);
        debug_assert!(indices.is_sorted_by(|a, b| a < b));
        let mut at = [last; 8];
        match indices.try_into() {
            Ok(all) => at = all,
            Err(_) => at[..count].copy_from_slice(indices),
        }
        Self { at, first, last, is_run: count == 8 && last - first == 7 }
    }

    /// `count` ≥ 1 consecutive indices from `first` on. Lanes beyond them repeat the last index.
    #[inline(always)]
    pub fn run(first: u32, count: usize) -> Self {
        let mut at = [0; 8];
        for (lane, at) in at.iter_mut().enumerate() {
            *at = first + lane.min(count - 1) as u32;
        }
        Self { at, first, last: at[7], is_run: count == 8 }
    }

    #[inline(always)]
    pub fn lane(&self, lane: usize) -> u32 {
        self.at[lane]
    }
}

/// The indices of the set bits, ascending.
#[inline(always)]
pub fn lanes(bits: u32) -> LaneNumbers {
    LaneNumbers(bits)
}

/// An iterator over the indices of set bits.
pub struct LaneNumbers(u32);

impl Iterator for LaneNumbers {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        let lane = self.0.trailing_zeros() as usize & 31;
        self.0 &= self.0 - 1;
        Some(lane)
    }
}
