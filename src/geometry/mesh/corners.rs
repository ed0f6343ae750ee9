//! Values at the corners of triangles: normals, texture coordinates.

use crate::base::digest::{Content, Digester};
use rayon::prelude::*;

/// Up to this number of entries, one thread does the work.
pub(crate) const FEW: usize = 4096;

/// Values at the corners of triangles. Files index them by position or separately, because a position on a seam has
/// several.
#[derive(Clone, Debug, PartialEq)]
pub struct Corners<T> {
    values: Vec<T>,
    /// Indices into the values for each triangle; none if the positions' indices apply. A corner whose index is out of
    /// range has no value.
    indices: Option<Vec<[u32; 3]>>,
}

impl<T: Content> Content for Corners<T> {
    fn feed(&self, into: &mut Digester) {
        let Self { values, indices } = self;
        values.feed(into);
        indices.feed(into);
    }
}

/// The index of a corner without a value.
pub const NOWHERE: u32 = u32::MAX;

impl<T: Copy + Send> Corners<T> {
    /// One value per position.
    pub fn per_vertex(values: Vec<T>) -> Self {
        Self { values, indices: None }
    }

    /// Values with indices for each triangle. Indices equal to the triangles' own are dropped.
    pub fn indexed(values: Vec<T>, indices: Vec<[u32; 3]>, triangles: &[[u32; 3]]) -> Self {
        let indices = (indices != triangles).then_some(indices);
        Self { values, indices }
    }

    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// Whether other corners share as many values in the same way.
    pub(super) fn has_indices_of(&self, other: &Self) -> bool {
        self.values.len() == other.values.len() && self.indices == other.indices
    }

    /// The same corners with other values, as many.
    pub(super) fn with_values(&self, values: Vec<T>) -> Self {
        Self { values, indices: self.indices.clone() }
    }

    /// Whether the positions' indices apply to the values.
    pub fn is_per_vertex(&self) -> bool {
        self.indices.is_none()
    }

    /// The indices of a triangle's values.
    pub fn indices(&self, part: u32, triangles: &[[u32; 3]]) -> [u32; 3] {
        self.indices.as_deref().unwrap_or(triangles)[part as usize]
    }

    /// The values at a triangle's corners, if all of them have one.
    pub fn at(&self, part: u32, triangles: &[[u32; 3]]) -> Option<[T; 3]> {
        let [a, b, c] = self.indices(part, triangles).map(|index| self.values.get(index as usize).copied());
        Some([a?, b?, c?])
    }

    /// Replaces every value.
    pub(super) fn change(&mut self, change: impl Fn(T) -> T + Sync) {
        self.values.par_iter_mut().with_min_len(FEW).for_each(|value| *value = change(*value));
    }

    /// Removes the triangles that `keep` does not flag.
    pub(crate) fn retain(&mut self, keep: &[bool]) {
        if let Some(indices) = &mut self.indices {
            retain(indices, keep);
        }
    }
}

/// Keeps the entries whose flag is set. Entries without a flag are removed.
pub(crate) fn retain<T>(entries: &mut Vec<T>, keep: &[bool]) {
    let mut keep = keep.iter();
    entries.retain(|_| keep.next().is_some_and(|keep| *keep));
}
