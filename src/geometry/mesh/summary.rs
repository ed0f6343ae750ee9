//! What is known of a mesh without keeping it.

use super::build::{checked, digest};
use super::{ArrayKey, Centering, Component, DataArray, MeshData, MeshError};
use crate::base::digest::{Content, Digest, Digester};
use crate::base::math::Aabb;

/// The properties of a checked mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshSummary {
    /// The digest of everything except the materials of the file.
    pub content: Digest,
    /// Equal for meshes with as many vertices and the same triangles.
    pub topology: Digest,
    /// Around all triangles with an area.
    pub bounds: Aabb,
    /// Number of triangles without an area.
    pub skipped: usize,
    pub has_normals: bool,
    pub arrays: Vec<ArraySummary>,
}

/// A data array without its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct ArraySummary {
    pub name: String,
    pub centering: Centering,
    pub components: usize,
    /// The ranges of the whole entry, and of each component.
    ranges: Vec<NumberRanges>,
}

/// The smallest and the largest finite number, and the same of those above 0.
#[derive(Clone, Copy, Debug, PartialEq)]
struct NumberRanges {
    all: Option<[f64; 2]>,
    positive: Option<[f64; 2]>,
}

impl MeshSummary {
    /// Checks a mesh and summarizes it.
    ///
    /// # Errors
    /// Those of [`TriangleMesh::new`](super::TriangleMesh::new).
    pub fn of(data: &MeshData) -> Result<Self, MeshError> {
        let (bounds, skipped) = checked(data)?;
        Ok(Self {
            content: content(data),
            topology: Digest::of(&(data.positions.len(), &data.triangles)),
            bounds,
            skipped,
            has_normals: data.normals.is_some(),
            arrays: data.arrays.iter().map(|array| ArraySummary::of(array, &data.triangles)).collect(),
        })
    }

    /// The array that has these numbers.
    pub fn array(&self, key: &ArrayKey) -> Option<&ArraySummary> {
        let index = key.index(self.arrays.iter().map(|array| (array.name.as_str(), array.centering)))?;
        let array = &self.arrays[index];
        (array.range_index(key.component) < array.ranges.len()).then_some(array)
    }
}

/// The digest of everything except the materials of the file.
pub(super) fn content(data: &MeshData) -> Digest {
    let mut digester = Digester::new();
    digest(data).feed(&mut digester);
    for DataArray { name, centering, .. } in &data.arrays {
        (name.as_str(), *centering).feed(&mut digester);
    }
    data.arrays.iter().for_each(|array| array.digest().feed(&mut digester));
    digester.finish()
}

impl MeshData {
    /// The digest of everything except the materials of the file.
    pub fn content(&self) -> Digest {
        content(self)
    }
}

impl ArraySummary {
    fn of(array: &DataArray, triangles: &[[u32; 3]]) -> Self {
        let ranges = |component| NumberRanges {
            all: array.range_on(triangles, component, |_| true),
            positive: array.range_on(triangles, component, |value| value > 0.0),
        };
        let components = (0..array.components as u32).map(Component::Index);
        Self {
            name: array.name.clone(),
            centering: array.centering,
            components: array.components,
            ranges: std::iter::once(Component::Whole).chain(components).map(ranges).collect(),
        }
    }

    fn range_index(&self, component: Component) -> usize {
        match component {
            Component::Whole => 0,
            Component::Index(index) => index as usize + 1,
        }
    }

    /// The smallest and the largest finite number of a component; of those above 0 if `positive`.
    pub fn range(&self, component: Component, positive: bool) -> Option<[f64; 2]> {
        let ranges = self.ranges.get(self.range_index(component))?;
        if positive { ranges.positive } else { ranges.all }
    }
}
