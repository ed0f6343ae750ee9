//! `lights`: what shines.

use super::colors::color;
use super::fields::Fields;
use super::keys::keyed;
use super::node::Node;
use super::values::{not_negative, switch, vector};
use super::words::variant;
use crate::color::Rgb;
use crate::light::{LightKind, LightTracks};

/// One light.
pub fn light(node: Node<'_>) -> Option<LightTracks> {
    variant(node, "kind of light", &[("Point", point)])
}

fn point(node: Node<'_>) -> Option<LightTracks> {
    let mut fields = Fields::of(node, "`Point`")?;
    let position = fields.required("position", keyed(vector));
    let color = fields.or("color", keyed(color), Rgb::ONE);
    let intensity = fields.or("intensity", keyed(not_negative), 1.0);
    let on = fields.or("on", keyed(switch), true);
    fields.finish();
    let kind = LightKind::Point { position: position? };
    Some(LightTracks { kind, color: color?, intensity: intensity?, on: on? })
}
