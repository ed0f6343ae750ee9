//! Decodes `fog`.

use super::colors::color;
use super::fields::Fields;
use super::keys::keyed;
use super::node::Node;
use super::values::{not_negative, number, positive};
use crate::appearance::fog::{FalloffTracks, FogTracks};
use crate::base::color::Rgb;

/// The fog of a sequence.
pub fn fog(node: Node<'_>) -> Option<FogTracks> {
    let mut fields = Fields::of(node, "the fog")?;
    let color = fields.or("color", keyed(color), Rgb::splat(0.5));
    let density = fields.required("density", keyed(not_negative));
    let falloff = fields.optional("falloff", falloff);
    fields.finish();
    Some(FogTracks { color: color?, density: density?, falloff: falloff? })
}

fn falloff(node: Node<'_>) -> Option<FalloffTracks> {
    let mut fields = Fields::of(node, "the fog's falloff")?;
    let base = fields.or("base", keyed(number), 0.0);
    let height = fields.required("height", keyed(positive));
    fields.finish();
    Some(FalloffTracks { base: base?, height: height? })
}
