//! What is in the leaves of a tree.

/// The things of leaves, by the order in which they were given, one leaf after the other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Contents {
    things: Vec<u32>,
    /// Where the things of each leaf end.
    ends: Vec<u32>,
}

impl Contents {
    /// Leaves.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The things of a leaf, each once, the first one first.
    #[inline(always)]
    pub fn leaf(&self, leaf: u32) -> &[u32] {
        let leaf = leaf as usize;
        let begin = leaf.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.things[begin as usize..self.ends[leaf] as usize]
    }

    /// Nothing yet, with room for so many things.
    pub(super) fn with_capacity(things: usize) -> Self {
        Self { things: Vec::with_capacity(things), ends: Vec::new() }
    }

    pub(super) fn shrink_to_fit(&mut self) {
        self.things.shrink_to_fit();
        self.ends.shrink_to_fit();
    }

    /// One more leaf; gives its number.
    pub(super) fn push(&mut self, things: impl Iterator<Item = u32>) -> u32 {
        let begin = self.things.len();
        self.things.extend(things);
        self.things[begin..].sort_unstable();
        let mut kept = begin;
        for at in begin..self.things.len() {
            if at == begin || self.things[at] != self.things[kept - 1] {
                self.things[kept] = self.things[at];
                kept += 1;
            }
        }
        self.things.truncate(kept);
        self.ends.push(kept as u32);
        self.ends.len() as u32 - 1
    }

    /// The leaves of others behind these.
    pub(super) fn append(&mut self, others: Self) {
        let before = self.things.len() as u32;
        self.things.extend_from_slice(&others.things);
        self.ends.extend(others.ends.iter().map(|end| end + before));
    }

    /// Other numbers for all things.
    pub(crate) fn renumber(&mut self, number: impl Fn(u32) -> u32) {
        for thing in &mut self.things {
            *thing = number(*thing);
        }
    }
}
