//! Triangle meshes: their data and the tree over each.

mod arrays;
mod blend;
mod closed;
pub(crate) mod build;
pub(crate) mod corners;
mod crease;
mod data;
pub mod deform;
mod error;
mod extrude;
pub mod generate;
mod mtl;
mod packet;
mod preparation;
mod smooth;
mod summary;
#[cfg(test)]
mod tests;

pub use arrays::{ArrayKey, ArrayValues, Centering, Component, DataArray};
pub use blend::blended;
pub use corners::Corners;
pub use data::{MeshData, NO_MATERIAL};
pub use error::{MeshError, MeshLocation, NO_FILE};
pub use extrude::extruded;
pub use mtl::{Map, MapChannel, MapUse, MtlMaterial};
pub use packet::{Packet, ShearedRay, ShearedRays};
pub use preparation::{Center, Preparation, PreparationKey};
pub use smooth::first_equal;
pub use summary::{ArraySummary, MeshSummary};

use crate::base::color::Rgb;
use crate::base::digest::{Content, Digest};
use crate::base::math::{Aabb, DVec2, DVec3};
use crate::geometry::bvh::Tree;
use arrays::DataArrays;
use glam::Vec3;
use std::sync::OnceLock;

/// A checked mesh with its tree. Every triangle has an area.
#[derive(Debug)]
pub struct TriangleMesh {
    /// Without its arrays.
    data: MeshData,
    arrays: DataArrays,
    tree: Tree,
    /// The triangles of each of the tree's leaves.
    packets: Vec<Packet>,
    /// Whether the packets hold all positions exactly.
    exact: bool,
    bounds: Aabb,
    /// Number of triangles that were removed because they have no area.
    pub skipped: usize,
    smooth: OnceLock<Vec<Vec3>>,
    outline: OnceLock<Vec<DVec3>>,
    areas: OnceLock<Vec<f64>>,
    closed: OnceLock<bool>,
    digest: OnceLock<Digest>,
}

/// The normals that a mesh is shaded with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Content)]
pub enum Normals {
    /// The normals of the file.
    File,
    /// The normals of a smooth surface through the vertices.
    Smooth,
    /// The normals of the triangles.
    Flat,
}

