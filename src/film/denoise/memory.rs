//! Memory that filters use again.
//!
//! The system makes new memory page by page, which takes longer than most steps of a filter need to fill it. So planes
//! give theirs back when they are dropped, and those of the next step and of the next frame have it.

use super::neighbors::Taps;
use std::fmt;
use std::mem::take;
use std::ops::{Deref, DerefMut};
use std::sync::{Arc, Mutex, PoisonError};

/// Memory for the filters of a run. Clones share it.
///
/// Between frames, it holds what the last filter used: `settle` frees the rest.
#[derive(Clone, Default)]
pub struct Memory(Arc<Shelves>);

#[derive(Default)]
struct Shelves {
    numbers: Shelf<f32>,
    taps: Shelf<Taps>,
}

/// Memory for one type of entries that nothing uses now.
pub struct Shelf<T>(Mutex<Vec<Free<T>>>);

struct Free<T> {
    data: Vec<T>,
    /// Whether anything has used it since `settle`.
    is_needed: bool,
}

/// Types of entries.
pub trait Entry: Copy + Default {
    /// What unset entries have in tests, which shows if one is read before it is written.
    const UNSET: Self;

    fn shelf(memory: &Memory) -> &Shelf<Self>;
}

impl Entry for f32 {
    const UNSET: Self = Self::NAN;

    fn shelf(memory: &Memory) -> &Shelf<Self> {
        &memory.0.numbers
    }
}

impl Entry for Taps {
    const UNSET: Self = Self { column: 0, row: 0, weights: [f32::NAN; 4], is_still: false };

    fn shelf(memory: &Memory) -> &Shelf<Self> {
        &memory.0.taps
    }
}

impl<T> Default for Shelf<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T: Copy + Default> Shelf<T> {
    /// The least memory for so many entries, without what is far too large.
    fn find(&self, count: usize) -> Option<Vec<T>> {
        let mut all = self.all();
        let sizes = all.iter().map(|free| free.data.len()).enumerate();
        let fitting = sizes.filter(|(_, size)| (count..=2 * count).contains(size));
        let (index, _) = fitting.min_by_key(|(_, size)| *size)?;
        Some(all.swap_remove(index).data)
    }

    fn give_back(&self, data: Vec<T>) {
        self.all().push(Free { data, is_needed: true });
    }

    fn settle(&self) {
        let mut all = self.all();
        all.retain(|free| free.is_needed);
        all.iter_mut().for_each(|free| free.is_needed = false);
    }

    /// A panic elsewhere leaves no entry half done.
    fn all(&self) -> impl DerefMut<Target = Vec<Free<T>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Memory {
    /// Frees what nothing has used since the last call. Called after each frame, it leaves what one frame needs.
    pub(super) fn settle(&self) {
        self.0.numbers.settle();
        self.0.taps.settle();
    }

    /// Zeros.
    pub(super) fn zeros(&self, count: usize) -> Held<f32> {
        let mut held = self.unset(count);
        held.fill(0.0);
        held
    }

    /// Entries of any value, all of which are to be overwritten.
    pub(super) fn unset<T: Entry>(&self, count: usize) -> Held<T> {
        let all = count + margin::<T>();
        let data = T::shelf(self).find(all).unwrap_or_else(|| vec![T::default(); all]);
        let first = data.as_ptr().align_offset(LINE).min(margin::<T>());
        let mut held = Held { data, first, count, memory: self.clone() };
        if cfg!(test) {
            held.fill(T::UNSET);
        }
        held
    }
}

impl fmt::Debug for Memory {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("Memory")
    }
}

/// Bytes of a line of the cache. Lanes that begin at one are read at once.
const LINE: usize = 64;

/// Entries before the first one that begins at a line of the cache, at most.
const fn margin<T>() -> usize {
    if LINE.is_multiple_of(size_of::<T>()) { LINE / size_of::<T>() - 1 } else { 0 }
}

/// Entries in such memory, which gets it back when they are dropped.
pub struct Held<T: Entry> {
    data: Vec<T>,
    first: usize,
    count: usize,
    memory: Memory,
}

impl<T: Entry> Held<T> {
    /// Where others get memory.
    pub fn memory(&self) -> &Memory {
        &self.memory
    }
}

impl<T: Entry> Deref for Held<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        &self.data[self.first..][..self.count]
    }
}

impl<T: Entry> DerefMut for Held<T> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.data[self.first..][..self.count]
    }
}

impl<T: Entry> Drop for Held<T> {
    fn drop(&mut self) {
        T::shelf(&self.memory).give_back(take(&mut self.data));
    }
}

impl<T: Entry + PartialEq> PartialEq for Held<T> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl<T: Entry + fmt::Debug> fmt::Debug for Held<T> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The entries of what is free.
    fn free(memory: &Memory) -> Vec<usize> {
        memory.0.numbers.all().iter().map(|free| free.data.len()).collect()
    }

    #[test]
    fn memory_is_used_again() {
        let memory = Memory::default();
        let mut first = memory.zeros(100);
        first.fill(1.0);
        let (_second, address) = (memory.zeros(100), first.as_ptr());
        drop(first);
        assert_eq!(free(&memory), [115]);
        let again = memory.zeros(60);
        assert_eq!((again.as_ptr(), again.len()), (address, 60));
        assert!(again.iter().all(|number| *number == 0.0));
        drop(again);
        // Neither too little nor far too much.
        for count in [101, 40] {
            assert_ne!(memory.unset::<f32>(count).as_ptr(), address);
        }
    }

    #[test]
    fn what_no_frame_needs_is_freed() {
        let memory = Memory::default();
        drop([memory.zeros(10), memory.zeros(100)]);
        memory.settle();
        drop(memory.zeros(10));
        memory.settle();
        assert_eq!(free(&memory), [25]);
    }
}
