//! Decodes `materials` and `objects`, and gives every object the indices of its parent and its materials.

use super::carriers::CarriedDraft;
use super::clip::{ClipDraft, PlacedCap, bind_caps};
use super::data_ranges;
use super::deformations::{SceneDeformations, deform};
use super::explode::{ExplodeDraft, add_offsets};
use super::fields::Fields;
use super::group_instances::{self, GroupDraft};
use super::material::material;
use super::material_description::MaterialDescription;
use super::material_table::MaterialTable;
use super::names::{Entry, Names, decoded, entries, named, places_of};
use super::node::Node;
use super::object::{ObjectDraft, Parent, object, report_circles};
use super::pose_tracks::Placement;
use super::scene::{NodeMaterial, SceneDraft, SceneNode, UniqueNames, scene, scene_of};
use super::shape::ShapeOverTime;
use super::transform_limits::TransformPlace;
use super::{Named, Object};
use crate::appearance::material::{MaterialBinding, MaterialTracks};
use crate::geometry::ray_kinds::RayVisibility;
use crate::geometry::shape::Shape;
use std::cell::LazyCell;
use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// The materials and objects of a file.
pub struct MaterialsAndObjects {
    pub materials: Vec<Named<MaterialTracks>>,
    pub objects: Vec<Named<Object>>,
    /// What objects carry.
    pub carried: Vec<CarriedDraft>,
}

/// Decodes materials and objects. Notes the places of named materials and of the objects' transforms.
pub fn materials_and_objects(
    fields: &mut Fields<'_>,
    places: &mut Vec<Range<usize>>,
    transforms: &mut Vec<TransformPlace>,
) -> Option<MaterialsAndObjects> {
    let default = fields.or("default_material", material, MaterialDescription::default());
    let mut material_entries = Vec::new();
    let materials = fields.optional("materials", |node| {
        material_entries = entries(node, "material")?;
        *places = places_of(&material_entries);
        decoded(material_entries.iter().map(|entry| named(entry, material(entry.value))).collect())
    });
    let names = Names::new("material", &material_entries);
    let drafts = fields.optional("objects", |node| objects(node, &names));
    let (default, materials, drafts) =
        (default?, materials?.unwrap_or_default(), drafts?.unwrap_or_default());
    transforms.extend(drafts.iter().map(|(draft, _)| draft.value.place.clone()));
    let mut places: Vec<_> = drafts.iter().map(|(draft, _)| draft.value.material_place.clone()).collect();
    let mut table = MaterialTable::new(&default, &materials);
    let (mut objects, below) = assembled(&mut table, drafts);
    let carried = below
        .carried
        .into_iter()
        .map(|(index, draft)| CarriedDraft { place: places[index].clone(), ..draft });
    let carried = carried.collect();
    // Behind all others, whose indices stay. First the nodes of scenes: names of parents count on that.
    for (index, below) in below.scenes.into_iter().chain(below.instances) {
        let count = below.len();
        transforms.extend(std::iter::repeat_n(transforms[index].clone(), count));
        places.extend(std::iter::repeat_n(places[index].clone(), count));
        objects.extend(below);
    }
    let file = fields.node().file;
    let copied = group_instances::add(file, &mut objects, below.groups);
    for source in copied.sources(&objects, places.len()) {
        transforms.push(transforms[source].clone());
        places.push(places[source].clone());
    }
    bind_caps(file, &mut table, &mut objects, (below.caps, &copied));
    add_offsets(file, &mut objects, copied.of_originals(below.explode));
    let moved: HashSet<usize> =
        below.deformed.iter().flat_map(|(_, scene)| scene.drafts.iter().map(|(index, _)| *index)).collect();
    let deformed = below.deformed.into_iter();
    let deformed = deformed.map(|(index, scene)| SceneDeformations { place: places[index].clone(), ..scene });
    deform(file, &mut objects, deformed.collect());
    copied.share_deformations(&mut objects, &moved);
    let mut materials = table.finish();
    data_ranges::resolve(file, &mut materials, &mut objects, (&places, &copied));
    Some(MaterialsAndObjects { materials, objects, carried })
}

