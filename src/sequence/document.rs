//! Decodes the whole file: its sections, and the names that connect them.

use super::annotations::{SceneNames, annotations};
use super::camera::{ObjectNames, camera, default_camera};
use super::check::{self, report_blind_cameras};
use super::colors::color;
use super::data_ranges;
use super::environment::environment;
use super::expand::OWN_FIELDS;
use super::fault::Fault;
use super::fields::Fields;
use super::fog::fog;
use super::keys::keyed;
use super::layers::{EmitterPlaces, report_too_many_layers};
use super::light::light;
use super::material::material;
use super::material_description::MaterialDescription;
use super::names::{Entry, Names, entries};
use super::node::Node;
use super::object::{MaterialSource, ObjectDraft, Parent, object, report_circles};
use super::output::{default_output, output};
use super::pose_tracks::Placement;
use super::quality_fields::quality;
use super::shape::ShapeOverTime;
use super::syntax::EXAMPLE;
use super::timeline::{still, timeline};
use super::transform_limits::{TransformPlace, report_out_of_range};
use super::values::up_axis;
use super::{Named, Object, Sequence};
use crate::appearance::light::LightTracks;
use crate::appearance::material::{MaterialBinding, MaterialTracks};
use crate::base::color::Rgb;
use crate::base::math::UpAxis;
use crate::camera::path::CameraPath;
use crate::geometry::shape::Shape;
use crate::sequence::quality::Quality;
use crate::track::Animated;
use std::collections::HashMap;
use std::ops::Range;
use std::rc::Rc;

/// Decodes a sequence called `name`. Returns None after any fault, and reports all faults.
pub fn sequence(root: Node<'_>, name: &str) -> Option<Sequence> {
    if !root.word().is_empty() {
        let title = format!("expected ( ... ) around the whole file, without `{}` in front", root.word());
        root.fault(Fault::new(root.head(), title, "remove this word"));
    }
    // JSON files begin like this.
    if root.text().starts_with('{') {
        let fault = root.mismatch("the fields of the sequence, written (name: value, ...)");
        root.fault(fault.help(EXAMPLE));
        return None;
    }
    let mut fields = Fields::of(root, "the sequence")?;
    // They are used up before.
    OWN_FIELDS.into_iter().for_each(|name| fields.ignore(name));
    // First, because they set the axes of vectors and the unit of key times.
    let up = fields.or("up", up_axis, UpAxis::Y);
    root.file.up.set(up.unwrap_or_default());
    let length = fields.place("timeline");
    let timeline = fields.or("timeline", timeline, still());
    let frames = timeline.map_or(1, |timeline| timeline.frames);
    let output = fields.or("output", |node| output(node, name, frames), default_output(name, frames));
    let quality = fields.or("quality", quality, Quality::default());
    let background = fields.or("background", environment, Rgb::ZERO);
    let ambient = fields.or("ambient", keyed(color), Rgb::ONE);
    let fog = fields.optional("fog", fog);
    let (fog_place, objects) = (fields.place("fog"), fields.place("objects"));
    let mut places = EmitterPlaces { lights: Vec::new(), materials: Vec::new(), objects, fog: fog_place };
    let lights = fields.or("lights", |node| lights(node, &mut places.lights), Vec::new());
    let mut transforms = Vec::new();
    let scene = scene(&mut fields, &mut places.materials, &mut transforms);
    // After the objects, because cameras may focus on them.
    let cameras = cameras(&mut fields, scene.as_ref().map(|(_, objects)| objects.as_slice()));
    let parts = scene.as_ref().map(|(materials, objects)| (objects.as_slice(), materials.as_slice()));
    let names = SceneNames::new(parts, timeline);
    let annotations = fields.or("annotations", |node| annotations(node, &names), Vec::new());
    fields.finish();
    if let (Some(timeline), Some(Cameras { list, active, places })) = (&timeline, &cameras) {
        let steps = quality.unwrap_or_default().shutter_steps;
        let cameras = check::CheckedCameras { list, active, places };
        report_blind_cameras(root.file, timeline, steps, &cameras, length);
    }
    if let (Some(timeline), Some((_, objects))) = (&timeline, &scene) {
        report_out_of_range(root.file, timeline, objects, &transforms);
    }
    let (timeline, cameras, (materials, objects)) = (timeline?, cameras?, scene?);
    let sequence = Sequence {
        name: name.to_owned(),
        up: up?,
        timeline,
        output: output?,
        quality: quality?,
        background: background?,
        ambient: ambient?,
        fog: fog?,
        cameras: cameras.list,
        active_camera: cameras.active,
        lights: lights?,
        materials,
        objects,
        annotations: annotations?,
        warnings: Vec::new(),
    };
    report_too_many_layers(root.file, &sequence, &places);
    Some(sequence)
}

