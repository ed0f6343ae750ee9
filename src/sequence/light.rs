//! Decodes `lights`.

use super::colors::color;
use super::expand::{REPEAT, report_misplaced};
use super::fault::Fault;
use super::fields::Fields;
use super::keys::keyed;
use super::node::Node;
use super::values::{angle_between, not_negative, positive, switch, world_direction, world_vector};
use super::words::variant;
use crate::appearance::light::{Attenuation, LightKind, LightTracks};
use crate::base::color::Rgb;
use crate::base::math::{Angle, DVec3};
use crate::geometry::shape::spans_a_plane;
use crate::track::Animated;

/// Decodes a light.
pub fn light(node: Node<'_>) -> Option<LightTracks> {
    variant(
        node,
        "kind of light",
        &[
            ("Point", |node| punctual(node, "`Point`", point)),
            ("Spot", |node| punctual(node, "`Spot`", spot)),
            ("Directional", |node| punctual(node, "`Directional`", directional)),
            ("Sphere", |node| area(node, "`Sphere`", sphere)),
            ("Rectangle", |node| area(node, "`Rectangle`", rectangle)),
            // Repeated lights have been expanded, so this one is in a named value.
            (REPEAT, |node| {
                report_misplaced(node, node.head(), REPEAT);
                None
            }),
        ],
    )
}

/// Decodes the fields that one kind of light has alone.
type DecodeKind<'s> = fn(&mut Fields<'s>) -> Option<LightKind>;

/// Decodes a light without an area, whose shadows can be switched off.
fn punctual<'s>(node: Node<'s>, what: &'static str, kind: DecodeKind<'s>) -> Option<LightTracks> {
    let mut fields = Fields::of(node, what)?;
    let kind = kind(&mut fields);
    let shadows = fields.or("shadows", switch, true);
    let light = lit(fields, kind)?;
    Some(LightTracks { shadows: shadows?, ..light })
}

/// Decodes a light with an area. It casts shadows: paths also find it by chance, and then whatever is in between blocks it.
fn area<'s>(node: Node<'s>, what: &'static str, kind: DecodeKind<'s>) -> Option<LightTracks> {
    let mut fields = Fields::of(node, what)?;
    if fields.is_given("shadows") {
        let title = format!("{what} has no field `shadows`");
        let fault = Fault::new(fields.place("shadows"), title, "lights with an area always cast shadows");
        node.fault(fault.help("`Point`, `Spot` and `Directional` take `shadows: false`"));
        fields.pass_over("shadows");
    }
    let kind = kind(&mut fields);
    lit(fields, kind)
}

/// Decodes the fields that all lights have.
fn lit(mut fields: Fields<'_>, kind: Option<LightKind>) -> Option<LightTracks> {
    let color = fields.or("color", keyed(color), Rgb::ONE);
    let intensity = fields.or("intensity", keyed(not_negative), 1.0);
    let on = fields.or("on", keyed(switch), true);
    fields.finish();
    Some(LightTracks { kind: kind?, color: color?, intensity: intensity?, on: on?.into(), shadows: true })
}

fn point(fields: &mut Fields<'_>) -> Option<LightKind> {
    let position = fields.required("position", keyed(world_vector));
    let attenuation = fields.or("attenuation", attenuation, Attenuation::default());
    Some(LightKind::Point { position: position?, attenuation: attenuation? })
}

fn spot(fields: &mut Fields<'_>) -> Option<LightKind> {
    let position = fields.required("position", keyed(world_vector));
    let target = fields.or("target", keyed(world_vector), DVec3::ZERO);
    let angle = fields.or("angle", keyed(angle_between(0.0, 360.0)), Angle(45.0));
    let inner_angle = fields.optional("inner_angle", keyed(angle_between(0.0, 360.0)));
    let attenuation = fields.or("attenuation", attenuation, Attenuation::default());
    if let (Some(Animated::Constant(outer)), Some(Some(Animated::Constant(inner)))) = (&angle, &inner_angle)
        && inner.0 > outer.0
    {
        let title = "the `inner_angle` of a spot is at most its `angle`";
        let label = format!("{} degrees, of a cone of {}", inner.0, outer.0);
        let mut fault = Fault::new(fields.place("inner_angle"), title, label);
        if fields.has("angle") {
            fault = fault.also(fields.place("angle"), "the whole cone");
        }
        fields.node().fault(fault);
        return None;
    }
    Some(LightKind::Spot {
        position: position?,
        target: target?,
        angle: angle?,
        inner_angle: inner_angle?,
        attenuation: attenuation?,
    })
}

fn directional(fields: &mut Fields<'_>) -> Option<LightKind> {
    Some(LightKind::Directional { direction: fields.required("direction", keyed(world_direction))? })
}

fn sphere(fields: &mut Fields<'_>) -> Option<LightKind> {
    let center = fields.required("center", keyed(world_vector));
    let radius = fields.or("radius", keyed(positive), 1.0);
    Some(LightKind::Sphere { center: center?, radius: radius? })
}

fn rectangle(fields: &mut Fields<'_>) -> Option<LightKind> {
    let corner = fields.required("corner", keyed(world_vector));
    let (u, v) = (fields.required("u", keyed(world_vector)), fields.required("v", keyed(world_vector)));
    let one_sided = fields.or("one_sided", switch, false);
    let (u, v) = (u?, v?);
    if let (Animated::Constant(a), Animated::Constant(b)) = (&u, &v)
        && !spans_a_plane(*a, *b)
    {
        let label = "`u` and `v` are parallel, or one of them has no length";
        fields.node().fault(Fault::new(fields.place("v"), "this rectangle has no area", label));
        return None;
    }
    Some(LightKind::Rectangle { corner: corner?, u, v, one_sided: one_sided? })
}

/// Attenuation with distance.
fn attenuation(node: Node<'_>) -> Option<Attenuation> {
    let mut fields = Fields::of(node, "an attenuation")?;
    let [constant, linear, quadratic] = [("constant", 1.0), ("linear", 0.0), ("quadratic", 0.0)]
        .map(|(name, default)| fields.or(name, not_negative, default));
    fields.finish();
    Some(Attenuation { constant: constant?, linear: linear?, quadratic: quadratic? })
}
