//! The primitives in the leaves of a tree.

/// The primitives of all leaves, one leaf after the other. Each is an index into the list that the tree was built
/// over.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LeafPrimitives {
    primitives: Vec<u32>,
    /// End of each leaf's primitives.
    ends: Vec<u32>,
}

impl LeafPrimitives {
    /// The number of leaves.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The primitives of a leaf, ascending and without duplicates.
    #[inline(always)]
    pub fn leaf(&self, leaf: u32) -> &[u32] {
        let leaf = leaf as usize;
        let begin = leaf.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.primitives[begin as usize..self.ends[leaf] as usize]
    }

    /// Empty, with capacity for `primitives`.
    pub(super) fn with_capacity(primitives: usize) -> Self {
        Self { primitives: Vec::with_capacity(primitives), ends: Vec::new() }
    }

    pub(super) fn shrink_to_fit(&mut self) {
        self.primitives.shrink_to_fit();
        self.ends.shrink_to_fit();
    }

    /// Appends a leaf and returns its number.
    pub(super) fn push(&mut self, primitives: impl Iterator<Item = u32>) -> u32 {
        let begin = self.primitives.len();
        self.primitives.extend(primitives);
        self.primitives[begin..].sort_unstable();
        let mut kept = begin;
        for at in begin..self.primitives.len() {
            if at == begin || self.primitives[at] != self.primitives[kept - 1] {
                self.primitives[kept] = self.primitives[at];
                kept += 1;
            }
        }
        self.primitives.truncate(kept);
        self.ends.push(kept as u32);
        self.ends.len() as u32 - 1
    }

    /// Appends the leaves of `others`.
    pub(super) fn append(&mut self, others: Self) {
        let before = self.primitives.len() as u32;
        self.primitives.extend_from_slice(&others.primitives);
        self.ends.extend(others.ends.iter().map(|end| end + before));
    }

    /// Replaces the index of every primitive.
    pub(crate) fn renumber(&mut self, number: impl Fn(u32) -> u32) {
        for primitive in &mut self.primitives {
            *primitive = number(*primitive);
        }
    }
}
