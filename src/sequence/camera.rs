//! Decodes `camera` and `cameras`.

use super::fault::Fault;
use super::fields::Fields;
use super::frame::frame;
use super::keys::keyed;
use super::names::Names;
use super::node::{Node, NodeContent};
use super::path::path;
use super::placement::shown_by;
use super::poses::camera_poses;
use super::suggest::shortened;
use super::values::{
    angle, field_of_view, is_number, not_negative, number, positive, world_direction, world_vector,
};
use super::words::{Variants, variant};
use super::{Named, Object};
use crate::base::math::{Angle, DVec3};
use crate::camera::path::{CameraPath, Focus, Lens, PosePath, Step};
use std::ops::Range;

const POSITION: DVec3 = DVec3::new(0.0, 1.0, 5.0);
const FIELD_OF_VIEW: Angle = Angle(45.0);

/// The camera of a file without a camera.
pub fn default_camera() -> CameraPath {
    CameraPath {
        position: POSITION.into(),
        target: DVec3::ZERO.into(),
        up: DVec3::Y.into(),
        roll: Angle(0.0).into(),
        lens: Lens::Perspective { fov: FIELD_OF_VIEW.into() },
        aperture: 0.0.into(),
        focus: Focus::Target,
        shutter: 0.0.into(),
        frame: None,
        path: Vec::new(),
    }
}

/// The objects that cameras may name.
pub struct ObjectNames<'n> {
    pub names: Names<'n>,
    pub objects: &'n [Named<Object>],
}

impl<'n> ObjectNames<'n> {
    pub fn new(objects: &'n [Named<Object>]) -> Self {
        let names = objects.iter().map(|object| object.name.as_str());
        Self { names: Names::of("object", names), objects }
    }
}

/// Decodes a camera, which may name some of `objects`. `objects` is None if they could not be read.
pub fn camera(node: Node<'_>, objects: Option<&ObjectNames<'_>>) -> Option<CameraPath> {
    let mut fields = Fields::of(node, "a camera")?;
    let poses = poses(&mut fields);
    let position = fields.or("position", keyed(world_vector), POSITION);
    let target = fields.or("target", keyed(world_vector), DVec3::ZERO);
    let up = fields.or("up", keyed(world_direction), DVec3::Y);
    let roll = fields.or("roll", keyed(angle), Angle(0.0));
    let mut height = None;
    let decode = |node| {
        height = given_height(node);
        projection(node)
    };
    let lens = fields.or("projection", decode, default_camera().lens);
    let aperture = fields.or("aperture", keyed(not_negative), 0.0);
    let focus = fields.or("focus", |node| focus(node, objects), Focus::Target);
    let shutter = fields.or("shutter", keyed(shutter), 0.0);
    let path = fields.or("path", path, Vec::new());
    let path =
        poses.and_then(|poses| Some(poses.map(Step::Poses).into_iter().chain(path?).collect::<Vec<_>>()));
    refuse_height(&fields, height);
    let frame = frame(&mut fields, objects, path.as_deref().unwrap_or_default());
    fields.finish();
    Some(CameraPath {
        position: position?,
        target: target?,
        up: up?,
        roll: roll?,
        lens: lens?,
        aperture: aperture?,
        focus: focus?,
        shutter: shutter?,
        frame: frame?,
        path: path?,
    })
}

/// Decodes the fields of a camera that an object carries: those that say nothing about its place.
pub fn optics(fields: &mut Fields<'_>, camera: &mut CameraPath) -> Option<()> {
    let lens = fields.optional("projection", projection);
    let aperture = fields.optional("aperture", keyed(not_negative));
    let focus = fields.optional("focus", keyed(positive));
    let shutter = fields.optional("shutter", keyed(shutter));
    let (lens, aperture, focus, shutter) = (lens?, aperture?, focus?, shutter?);
    let given = camera.clone();
    *camera = CameraPath {
        lens: lens.unwrap_or(given.lens),
        aperture: aperture.unwrap_or(given.aperture),
        focus: focus.map_or(given.focus, Focus::Distance),
        shutter: shutter.unwrap_or(given.shutter),
        ..given
    };
    Some(())
}

/// The poses, which replace the fields about the camera's place.
fn poses(fields: &mut Fields<'_>) -> Option<Option<PosePath>> {
    let poses = fields.optional("poses", camera_poses)?;
    let Some(other) = ["position", "target", "up", "frame"].into_iter().find(|name| fields.has(name)) else {
        return Some(poses);
    };
    if poses.is_some() {
        let fault = Fault::new(fields.place(other), format!("`poses` replaces `{other}`"), "one too many");
        fields.node().fault(fault.also(fields.place("poses"), "the place of the camera is given here"));
        return None;
    }
    Some(None)
}

/// A distance, or the name of an object.
fn focus(node: Node<'_>, objects: Option<&ObjectNames<'_>>) -> Option<Focus> {
    if node.is_text() {
        return match objects {
            Some(ObjectNames { names, objects }) => {
                names.index(node).map(|index| Focus::Object(shown_by(objects, index)))
            }
            // The faults of the objects are already reported.
            None => Some(Focus::Target),
        };
    }
    if node.opens_with('[') || node.begins_with("Track") || is_number(node) {
        return keyed(positive)(node).map(Focus::Distance);
    }
    let fault = node.mismatch("a distance above 0, or an object's name in quotes");
    let name = node.bare_word().filter(|word| objects.is_some_and(|objects| objects.names.has(word)));
    node.fault(match name {
        Some(name) => fault.help(format!("write \"{}\"", shortened(name))),
        None => fault.help("without `focus`, the camera focuses at the distance of its target"),
    });
    None
}

/// A share of the time between two frames.
fn shutter(node: Node<'_>) -> Option<f64> {
    let share = number(node)?;
    if (0.0..=1.0).contains(&share) {
        return Some(share);
    }
    let fault = node.mismatch("a number from 0 to 1");
    node.fault(fault.help("a share of the time between two frames: 0.5 for a shutter of 180 degrees"));
    None
}

/// The place of the field `height` of a projection.
fn given_height(node: Node<'_>) -> Option<Range<usize>> {
    let Some(NodeContent::Fields(fields)) = node.content() else { return None };
    fields.iter().find(|(name, _)| *name == "height").map(|(name, _)| node.file.span_of(name))
}

/// A height is either found or given.
fn refuse_height(fields: &Fields<'_>, height: Option<Range<usize>>) {
    let Some(place) = height.filter(|_| fields.has("frame")) else { return };
    let fault = Fault::new(place, "`frame` finds the height of the picture", "one too many");
    fields.node().fault(fault.also(fields.place("frame"), "the camera is fitted to this"));
}

fn projection(node: Node<'_>) -> Option<Lens> {
    let table: &Variants<'_, Lens> = &[("Perspective", perspective), ("Orthographic", orthographic)];
    variant(node, "projection", table)
}

fn perspective(node: Node<'_>) -> Option<Lens> {
    let mut fields = Fields::of(node, "`Perspective`")?;
    let fov = fields.or("fov", keyed(field_of_view), FIELD_OF_VIEW);
    fields.finish();
    Some(Lens::Perspective { fov: fov? })
}

fn orthographic(node: Node<'_>) -> Option<Lens> {
    let mut fields = Fields::of(node, "`Orthographic`")?;
    let height = fields.or("height", keyed(positive), 2.0);
    fields.finish();
    Some(Lens::Orthographic { height: height? })
}
