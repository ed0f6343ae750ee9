//! Queues of paths, in rows of up to eight that a stage processes at once.
//!
//! No row has two paths of one sample. So the branches of a sample are processed one after the other, in an order that
//! depends on the sample alone, whichever samples share its wave.

use super::wavefront::WAVE;
use std::iter::once;

/// Indices of paths that a stage has yet to process.
#[derive(Clone, Debug, Default)]
pub struct PathQueue {
    paths: Vec<u32>,
    /// Where rows end besides every eighth path and the end: before the next branches of the same samples.
    cuts: Vec<usize>,
}

impl PathQueue {
    pub fn clear(&mut self) {
        self.paths.clear();
        self.cuts.clear();
    }

    pub fn push(&mut self, path: u32) {
        self.paths.push(path);
    }

    pub fn is_empty(&self) -> bool {
        self.paths.is_empty()
    }

    /// The rows, in their order. The paths of a row ascend.
    pub fn rows(&self) -> impl Iterator<Item = &[u32]> {
        let starts = once(0).chain(self.cuts.iter().copied());
        let ends = self.cuts.iter().copied().chain(once(self.paths.len()));
        starts.zip(ends).flat_map(|(start, end)| self.paths[start..end].chunks(8))
    }

    /// Separates paths of the same sample: first come the first paths of all samples, then the second ones, and so on.
    /// `slots` holds the slot of each path.
    pub fn separate(&mut self, slots: &[u32], ranks: &mut Ranks) {
        let Ranks { counts, sorted, ends } = ranks;
        let slot = |path: u32| slots[path as usize] as usize;
        counts.resize(WAVE, 0);
        ends.clear();
        for &path in &self.paths {
            let rank = counts[slot(path)] as usize;
            counts[slot(path)] += 1;
            if rank == ends.len() {
                ends.push(0);
            }
            ends[rank] += 1;
        }
        self.paths.iter().for_each(|path| counts[slot(*path)] = 0);
        if ends.len() < 2 {
            return;
        }
        // From numbers of paths to the place of the first one of each rank.
        let mut place = 0;
        for end in ends.iter_mut() {
            place += std::mem::replace(end, place);
        }
        self.cuts.extend_from_slice(&ends[1..]);
        sorted.clear();
        sorted.resize(self.paths.len(), 0);
        for &path in &self.paths {
            let count = &mut counts[slot(path)];
            let end = &mut ends[*count as usize];
            sorted[*end] = path;
            (*count, *end) = (*count + 1, *end + 1);
        }
        self.paths.iter().for_each(|path| counts[slot(*path)] = 0);
        std::mem::swap(&mut self.paths, sorted);
    }
}

/// Memory for [`PathQueue::separate`].
#[derive(Clone, Debug, Default)]
pub struct Ranks {
    /// For each sample, the number of its paths so far; 0 between queues.
    counts: Vec<u32>,
    sorted: Vec<u32>,
    ends: Vec<usize>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_have_one_path_of_a_sample() {
        let slots = [0, 0, 1, 2, 2, 2, 3, 4, 5, 6, 7, 8, 9, 9];
        let mut queue = PathQueue::default();
        (0..14).for_each(|path| queue.push(path));
        let mut ranks = Ranks::default();
        // The second time finds clean memory.
        for _ in 0..2 {
            let mut separated = queue.clone();
            separated.separate(&slots, &mut ranks);
            let rows: Vec<&[u32]> = separated.rows().collect();
            assert_eq!(rows, [&[0, 2, 3, 6, 7, 8, 9, 10][..], &[11, 12], &[1, 4, 13], &[5]]);
        }
        let rows: Vec<&[u32]> = queue.rows().collect();
        assert_eq!(rows, [&[0, 1, 2, 3, 4, 5, 6, 7][..], &[8, 9, 10, 11, 12, 13]]);
        queue.clear();
        assert!(queue.is_empty() && queue.rows().next().is_none());
    }
}
