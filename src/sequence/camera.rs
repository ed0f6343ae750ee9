//! `camera` and `cameras`: where the picture is taken from.

use super::fields::Fields;
use super::keys::keyed;
use super::node::Node;
use super::path::path;
use super::values::{angle, direction, field_of_view, positive, vector};
use super::words::{Variants, variant};
use crate::camera_path::{CameraPath, Lens};
use crate::math::{Angle, DVec3};

const POSITION: DVec3 = DVec3::new(0.0, 1.0, 5.0);
const FIELD_OF_VIEW: Angle = Angle(45.0);

/// The camera of a file that has none.
pub fn default_camera() -> CameraPath {
    CameraPath {
        position: POSITION.into(),
        target: DVec3::ZERO.into(),
        up: DVec3::Y.into(),
        roll: Angle(0.0).into(),
        lens: Lens::Perspective { fov: FIELD_OF_VIEW.into() },
        path: Vec::new(),
    }
}

/// One camera.
pub fn camera(node: Node<'_>) -> Option<CameraPath> {
    let mut fields = Fields::of(node, "a camera")?;
    let position = fields.or("position", keyed(vector), POSITION);
    let target = fields.or("target", keyed(vector), DVec3::ZERO);
    let up = fields.or("up", keyed(direction), DVec3::Y);
    let roll = fields.or("roll", keyed(angle), Angle(0.0));
    let lens = fields.or("projection", projection, default_camera().lens);
    let path = fields.or("path", path, Vec::new());
    fields.finish();
    Some(CameraPath { position: position?, target: target?, up: up?, roll: roll?, lens: lens?, path: path? })
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