/// Decodes the lights, and notes their places in the file.
fn lights(node: Node<'_>, places: &mut Vec<Range<usize>>) -> Option<Vec<Named<LightTracks>>> {
    let entries = entries(node, "light")?;
    *places = places_of(&entries);
    decoded(entries.iter().map(|entry| named(entry, light(entry.value))).collect())
}

fn places_of(entries: &[Entry<'_>]) -> Vec<Range<usize>> {
    entries.iter().map(|entry| entry.key.span()).collect()
}

fn named<T>(entry: &Entry<'_>, value: Option<T>) -> Option<Named<T>> {
    Some(Named { name: entry.name.clone(), value: value? })
}

/// All values, or None if any is missing. Takes a list instead of an iterator, so that all values have been decoded.
fn decoded<T>(values: Vec<Option<T>>) -> Option<Vec<T>> {
    values.into_iter().collect()
}

/// The cameras, and their places in the file.
struct Cameras {
    list: Vec<Named<CameraPath>>,
    active: Animated<usize>,
    places: Vec<Range<usize>>,
}

fn cameras(fields: &mut Fields<'_>, objects: Option<&[Named<Object>]>) -> Option<Cameras> {
    if fields.has("camera") && fields.has("cameras") {
        let (here, there) = (fields.place("cameras"), fields.place("camera"));
        let fault = Fault::new(here, "a sequence has either `camera` or `cameras`", "one too many");
        fields.node().fault(fault.also(there, "the other one is here"));
    }
    let single_place = fields.place("camera");
    let objects = objects.map(ObjectNames::new);
    let camera = |node| camera(node, objects.as_ref());
    let single = fields.optional("camera", camera);
    let mut several = Vec::new();
    let list = fields.optional("cameras", |node| {
        several = entries(node, "camera")?;
        if several.is_empty() {
            node.fault(Fault::new(node.span(), "there are no cameras", "needs at least one"));
            return None;
        }
        decoded(several.iter().map(|entry| named(entry, camera(entry.value))).collect())
    });
    let names = Names::new("camera", &several);
    let active = fields.or("active_camera", keyed(|node| names.index(node)), 0usize);
    let places = places_of(&several);
    let (list, places) = match (single?, list?) {
        (None, Some(list)) => (list, places),
        (None, None) => (vec![unnamed(default_camera())], vec![single_place]),
        (Some(camera), None) => (vec![unnamed(camera)], vec![single_place]),
        (Some(_), Some(_)) => return None,
    };
    Some(Cameras { list, active: active?, places })
}

/// Names the camera of a file that gives no names.
fn unnamed(camera: CameraPath) -> Named<CameraPath> {
    Named { name: "camera".to_owned(), value: camera }
}

type MaterialsAndObjects = (Vec<Named<MaterialTracks>>, Vec<Named<Object>>);

/// Decodes materials and objects. Notes the places of named materials and of the objects' transforms.
fn scene(
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
    let objects = fields.optional("objects", |node| objects(node, &names));
    let (default, materials, objects) =
        (default?, materials?.unwrap_or_default(), objects?.unwrap_or_default());
    transforms.extend(objects.iter().map(|(draft, _)| draft.value.place.clone()));
    let mut places: Vec<_> = objects.iter().map(|(draft, _)| draft.value.material_place.clone()).collect();
    let ((mut materials, mut objects), instances) = assembled(&default, &materials, objects);
    // Behind all others, whose indices stay.
    for (index, instances) in instances.into_iter().enumerate() {
        let count = instances.len();
        transforms.extend(std::iter::repeat_n(transforms[index].clone(), count));
        places.extend(std::iter::repeat_n(places[index].clone(), count));
        objects.extend(instances);
    }
    data_ranges::resolve(fields.node().file, &mut materials, &objects, &places);
    Some((materials, objects))
}

type Placed = (Named<ObjectDraft>, Option<Parent>);

fn objects(node: Node<'_>, materials: &Names<'_>) -> Option<Vec<Placed>> {
    let entries = entries(node, "object")?;
    let names = Names::new("object", &entries);
    let read: Vec<_> = entries.iter().map(|entry| object(entry.value, materials, &names)).collect();
    let (drafts, parents): (Vec<_>, Vec<_>) = read.into_iter().unzip();
    report_circles(node, &entries, &parents);
    let drafts = decoded(entries.iter().zip(drafts).map(|(entry, draft)| named(entry, draft)).collect())?;
    Some(drafts.into_iter().zip(parents).collect())
}

/// Gives every object the index of its material. Appends inline materials, and the default material if it is used, to
/// the named ones. Objects of one mesh share the materials of the mesh. Returns the instances of each object apart.
fn assembled(
    default: &MaterialDescription,
    named: &[Named<MaterialDescription>],
    drafts: Vec<Placed>,
) -> (MaterialsAndObjects, Vec<Vec<Named<Object>>>) {
    let over = |given: &MaterialDescription| given.over(default);
    let mut materials: Vec<_> =
        named.iter().map(|m| Named { name: m.name.clone(), value: over(&m.value) }).collect();
    let mut default_index = None;
    let mut own_by_list = HashMap::new();
    let mut append = |name: String, value: MaterialTracks| {
        materials.push(Named { name, value });
        materials.len() as u32 - 1
    };
    let mut objects = Vec::with_capacity(drafts.len());
    let mut all_instances = Vec::with_capacity(drafts.len());
    for (Named { name, value: draft }, parent) in drafts {
        let ObjectDraft { shape, placements, material, transform, visible, .. } = draft;
        let ShapeOverTime { shape, tracks } = shape;
        let made_of = match material {
            MaterialSource::Named(index) => MaterialBinding::One(index as u32),
            MaterialSource::Inline(given) => {
                MaterialBinding::One(append(format!("objects.{name:?}.material"), over(&given)))
            }
            // The file keeps all lists, so addresses are unique.
            MaterialSource::Mesh(given) => *own_by_list.entry(Rc::as_ptr(&given)).or_insert_with(|| {
                let count = given.len() as u32 - 1;
                let added = given.iter().map(|(slot, given)| {
                    append(format!("objects.{name:?}.shape.materials.{slot:?}"), over(given))
                });
                // Consecutive indices: nothing else is appended meanwhile.
                added.min().map_or(MaterialBinding::One(0), |first| MaterialBinding::Slots { first, count })
            }),
            MaterialSource::Default => MaterialBinding::One(*default_index.get_or_insert_with(|| {
                append("default_material".to_owned(), over(&MaterialDescription::default()))
            })),
        };
        let parent = parent.map(|parent| parent.index);
        let (own, instances) = match placements {
            None => ((shape, tracks), Vec::new()),
            Some(placements) => {
                let index = objects.len();
                let instance = |(number, Placement { transform, visible })| {
                    let (shape, tracks) = (shape.clone(), tracks.clone());
                    let value = Object { shape, tracks, made_of, transform, visible, parent: Some(index) };
                    Named { name: format!("{name}[{number}]"), value }
                };
                ((Shape::Group, None), placements.into_iter().enumerate().map(instance).collect())
            }
        };
        all_instances.push(instances);
        let (shape, tracks) = own;
        objects.push(Named { name, value: Object { shape, tracks, made_of, transform, visible, parent } });
    }
    ((materials, objects), all_instances)
}