type Placed = (Named<Box<ObjectDraft>>, Option<Parent>);

fn objects(node: Node<'_>, materials: &Names<'_>) -> Option<Vec<Placed>> {
    let entries = entries(node, "object")?;
    let mut scenes = Scenes::of(&entries, materials);
    let mut drafts: HashMap<usize, SceneDraft> = std::mem::take(&mut scenes.drafts).into_iter().collect();
    let unread = scenes.unread.iter().map(|index| entries[*index].name.as_str());
    let names = Names::new("object", &entries).and(scenes.names()).unread(unread);
    let read = entries
        .iter()
        .enumerate()
        .map(|(index, entry)| object(entry.value, drafts.remove(&index).map(Box::new), materials, &names));
    let (drafts, parents): (Vec<_>, Vec<_>) = read.collect::<Vec<_>>().into_iter().unzip();
    // A node moves with the object that shows its scene.
    let object_of = |index: usize| index.checked_sub(entries.len()).map_or(index, |node| scenes.owners[node]);
    let above = |parent: &Parent| Parent { index: object_of(parent.index), place: parent.place.clone() };
    let outer: Vec<_> = parents.iter().map(|parent| parent.as_ref().map(above)).collect();
    report_circles(node, &entries, &outer);
    let drafts = decoded(entries.iter().zip(drafts).map(|(entry, draft)| named(entry, draft)).collect())?;
    Some(drafts.into_iter().zip(parents).collect())
}

/// The scenes that objects show. They are read first, because parents may be their nodes.
struct Scenes {
    /// Each scene with the index of its object, in the order of the file.
    drafts: Vec<(usize, SceneDraft)>,
    /// The names of all nodes, and the index of the object of each.
    names: Vec<String>,
    owners: Vec<usize>,
    /// The objects whose scenes could not be read.
    unread: Vec<usize>,
}

