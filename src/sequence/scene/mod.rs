//! Decodes `Scene`: the nodes of a glTF file as objects below the object that names it.

mod animation;
mod cameras;
mod further;
mod lights;
mod materials;
mod names;
mod nodes;
mod overrides;
mod playback;
#[cfg(test)]
mod tests;

pub use lights::LightUnit;
pub use names::UniqueNames;
pub use nodes::{NodeMaterial, SceneNode};

use super::fault::Fault;
use super::fields::Fields;
use super::material_description::MeshMaterials;
use super::names::Names;
use super::node::{Node, NodeContent};
use super::scene_files::SceneFile;
use super::suggest::shortened;
use super::values::{PATHS, file_path, switch};
use super::words::word;
use crate::appearance::light::LightTracks;
use crate::base::files::NO_FILE;
use crate::camera::path::CameraPath;
use crate::import::gltf::GltfNode;
use animation::Channels;
use overrides::{SceneParts, overrides};
use playback::playing;
use std::rc::Rc;

/// The word of scenes in files.
pub const SCENE: &str = "Scene";

/// A scene whose materials have no index yet.
pub struct SceneDraft {
    /// Parents before children.
    pub nodes: Vec<SceneNode>,
    pub materials: MeshMaterials,
    /// Lights and cameras, each with the index of the node that carries it.
    pub lights: Vec<(usize, LightTracks)>,
    pub cameras: Vec<(usize, CameraPath)>,
    /// The index of the object of the first node of the file.
    pub first: usize,
}

/// The shape of an object if it is a scene. Scenes are decoded before objects, which may name their nodes.
pub fn scene_of(object: Node<'_>) -> Option<Node<'_>> {
    // Most objects are none, and splitting a value into its fields takes longer.
    if !object.text().contains(SCENE) {
        return None;
    }
    let Some(NodeContent::Fields(fields)) = object.content() else { return None };
    fields.into_iter().find(|(name, _)| *name == "shape").map(|(_, shape)| shape).filter(is_scene)
}

/// Whether a shape is a scene.
pub fn is_scene(shape: &Node<'_>) -> bool {
    shape.word() == SCENE
}

/// Decodes the scene of an object called `name`. The names of its nodes get into `names`; `materials` are those of the
/// sequence.
pub fn scene(
    node: Node<'_>,
    name: &str,
    (names, materials): (&mut UniqueNames, &Names<'_>),
) -> Option<SceneDraft> {
    let mut fields = Fields::of_or_only(node, "`Scene`", "file")?;
    let mut place = node.span();
    let file = fields.required("file", |node| {
        place = node.span();
        file(node)
    });
    let playing = playing(&mut fields, file.as_ref().map(|file| &file.scene));
    let lit = fields.or("lights", switch, true);
    let units = &[("Photometric", LightUnit::Photometric), ("Radiometric", LightUnit::Radiometric)];
    let unit = fields.or("light_unit", |node| word(node, "unit of lights", units), LightUnit::Photometric);
    let (Some(file), Some(playing), Some(lit), Some(unit)) = (file, playing, lit, unit) else {
        fields.ignore("override");
        fields.finish();
        return None;
    };
    let own = file.materials(|| materials::materials(node, &place, &file.scene))?;
    let mut nodes = nodes::nodes(&file.scene, name, node.file.up.get(), names);
    let channels = Channels::of(&file.scene, &playing.animations, playing.playback);
    // An object that turns the others may come first.
    let first = nodes.len() - file.scene.nodes.len();
    for (object, node) in nodes.iter_mut().skip(first).zip(&file.scene.nodes) {
        channels.animate_node(node.index, object);
    }
    let all = || (first..).zip(&file.scene.nodes);
    let light = |(index, node): (usize, &GltfNode)| {
        let number = node.light.filter(|_| lit)?;
        let given = &file.scene.lights[number];
        let (mut light, factor) = (lights::light(given, unit), lights::factor(given.kind, unit));
        channels.animate_light(number, &mut light, factor);
        Some(((index, light), factor))
    };
    let camera =
        |(index, node): (usize, &GltfNode)| Some((index, cameras::camera(file.scene.cameras[node.camera?])));
    let (mut lights, intensities): (Vec<_>, Vec<_>) = all().filter_map(light).unzip();
    let mut cameras: Vec<_> = all().filter_map(camera).collect();
    let mut parts = SceneParts {
        nodes: &mut nodes,
        lights: &mut lights,
        intensities: &intensities,
        cameras: &mut cameras,
    };
    let replaced = fields.optional("override", |node| overrides(node, name, materials, &mut parts));
    fields.finish();
    replaced?;
    if let Some((index, _)) = lights.iter().find(|(_, light)| lights::is_too_bright(light)) {
        let title = format!("the light of `{}` is too bright", shortened(&nodes[*index].name));
        let label = "its color times its intensity is above 1e30 in Kinora's units";
        node.fault(Fault::new(place, title, label));
        return None;
    }
    further::add_deformations(&file.scene, &channels, (first, &mut nodes), names);
    further::add_instances(&file.scene, first, &mut nodes, names);
    note_left_out(node, &file);
    Some(SceneDraft { nodes, materials: own, lights, cameras, first })
}

/// The file with the quoted name.
fn file(node: Node<'_>) -> Option<Rc<SceneFile>> {
    let name = file_path(node)?;
    match node.file.scenes.scene(&name) {
        Ok(file) => Some(file),
        Err(why) => {
            let title = format!("cannot read the scene {:?}", shortened(&name));
            let missing = why == NO_FILE;
            let fault = Fault::new(node.span(), title, why);
            node.fault(if missing { fault.help(PATHS) } else { fault });
            None
        }
    }
}

/// Notes what the file has and Kinora does not show.
fn note_left_out(node: Node<'_>, file: &SceneFile) {
    let left_out = &file.scene.left_out;
    if !left_out.is_empty() {
        node.file.warn(node.span().start, format!("left out of the scene: {}", left_out.join(", ")));
    }
}