impl TriangleMesh {
    pub fn positions(&self) -> &[DVec3] {
        &self.data.positions
    }

    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.data.triangles
    }

    /// The materials of the mesh's file, in the order of their slots.
    pub fn materials(&self) -> &[MtlMaterial] {
        &self.data.materials
    }

    /// The index of a triangle's material in [`TriangleMesh::materials`].
    pub fn material_of(&self, part: u32) -> Option<u16> {
        self.data.slots.get(part as usize).copied().filter(|&slot| slot != NO_MATERIAL)
    }

    pub fn has_normals(&self) -> bool {
        self.data.normals.is_some()
    }

    pub fn has_colors(&self) -> bool {
        !self.data.colors.is_empty()
    }

    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// The corners of a triangle of a packet.
    #[inline(always)]
    pub fn packed_corners(&self, packet: &Packet, lane: usize) -> [DVec3; 3] {
        if self.exact {
            return packet.exact(lane, self.tree.space().size);
        }
        self.corners(packet.part(lane))
    }

    /// The triangles of the tree's leaves.
    #[inline(always)]
    pub fn packets(&self) -> &[Packet] {
        &self.packets
    }

    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The corners of a triangle of the mesh.
    #[inline]
    pub fn corners(&self, part: u32) -> [DVec3; 3] {
        let [a, b, c] = self.data.triangles[part as usize];
        let at = |vertex: u32| self.data.positions[vertex as usize];
        [at(a), at(b), at(c)]
    }

    /// Texture coordinates at a triangle's corners, if all corners have them.
    pub fn corner_uvs(&self, part: u32) -> Option<[DVec2; 3]> {
        self.data.uvs.as_ref()?.at(part, &self.data.triangles)
    }

    /// The vertex colours at a triangle's corners.
    pub fn corner_colors(&self, part: u32) -> Option<[Rgb; 3]> {
        let [a, b, c] = self.data.triangles[part as usize].map(|v| self.data.colors.get(v as usize));
        Some([*a?, *b?, *c?])
    }

    /// Unit normals at a triangle's corners, or zero where a corner has none. None for flat shading.
    pub fn corner_normals(&self, part: u32, normals: Normals) -> Option<[Vec3; 3]> {
        match normals {
            Normals::File => self.data.normals.as_ref()?.at(part, &self.data.triangles),
            Normals::Smooth => {
                let smooth = self.smooth_normals();
                Some(self.data.triangles[part as usize].map(|vertex| smooth[vertex as usize]))
            }
            Normals::Flat => None,
        }
    }

    /// One normal per vertex of the smooth surface through the vertices. Computed at the first call, by all threads: call it
    /// before the mesh is traced.
    pub fn smooth_normals(&self) -> &[Vec3] {
        self.smooth.get_or_init(|| smooth::normals(&self.data.positions, &self.data.triangles))
    }

    /// All data arrays of the mesh.
    pub fn arrays(&self) -> &[DataArray] {
        self.arrays.all()
    }

    /// The array that has these numbers.
    pub fn array(&self, key: &ArrayKey) -> Option<&DataArray> {
        self.arrays.find(key)
    }

    /// The smallest and the largest number of an array on the triangles, without those that are not finite or fail
    /// `counts`.
    pub fn array_range(&self, key: &ArrayKey, counts: impl Fn(f64) -> bool) -> Option<[f64; 2]> {
        self.array(key)?.range_on(&self.data.triangles, key.component, counts)
    }

    /// A number of an array on a triangle, where its second and third corner have these weights.
    pub fn array_at(&self, key: &ArrayKey, part: u32, weights: DVec2) -> Option<f64> {
        let array = self.array(key)?;
        if array.centering == Centering::Cells {
            return Some(array.value(part as usize, key.component));
        }
        let [a, b, c] = self.data.triangles[part as usize].map(|v| array.value(v as usize, key.component));
        let value = a + (b - a) * weights.x + (c - a) * weights.y;
        // At an edge, rounding may lead beyond the corners. `max` and `min` would hide a corner that is not a number.
        let bounded = value.max(a.min(b).min(c)).min(a.max(b).max(c));
        Some(if value.is_nan() { value } else { bounded })
    }

    /// The digest of an array.
    pub fn array_digest(&self, key: &ArrayKey) -> Option<Digest> {
        self.arrays.digest(key)
    }

    /// The vertices of all triangles, each once. Computed at the first call.
    pub fn outline(&self) -> &[DVec3] {
        self.outline.get_or_init(|| {
            let mut used = vec![false; self.data.positions.len()];
            self.data.triangles.as_flattened().iter().for_each(|&vertex| used[vertex as usize] = true);
            let used = self.data.positions.iter().zip(used).filter(|(_, used)| *used);
            used.map(|(position, _)| *position).collect()
        })
    }

    /// The digest of everything except the materials of the file and the data arrays. Computed at the first call if the
    /// mesh is [one that moved](Self::after).
    pub fn digest(&self) -> Digest {
        *self.digest.get_or_init(|| build::digest(&self.data))
    }

    /// For each triangle, the summed area up to and including it. Computed at the first call.
    pub fn summed_areas(&self) -> &[f64] {
        self.areas.get_or_init(|| {
            let area = |part: u32| {
                let [a, b, c] = self.corners(part);
                0.5 * (b - a).cross(c - a).length()
            };
            let parts = 0..self.data.triangles.len() as u32;
            parts
                .scan(0.0, |sum, part| {
                    *sum += area(part);
                    Some(*sum)
                })
                .collect()
        })
    }
}
