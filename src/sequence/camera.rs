//! Decodes `camera` and `cameras`.

use super::fields::Fields;
use super::keys::keyed;
use super::names::Names;
use super::node::Node;
use super::path::path;
use super::suggest::shortened;
use super::values::{angle, direction, field_of_view, is_number, not_negative, number, positive, vector};
use super::words::{Variants, variant};
use crate::base::math::{Angle, DVec3};
use crate::camera::path::{CameraPath, Focus, Lens};

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
        path: Vec::new(),
    }
}

/// Decodes a camera, which may focus on one of `objects`. `objects` is None if they could not be read.
pub fn camera(node: Node<'_>, objects: Option<&Names<'_>>) -> Option<CameraPath> {
    let mut fields = Fields::of(node, "a camera")?;
    let position = fields.or("position", keyed(vector), POSITION);
    let target = fields.or("target", keyed(vector), DVec3::ZERO);
    let up = fields.or("up", keyed(direction), DVec3::Y);
    let roll = fields.or("roll", keyed(angle), Angle(0.0));
    let lens = fields.or("projection", projection, default_camera().lens);
    let aperture = fields.or("aperture", keyed(not_negative), 0.0);
    let focus = fields.or("focus", |node| focus(node, objects), Focus::Target);
    let shutter = fields.or("shutter", keyed(shutter), 0.0);
    let path = fields.or("path", path, Vec::new());
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
        path: path?,
    })
}

/// A distance, or the name of an object.
fn focus(node: Node<'_>, objects: Option<&Names<'_>>) -> Option<Focus> {
    if node.is_text() {
        return match objects {
            Some(objects) => objects.index(node).map(Focus::Object),
            // The faults of the objects are already reported.
            None => Some(Focus::Target),
        };
    }
    if node.opens_with('[') || node.word() == "Track" || is_number(node) {
        return keyed(positive)(node).map(Focus::Distance);
    }
    let fault = node.mismatch("a distance above 0, or an object's name in quotes");
    let name = node.bare_word().filter(|word| objects.is_some_and(|objects| objects.has(word)));
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
