//! The data of a triangle mesh.

use super::arrays::DataArray;
use super::corners::Corners;
use super::mtl::MtlMaterial;
use crate::base::color::Rgb;
use crate::base::math::{DVec2, DVec3};
use glam::Vec3;

/// The data of a mesh. Triangles are counter-clockwise when seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshData {
    /// In f64 for every file format, because f32 cannot hold the decimals of OBJ files. Next to the tree, positions
    /// are the smaller part of a mesh.
    pub positions: Vec<DVec3>,
    /// Indices into the positions.
    pub triangles: Vec<[u32; 3]>,
    /// Of any length. A normal that is zero or not finite stands for no normal.
    pub normals: Option<Corners<Vec3>>,
    pub uvs: Option<Corners<DVec2>>,
    /// Linear, one per position; empty if there are no colours.
    pub colors: Vec<Rgb>,
    /// A material index per triangle, or [`NO_MATERIAL`]; empty if the mesh has no materials.
    pub slots: Vec<u16>,
    pub materials: Vec<MtlMaterial>,
    /// Numbers of vertices or of triangles.
    pub arrays: Vec<DataArray>,
}

/// The slot of a triangle without a material.
pub const NO_MATERIAL: u16 = u16::MAX;