impl Scenes {
    fn of(entries: &[Entry<'_>], materials: &Names<'_>) -> Self {
        // Most files have no scenes, and copying all names takes long.
        let mut names = LazyCell::new(|| UniqueNames::new(entries.iter().map(|entry| entry.name.as_str())));
        let mut scenes =
            Self { drafts: Vec::new(), names: Vec::new(), owners: Vec::new(), unread: Vec::new() };
        for (index, entry) in entries.iter().enumerate() {
            let Some(shape) = scene_of(entry.value) else { continue };
            let Some(draft) = scene(shape, &entry.name, (&mut names, materials)) else {
                scenes.unread.push(index);
                continue;
            };
            scenes.names.extend(draft.nodes.iter().map(|node| node.name.clone()));
            scenes.owners.resize(scenes.names.len(), index);
            scenes.drafts.push((index, draft));
        }
        scenes
    }

    fn names(&self) -> impl Iterator<Item = &str> {
        self.names.iter().map(String::as_str)
    }
}

/// The objects below others, with the indices of these.
#[derive(Default)]
struct Below {
    scenes: Vec<(usize, Vec<Named<Object>>)>,
    instances: Vec<(usize, Vec<Named<Object>>)>,
    groups: Vec<(usize, GroupDraft)>,
    carried: Vec<(usize, CarriedDraft)>,
    deformed: Vec<(usize, SceneDeformations)>,
    /// The place of the planes that cut each object, and the material of its cut faces.
    caps: Vec<PlacedCap>,
    /// The exploded view of the parts of each object.
    explode: Vec<Option<Box<ExplodeDraft>>>,
}

/// Gives every object the index of its material. Returns the nodes of scenes and the instances of objects apart.
fn assembled(table: &mut MaterialTable<'_>, drafts: Vec<Placed>) -> (Vec<Named<Object>>, Below) {
    let mut objects = Vec::with_capacity(drafts.len());
    let mut below = Below::default();
    let mut next_node = drafts.len();
    for (Named { name, value: draft }, parent) in drafts {
        let ObjectDraft {
            shape,
            placements,
            group,
            scene,
            material,
            transform,
            visible,
            rays,
            clip,
            explode,
            ..
        } = *draft;
        let ClipDraft { planes: clip, place, cap } = clip;
        below.caps.push((place, cap));
        below.explode.push(explode);
        let ShapeOverTime { shape, tracks } = shape;
        let made_of = table.bind(material, &name);
        let parent = parent.map(|parent| parent.index);
        let index = objects.len();
        below.groups.extend(group.map(|group| (index, *group)));
        if let Some(SceneDraft { nodes, lights, cameras, first, .. }) = scene.map(|scene| *scene) {
            let deformed = nodes.iter().enumerate();
            let drafts =
                deformed.filter_map(|(node, draft)| Some((next_node + node, draft.deformation.clone()?)));
            let base = if first > 0 { next_node } else { index };
            let first = next_node + first;
            below
                .deformed
                .push((index, SceneDeformations { drafts: drafts.collect(), first, base, place: 0..0 }));
            let lights = lights.into_iter().map(|(node, light)| (next_node + node, light)).collect();
            let cameras = cameras.into_iter().map(|(node, camera)| (next_node + node, camera)).collect();
            below.carried.push((index, CarriedDraft { lights, cameras, place: 0..0 }));
            let nodes = scene_objects(table, nodes, made_of, (index, next_node));
            next_node += nodes.len();
            below.scenes.push((index, nodes));
        }
        let (shape, tracks) = match placements {
            None => (shape, tracks),
            Some(placements) => {
                let instance = |(number, Placement { transform, visible, row })| {
                    let (shape, tracks) = (shape.clone(), tracks.clone());
                    let (parent, row) = (Some(index), Some(row));
                    let plain = Object::new(shape, 0);
                    let value = Object { tracks, made_of, transform, visible, parent, row, ..plain };
                    Named { name: format!("{name}[{number}]"), value }
                };
                below.instances.push((index, placements.into_iter().enumerate().map(instance).collect()));
                (Shape::Group, None)
            }
        };
        let (skin_of, row) = (None, None);
        let value = Object { shape, tracks, made_of, transform, visible, rays, parent, skin_of, clip, row };
        objects.push(Named { name, value });
    }
    (objects, below)
}

/// The nodes of a scene as objects, from index `first` on. `object` shows the scene; `own` are the materials of the
/// scene, or the one that the object has instead.
fn scene_objects(
    table: &mut MaterialTable<'_>,
    nodes: Vec<SceneNode>,
    own: MaterialBinding,
    (object, first): (usize, usize),
) -> Vec<Named<Object>> {
    let mut bound: Vec<MaterialBinding> = Vec::with_capacity(nodes.len());
    let node = |SceneNode { name, parent, shape, material, transform, visible, deformation: _, skin_of }| {
        let made_of = match (material, own) {
            (NodeMaterial::Of(other), _) => bound.get(other).copied().unwrap_or(own),
            (NodeMaterial::Given(source), _) => table.bind(source, &name),
            (NodeMaterial::One(index), MaterialBinding::Slots { first, .. }) => {
                MaterialBinding::One(first + index as u32)
            }
            _ => own,
        };
        bound.push(made_of);
        let parent = Some(parent.map_or(object, |parent| first + parent));
        let (rays, skin_of) = (RayVisibility::default(), skin_of.map(|node| first + node));
        let value = Object {
            shape,
            tracks: None,
            made_of,
            transform,
            visible,
            rays,
            parent,
            skin_of,
            clip: Vec::new(),
            row: None,
        };
        Named { name, value }
    };
    nodes.into_iter().map(node).collect()
}
