//! glTF 2.0 files (`.gltf` and `.glb`): scenes of nodes with meshes, materials, cameras and lights.
//!
//! The reader checks the whole file: every index, size and number. What comes out has no reference that leads nowhere.
//! What Kinora has no counterpart for is named in [`GltfScene::left_out`].
//!
//! Source: Khronos, *glTF 2.0 Specification*, version 2.0.1, and the extensions that `features` lists.

mod accessor;
mod animation;
mod buffers;
mod camera;
mod container;
mod features;
mod image;
mod instancing;
mod json;
mod key_time;
mod light;
mod material;
mod mesh;
mod node;
mod primitive;
mod skin;
#[cfg(test)]
mod strict_tests;
#[cfg(test)]
mod tests;
mod texture;
mod uri;

pub use animation::{GltfAnimation, GltfChannel, GltfTarget, Interpolation};
pub use camera::GltfCamera;
pub use image::{GltfImage, ImageBytes};
pub use instancing::GltfInstance;
pub use light::{GltfLight, GltfLightKind};
pub use material::{AlphaMode, GltfMaterial, Volume};
pub use mesh::{GltfMesh, MeshMaterial};
pub use node::GltfNode;
pub use skin::GltfSkin;
pub use texture::GltfTexture;

use super::LoadProgress;
use crate::base::escape;
use crate::base::files::{self, Root};
use crate::base::machine;
use crate::base::math::DVec3;
use crate::geometry::mesh::MeshError;
use buffers::Buffers;
use features::LeftOut;
use json::Item;
use std::collections::HashSet;
use std::path::Path;
use uri::Resources;

/// The result of reading a part of a file.
type GltfResult<T> = Result<T, MeshError>;

/// The largest file in bytes.
const MAX_FILE_SIZE: u64 = 8 << 30;

/// What a file shows: one scene, with all that its nodes use.
#[derive(Debug, Default)]
pub struct GltfScene {
    /// The nodes of the scene, parents before children.
    pub nodes: Vec<GltfNode>,
    /// The meshes of the file; none for those that no node shows, and those without a visible triangle.
    pub meshes: Vec<Option<GltfMesh>>,
    /// The materials of the file, then the one of primitives without a material.
    pub materials: Vec<GltfMaterial>,
    /// None for skins with a joint outside the scene, which no node uses.
    pub skins: Vec<Option<GltfSkin>>,
    pub images: Vec<GltfImage>,
    pub cameras: Vec<GltfCamera>,
    pub lights: Vec<GltfLight>,
    pub animations: Vec<GltfAnimation>,
    /// What the file has and Kinora does not show, such as "points of 2 primitives".
    pub left_out: Vec<String>,
}

/// Whether the name of a file says that it is glTF.
pub fn is_gltf(path: &Path) -> bool {
    path.extension().is_some_and(|kind| kind.eq_ignore_ascii_case("gltf") || kind.eq_ignore_ascii_case("glb"))
}

/// Reads a file. Other files that it names must be in `root`.
pub fn load(path: &Path, root: &Root, meter: &LoadProgress) -> GltfResult<GltfScene> {
    let name = escape::path(path.file_name().unwrap_or(path.as_os_str()));
    let (_, size) = files::open(path, MAX_FILE_SIZE)?;
    machine::check_memory(size)?;
    meter.start(format!("loading {name}"), 0);
    let bytes = files::read(path, MAX_FILE_SIZE)?;
    let resources = Resources { folder: path.parent().unwrap_or(Path::new("")), root };
    read(&bytes, &resources, meter)
}

/// Reads the bytes of a file in `folder`. Other files that it names must be in `root`.
pub fn from_bytes(bytes: &[u8], folder: &Path, root: &Root) -> GltfResult<GltfScene> {
    read(bytes, &Resources { folder, root }, &LoadProgress::default())
}

/// Reads the bytes of a file.
fn read(bytes: &[u8], resources: &Resources<'_>, meter: &LoadProgress) -> GltfResult<GltfScene> {
    let (json, chunk) = container::parts(bytes)?;
    let root = Item::root(&json);
    features::check(&root)?;
    let mut left_out = LeftOut::default();
    left_out.note_extensions(&root)?;
    let buffers = Buffers::read(&root, chunk.and_then(|range| bytes.get(range)), resources)?;
    let images = image::images(&root, &buffers, resources)?;
    let mut materials = material::materials(&root, &mut left_out)?;
    let cameras = camera::cameras(&root)?;
    let lights = light::lights(&root)?;
    let animations = animation::animations(&root, &buffers, &mut left_out)?;
    let mut nodes = node::nodes(&root, &buffers)?;
    let meshes = mesh::meshes(&root, &buffers, &nodes, (&mut materials, &mut left_out), meter)?;
    let skins = skin::skins(&root, &buffers, &nodes)?;
    skin::check(&root, &nodes, &meshes, &skins)?;
    check_nodes(&root, &mut nodes, (&meshes, &animations), &mut left_out)?;
    let left_out = left_out.listed();
    Ok(GltfScene { skins, nodes, meshes, materials, images, cameras, lights, animations, left_out })
}

/// Checks the weights of nodes, and notes what nodes do not show.
fn check_nodes(
    root: &Item<'_>,
    nodes: &mut [GltfNode],
    (meshes, animations): (&[Option<GltfMesh>], &[GltfAnimation]),
    left_out: &mut LeftOut,
) -> GltfResult<()> {
    let channels = animations.iter().flat_map(|animation| &animation.channels);
    let scaled: HashSet<usize> = channels
        .filter_map(|channel| if let GltfTarget::Scale(node) = channel.target { Some(node) } else { None })
        .collect();
    // Whether nodes or those below them show a mesh. Parents come first.
    let mut shows: Vec<bool> = nodes.iter().map(|node| node.mesh.is_some()).collect();
    for at in (0..nodes.len()).rev() {
        if let Some(parent) = nodes[at].parent.filter(|_| shows[at]) {
            shows[parent] = true;
        }
    }
    for (node, shows) in nodes.iter_mut().zip(shows) {
        if shows && node.scale.cmpeq(DVec3::ZERO).any() && !scaled.contains(&node.index) {
            left_out.note("surfaces flattened by a scale of 0", "node");
        }
        let Some(mesh) = node.mesh.and_then(|mesh| meshes[mesh].as_ref()) else { continue };
        let targets = mesh.deformer.as_ref().map_or(0, |deformer| deformer.targets());
        mesh::check_weights(&root.entry("nodes", node.index)?, node.weights.len(), targets)?;
        // Joints place a skinned mesh, so its node has no other places for it.
        if mesh.joints > 0 && node.skin.is_some() && node.instances.take().is_some() {
            left_out.note("instances of skinned meshes", "node");
        }
    }
    Ok(())
}
