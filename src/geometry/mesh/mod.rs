//! Triangle meshes: their data and the tree over each.

pub(crate) mod build;
pub(crate) mod corners;
mod error;
pub mod generate;
mod mtl;
mod packet;
mod smooth;
#[cfg(test)]
mod tests;

pub use corners::Corners;
pub use error::{MeshError, NO_FILE, Place};
pub use mtl::{Map, MtlMaterial};
pub use packet::{Packet, Sheared, ShearedRays};

use crate::base::color::Rgb;
use crate::base::digest::{Digest, content};
use crate::base::lanes::Level;
use crate::base::math::{Aabb, DVec2, DVec3};
use crate::geometry::bvh::Tree;
use glam::Vec3;
use std::sync::OnceLock;

/// What a mesh is made of. Triangles are counter-clockwise when seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parts {
    /// In f64 whatever a file holds: decimals of OBJ files have no f32, and next to the tree the positions
    /// are the smaller part of a mesh.
    pub positions: Vec<DVec3>,
    /// Indices into the positions.
    pub triangles: Vec<[u32; 3]>,
    /// Of any length; what is not finite or has no length stands for no normal.
    pub normals: Option<Corners<Vec3>>,
    pub uvs: Option<Corners<DVec2>>,
    /// Linear, one per position; empty if there are none.
    pub colors: Vec<Rgb>,
    /// An index into the materials per triangle, or [`NO_MATERIAL`]; empty if there are none.
    pub slots: Vec<u16>,
    pub materials: Vec<MtlMaterial>,
}

/// The slot of a triangle without a material.
pub const NO_MATERIAL: u16 = u16::MAX;

/// A checked mesh with its tree. Every triangle has an area.
#[derive(Debug)]
pub struct Mesh {
    parts: Parts,
    tree: Tree,
    /// The triangles of each of the tree's leaves.
    packets: Vec<Packet>,
    /// Whether the packets hold all positions as they are.
    exact: bool,
    bounds: Aabb,
    /// How many triangles without an area have been left out.
    pub skipped: usize,
    smooth: OnceLock<Vec<Vec3>>,
    areas: OnceLock<Vec<f64>>,
    digest: Digest,
}

/// Which normals a mesh is shaded with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Normals {
    /// Those that came with it.
    File,
    /// Those of a smooth surface through its vertices.
    Smooth,
    /// Those of its triangles.
    Flat,
}

content!(
    enum Normals {
        File,
        Smooth,
        Flat,
    }
);

impl Mesh {
    pub fn positions(&self) -> &[DVec3] {
        &self.parts.positions
    }

    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.parts.triangles
    }

    /// The materials that came with the mesh, in the order of their slots.
    pub fn materials(&self) -> &[MtlMaterial] {
        &self.parts.materials
    }

    /// The index of a triangle's material in [`Mesh::materials`].
    pub fn material_of(&self, part: u32) -> Option<u16> {
        self.parts.slots.get(part as usize).copied().filter(|&slot| slot != NO_MATERIAL)
    }

    pub fn has_normals(&self) -> bool {
        self.parts.normals.is_some()
    }

    pub fn has_colors(&self) -> bool {
        !self.parts.colors.is_empty()
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
        self.parts.triangles[part as usize].map(|vertex| self.parts.positions[vertex as usize])
    }

    /// Asks for a triangle that will be needed soon.
    #[inline(always)]
    pub fn prefetch<L: Level>(&self, part: u32) {
        L::prefetch(&self.parts.triangles, part as usize);
    }

    /// Asks for what there is at a triangle's corners, for normals of a kind.
    #[inline(always)]
    pub fn prefetch_corners<L: Level>(&self, part: u32, normals: Normals) {
        for vertex in self.parts.triangles[part as usize] {
            L::prefetch(&self.parts.positions, vertex as usize);
        }
        match (normals, &self.parts.normals, self.smooth.get()) {
            (Normals::File, Some(normals), _) => {
                for index in normals.indices(part, &self.parts.triangles) {
                    L::prefetch(normals.values(), index as usize);
                }
            }
            (Normals::Smooth, _, Some(normals)) => {
                for vertex in self.parts.triangles[part as usize] {
                    L::prefetch(normals, vertex as usize);
                }
            }
            _ => {}
        }
    }

    /// Texture coordinates at a triangle's corners, if all of them have some.
    pub fn corner_uvs(&self, part: u32) -> Option<[DVec2; 3]> {
        self.parts.uvs.as_ref()?.at(part, &self.parts.triangles)
    }

    /// The vertices' colours at a triangle's corners.
    pub fn corner_colors(&self, part: u32) -> Option<[Rgb; 3]> {
        let [a, b, c] = self.parts.triangles[part as usize].map(|v| self.parts.colors.get(v as usize));
        Some([*a?, *b?, *c?])
    }

    /// Unit normals at a triangle's corners, zero where there is none; nothing for flat triangles.
    pub fn corner_normals(&self, part: u32, normals: Normals) -> Option<[Vec3; 3]> {
        match normals {
            Normals::File => self.parts.normals.as_ref()?.at(part, &self.parts.triangles),
            Normals::Smooth => {
                let smooth = self.smooth_normals();
                Some(self.parts.triangles[part as usize].map(|vertex| smooth[vertex as usize]))
            }
            Normals::Flat => None,
        }
    }

    /// Normals of a smooth surface through the vertices, one each; computed when first asked for.
    pub fn smooth_normals(&self) -> &[Vec3] {
        self.smooth.get_or_init(|| smooth::normals(&self.parts.positions, &self.parts.triangles))
    }

    /// What the mesh holds, but for the materials that came with it.
    pub fn digest(&self) -> Digest {
        self.digest
    }

    /// The area of all triangles up to and including each; computed when first asked for.
    pub fn summed_areas(&self) -> &[f64] {
        self.areas.get_or_init(|| {
            let area = |part: u32| {
                let [a, b, c] = self.corners(part);
                0.5 * (b - a).cross(c - a).length()
            };
            let parts = 0..self.parts.triangles.len() as u32;
            parts
                .scan(0.0, |sum, part| {
                    *sum += area(part);
                    Some(*sum)
                })
                .collect()
        })
    }
}
