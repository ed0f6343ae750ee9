//! Nodes as objects.

use super::UniqueNames;
use crate::base::math::{Angle, DVec3, UpAxis};
use crate::geometry::mesh::Normals;
use crate::geometry::shape::{Mesh, Shape};
use crate::geometry::transform::{Rotation, TransformTracks};
use crate::import::gltf::{GltfMesh, GltfNode, GltfScene, MeshMaterial};
use crate::sequence::deformations::DeformationDraft;
use crate::sequence::object::MaterialSource;
use crate::track::Animated;
use std::rc::Rc;
use std::sync::Arc;

/// A node as an object.
pub struct SceneNode {
    /// The name of the object: that of the scene, `/`, and that of the node.
    pub name: String,
    /// The index of its parent in the scene. None: the object that names the scene.
    pub parent: Option<usize>,
    pub shape: Shape,
    pub material: NodeMaterial,
    pub transform: TransformTracks,
    pub visible: Animated<bool>,
    /// What deforms its mesh.
    pub deformation: Option<Rc<DeformationDraft>>,
    /// The index in the scene of the node whose mesh this is, if joints place the mesh.
    pub skin_of: Option<usize>,
}

/// The material of a node's mesh.
pub enum NodeMaterial {
    /// It shows nothing.
    None,
    /// One of the materials of the scene.
    One(usize),
    /// The slots of its mesh are the materials of the scene.
    Slots,
    /// That of another node, which comes first.
    Of(usize),
    /// One that the sequence gives instead.
    Given(MaterialSource),
}

/// The nodes of a scene that an object called `name` shows. In files whose z axis points up, the first one turns the
/// others, because y points up in glTF.
pub fn nodes(scene: &GltfScene, name: &str, up: UpAxis, names: &mut UniqueNames) -> Vec<SceneNode> {
    let turn = (up == UpAxis::Z).then(|| upright(names.take(format!("{name}/axes"))));
    let first = usize::from(turn.is_some());
    let node = |node: &GltfNode| {
        let mesh = node.mesh.and_then(|mesh| scene.meshes[mesh].as_ref());
        let transform = TransformTracks {
            translation: node.translation.into(),
            rotation: Rotation::Quaternion(node.rotation.into()),
            scale: node.scale.into(),
            ..TransformTracks::default()
        };
        SceneNode {
            name: names.take(format!("{name}/{}", own_name(scene, node))),
            parent: node.parent.map(|parent| first + parent).or((first > 0).then_some(0)),
            shape: mesh.map_or(Shape::Group, shape),
            material: mesh.map_or(NodeMaterial::None, |mesh| match mesh.material {
                MeshMaterial::One(index) => NodeMaterial::One(index),
                MeshMaterial::Slots => NodeMaterial::Slots,
            }),
            transform,
            visible: node.visible.into(),
            deformation: None,
            skin_of: None,
        }
    };
    let mut all: Vec<SceneNode> = turn.into_iter().collect();
    all.extend(scene.nodes.iter().map(node));
    all
}

/// The mesh of a node. Without normals, glTF asks for flat triangles.
fn shape(mesh: &GltfMesh) -> Shape {
    let normals = if mesh.mesh.has_normals() { Normals::File } else { Normals::Flat };
    Shape::Mesh(Mesh::new(Arc::clone(&mesh.mesh), normals))
}

/// A group that turns the axes of glTF to those of a file with z up: y becomes z, and z becomes -y.
fn upright(name: String) -> SceneNode {
    let rotation = Rotation::AxisAngle { axis: DVec3::X.into(), angle: Angle(90.0).into() };
    SceneNode {
        name,
        parent: None,
        shape: Shape::Group,
        material: NodeMaterial::None,
        transform: TransformTracks { rotation, ..TransformTracks::default() },
        visible: true.into(),
        deformation: None,
        skin_of: None,
    }
}

/// The name of a node: its own, that of what it shows, or its number.
fn own_name(scene: &GltfScene, node: &GltfNode) -> String {
    let mesh = node.mesh.and_then(|mesh| scene.meshes[mesh].as_ref()).map(|mesh| mesh.name.as_str());
    let light = node.light.map(|light| scene.lights[light].name.as_str());
    let named =
        [Some(node.name.as_str()), mesh, light].into_iter().flatten().find(|name| !name.trim().is_empty());
    named.map_or_else(|| format!("node_{}", node.index), str::to_owned)
}
