//! Decodes `override`: fields that replace those of the nodes of a scene, by their names.

use super::nodes::{NodeMaterial, SceneNode};
use crate::appearance::light::LightTracks;
use crate::base::math::DVec3;
use crate::camera::path::CameraPath;
use crate::geometry::shape::Shape;
use crate::sequence::camera::optics;
use crate::sequence::colors::color;
use crate::sequence::fault::Fault;
use crate::sequence::fields::Fields;
use crate::sequence::keys::{keyed, scaled};
use crate::sequence::names::{Names, entries};
use crate::sequence::node::Node;
use crate::sequence::object::material_source;
use crate::sequence::transform::transform;
use crate::sequence::values::{not_negative, switch};

/// What a scene shows, before its objects have indices.
pub struct SceneParts<'a> {
    pub nodes: &'a mut [SceneNode],
    /// Lights and cameras, each with the index of its node, and what an intensity of 1 of the light comes to.
    pub lights: &'a mut [(usize, LightTracks)],
    pub intensities: &'a [f64],
    pub cameras: &'a mut [(usize, CameraPath)],
}

/// Decodes the map, and replaces fields of the nodes that it names. `scene` is the name of the object that shows the
/// scene; the names of nodes are those of their objects behind it.
pub fn overrides(
    node: Node<'_>,
    scene: &str,
    materials: &Names<'_>,
    parts: &mut SceneParts<'_>,
) -> Option<()> {
    let entries = entries(node, "node")?;
    let own: Vec<String> = parts.nodes.iter().map(|node| behind(&node.name, scene).to_owned()).collect();
    let names = Names::of("node", own.iter().map(String::as_str));
    let mut all = Some(());
    for entry in &entries {
        let found = names.index(entry.key);
        if found.and_then(|index| one(entry.value, index, materials, parts)).is_none() {
            all = None;
        }
    }
    all
}

/// The name of a node without that of its scene.
fn behind<'n>(name: &'n str, scene: &str) -> &'n str {
    name.strip_prefix(scene).and_then(|rest| rest.strip_prefix('/')).unwrap_or(name)
}

/// The fields of the node with this index.
fn one(node: Node<'_>, index: usize, materials: &Names<'_>, parts: &mut SceneParts<'_>) -> Option<()> {
    let mut fields = Fields::of(node, "an override")?;
    let object = &mut parts.nodes[index];
    let place = fields.place("material");
    let material = fields.optional("material", |node| material_source(node, materials));
    if fields.has("material") && object.shape == Shape::Group {
        let fault = Fault::new(place, "only a mesh has a material", "this node shows none");
        fields.node().fault(fault);
        return None;
    }
    let visible = fields.optional("visible", keyed(switch));
    let given = ["translation", "rotation", "scale", "pivot", "poses"].map(|name| fields.has(name));
    let placed = transform(&mut fields);
    let light = parts.lights.iter_mut().zip(parts.intensities).find(|((node, _), _)| *node == index);
    let lit = light.map_or(Some(()), |((_, light), factor)| self::light(&mut fields, light, *factor));
    let camera = parts.cameras.iter_mut().find(|(node, _)| *node == index);
    let seen = camera.map_or(Some(()), |(_, camera)| optics(&mut fields, camera));
    fields.finish();
    let (material, visible, placed) = (material?, visible?, placed?);
    lit?;
    seen?;
    if let Some(material) = material {
        object.material = NodeMaterial::Given(material);
    }
    if let Some(visible) = visible {
        object.visible = visible;
    }
    let [translation, rotation, scale, pivot, poses] = given;
    let to = &mut object.transform;
    if translation || poses {
        to.translation = placed.translation;
    }
    if rotation || poses {
        to.rotation = placed.rotation;
    }
    if scale || poses && placed.scale != DVec3::ONE.into() {
        to.scale = placed.scale;
    }
    if pivot {
        to.pivot = placed.pivot;
    }
    Some(())
}

/// The fields of a light. An intensity is in the unit of the file.
fn light(fields: &mut Fields<'_>, light: &mut LightTracks, factor: f64) -> Option<()> {
    let on = fields.optional("on", keyed(switch));
    let color = fields.optional("color", keyed(color));
    let intensity = fields.optional("intensity", keyed(not_negative));
    let (on, color, intensity) = (on?, color?, intensity?);
    if let Some(on) = on {
        light.on = on.into();
    }
    if let Some(color) = color {
        light.color = color;
    }
    if let Some(intensity) = intensity {
        light.intensity = scaled(intensity, factor);
    }
    Some(())
}
