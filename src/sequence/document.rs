//! Decodes the whole file: its sections, and the names that connect them.

use super::annotations::{SceneNames, annotations};
use super::camera::{ObjectNames, camera, default_camera};
use super::carriers::Carried;
use super::check::{self, report_blind_cameras};
use super::colors::color;
use super::environment::environment;
use super::expand::OWN_FIELDS;
use super::fault::Fault;
use super::fields::Fields;
use super::fog::fog;
use super::keys::{interval, keyed};
use super::layers::{EmitterPlaces, report_too_many_layers};
use super::light::light;
use super::names::{Names, decoded, entries, named, places_of};
use super::node::Node;
use super::objects::{MaterialsAndObjects, materials_and_objects};
use super::output::{default_output, output};
use super::quality_fields::quality;
use super::scene::UniqueNames;
use super::syntax::EXAMPLE;
use super::timeline::{still, timeline};
use super::transform_limits::report_out_of_range;
use super::values::{text, up_axis};
use super::version;
use super::words::report_word;
use super::{Named, Object, Sequence, json};
use crate::appearance::light::LightTracks;
use crate::base::color::Rgb;
use crate::base::math::UpAxis;
use crate::base::time::Time;
use crate::camera::CameraCuts;
use crate::camera::path::CameraPath;
use crate::sequence::quality::Quality;
use crate::track::Animated;
use std::ops::Range;

/// Decodes a sequence called `name`. Returns None after any fault, and reports all faults.
pub fn sequence(root: Node<'_>, name: &str) -> Option<Sequence> {
    report_word(root);
    // JSON begins like this, in a file whose name ends otherwise.
    if root.text().starts_with('{') && !root.file.is_json {
        let fault = root.mismatch("the fields of the sequence, written (name: value, ...)");
        root.fault(fault.help(EXAMPLE));
        return None;
    }
    let mut fields = Fields::of(root, "the sequence")?;
    fields.optional(version::FIELD, version::version);
    // They are used up before.
    OWN_FIELDS.into_iter().for_each(|name| fields.used_up(name));
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
    let mut lights = fields.or("lights", |node| lights(node, &mut places.lights), Vec::new());
    let mut transforms = Vec::new();
    let mut scene = materials_and_objects(&mut fields, &mut places.materials, &mut transforms);
    let mut carried = Carried::default();
    if let Some(scene) = &mut scene {
        let up = up.unwrap_or_default();
        carried = Carried::of(root.file, &scene.objects, std::mem::take(&mut scene.carried), up);
    }
    if let Some(lights) = &mut lights {
        places.lights.resize(lights.len(), 0..0);
        let mut names = UniqueNames::new(lights.iter().map(|light| light.name.as_str()));
        for (Named { name, value }, place) in carried.lights {
            lights.push(Named { name: names.take(name), value });
            places.lights.push(place);
        }
    }
    // After the objects, because cameras may focus on them.
    let cameras = cameras(&mut fields, scene.as_ref().map(|scene| scene.objects.as_slice()), carried.cameras);
    let parts = scene.as_ref().map(|scene| (scene.objects.as_slice(), scene.materials.as_slice()));
    let names = SceneNames::new(parts, timeline);
    let annotations = fields.or("annotations", |node| annotations(node, &names), Vec::new());
    if root.file.is_json {
        // Editors look there; what it holds changes nothing.
        fields.optional(json::SCHEMA, text);
    }
    fields.finish();
    if let (Some(timeline), Some(Cameras { list, active, places })) = (&timeline, &cameras) {
        let steps = quality.unwrap_or_default().shutter_steps;
        let cameras = check::CheckedCameras { list, active, places };
        report_blind_cameras(root.file, timeline, steps, &cameras, length);
    }
    if let (Some(timeline), Some(scene)) = (&timeline, &scene) {
        report_out_of_range(root.file, timeline, &scene.objects, &transforms);
    }
    let (timeline, cameras, scene) = (timeline?, cameras?, scene?);
    let MaterialsAndObjects { materials, objects, .. } = scene;
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

/// The cameras, and their places in the file.
struct Cameras {
    list: Vec<Named<CameraPath>>,
    active: CameraCuts,
    places: Vec<Range<usize>>,
}

/// Decodes the cameras of the file, and adds those that objects carry. `active_camera` may name all of them. Without a
/// camera of the file, the first of the others is active.
fn cameras(
    fields: &mut Fields<'_>,
    objects: Option<&[Named<Object>]>,
    carried: Vec<(Named<CameraPath>, Range<usize>)>,
) -> Option<Cameras> {
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
    let taken = several.iter().map(|entry| entry.name.as_str()).chain(fields.has("camera").then_some(SINGLE));
    let mut unique = UniqueNames::new(taken);
    let (carried, carried_places): (Vec<_>, Vec<_>) = carried
        .into_iter()
        .map(|(Named { name, value }, place)| (Named { name: unique.take(name), value }, place))
        .unzip();
    let further = carried.iter().map(|camera| camera.name.as_str());
    let single_name = (fields.has("camera") && !carried.is_empty()).then_some(SINGLE);
    let names = Names::new("camera", &several).and(single_name.into_iter()).and(further);
    let active = active_camera(fields, &names);
    let places = places_of(&several);
    let (list, places) = match (single?, list?) {
        (None, Some(list)) => (list, places),
        (None, None) if carried.is_empty() => (vec![unnamed(default_camera())], vec![single_place]),
        (None, None) => (Vec::new(), Vec::new()),
        (Some(camera), None) => (vec![unnamed(camera)], vec![single_place]),
        (Some(_), Some(_)) => return None,
    };
    let list: Vec<_> = list.into_iter().chain(carried).collect();
    let places = places.into_iter().chain(carried_places).collect();
    Some(Cameras { list, active: active?, places })
}

/// Decodes the active camera and the length of cross-fades.
fn active_camera(fields: &mut Fields<'_>, names: &Names<'_>) -> Option<CameraCuts> {
    let place = fields.place("cross_fade");
    let active = fields.or("active_camera", keyed(|node| names.index(node)), 0usize);
    let fade = fields.optional("cross_fade", interval)?.unwrap_or(Time::from_integer(0));
    let active = active?;
    let cuts: Vec<Time> = match &active {
        Animated::Constant(_) => Vec::new(),
        Animated::Keyed(track) => {
            let pairs = track.keys().windows(2).filter(|pair| pair[0].value != pair[1].value);
            pairs.map(|pair| pair[1].time).collect()
        }
    };
    if cuts.is_empty() && fields.is_given("cross_fade") {
        let note = "`cross_fade` has no effect: `active_camera` has no keys that change the camera";
        fields.node().file.warn(place.start, note.to_owned());
    }
    if let Some(pair) = cuts.windows(2).find(|pair| pair[1] - pair[0] < fade) {
        let [first, second] = [pair[0], pair[1]].map(|time| *time.numer() as f64 / *time.denom() as f64);
        let title = format!("the cuts at {first} s and {second} s are nearer than a cross-fade is long");
        let fault = Fault::new(place, title, "too long");
        fields
            .node()
            .fault(fault.help("write a shorter `cross_fade`, or move the keys of `active_camera` apart"));
        return None;
    }
    Some(CameraCuts { active, fade })
}

/// The name of a camera without a name.
const SINGLE: &str = "camera";

/// Names the camera of a file that gives no names.
fn unnamed(camera: CameraPath) -> Named<CameraPath> {
    Named { name: SINGLE.to_owned(), value: camera }
}
