//! Decodes `translation`, `rotation`, `scale` and `pivot` of an object.

use super::fault::Fault;
use super::fields::Fields;
use super::keys::keyed;
use super::node::{Node, NodeContent};
use super::poses::{object_poses, posed};
use super::schema::Ask;
use super::values::{angle, direction, each, number, tuple, vector};
use super::words::{Variants, variant};
use crate::base::math::{self, Angle, DQuat, DVec3};
use crate::geometry::transform::{Rotation, TransformTracks};
use crate::track::Animated;

/// Decodes the transform among the fields of an object.
pub fn transform(fields: &mut Fields<'_>) -> Option<TransformTracks> {
    let translation = fields.or("translation", keyed(vector), DVec3::ZERO);
    let rotation = fields.or("rotation", rotation, TransformTracks::default().rotation);
    let scale = fields.or("scale", scale, DVec3::ONE);
    let pivot = fields.or("pivot", vector, DVec3::ZERO);
    let poses = fields.optional("poses", object_poses);
    let (translation, rotation, scale, pivot) = (translation?, rotation?, scale?, pivot?);
    let given = TransformTracks { translation, rotation, scale, pivot, motion: None, explode: None };
    let Some(poses) = poses? else { return Some(given) };
    let replaced: &[&str] = match &poses.scale {
        Some(_) => &["translation", "rotation", "scale", "pivot"],
        None => &["translation", "rotation"],
    };
    if let Some(other) = replaced.iter().find(|name| fields.has(name)) {
        let fault = Fault::new(fields.place(other), format!("`poses` replaces `{other}`"), "one too many");
        let fault = fault.also(fields.place("poses"), "the place of the object is given here");
        fields.node().fault(fault.help("to move a posed object further, give it a `Group` as its parent"));
        return None;
    }
    Some(posed(poses, given))
}

/// One factor, or one for each axis. A constant 0 is refused, because the object would never be visible. Keys may pass
/// through 0.
fn scale(node: Node<'_>) -> Option<Animated<DVec3>> {
    let scale = keyed(factors)(node)?;
    if let Animated::Constant(factors) = scale
        && factors.to_array().contains(&0.0)
    {
        let fault = Fault::new(node.span(), "a constant scale of 0 leaves nothing", "must not be 0");
        node.fault(fault.help("to hide an object use `visible: false`; a keyed scale may pass through 0"));
        return None;
    }
    Some(scale)
}

fn factors(node: Node<'_>) -> Option<DVec3> {
    if node.opens_with('(') {
        return vector(node);
    }
    if node.opens_with('{') || node.opens_with('[') || !node.word().is_empty() || node.is_text() {
        node.expected("a factor, or one for each axis (x, y, z)");
        return None;
    }
    number(node).map(DVec3::splat)
}

fn rotation(node: Node<'_>) -> Option<Rotation> {
    if node.opens_with('(') || node.opens_with('[') {
        let help = "for angles about x, y and z write Euler(x: 0, y: 90, z: 0); each of them takes keys";
        node.fault(node.mismatch("`AxisAngle`, `Euler` or `Quaternion`").help(help));
        return None;
    }
    let table: &Variants<'_, Rotation> =
        &[("AxisAngle", axis_angle), ("Euler", euler), ("Quaternion", quaternion)];
    variant(node, "rotation", table)
}

/// A rotation, or an angle around `axis`.
pub fn turn<'s>(axis: DVec3) -> impl Fn(Node<'s>) -> Option<Rotation> {
    move |node| match node.begins_with("Track") || node.word().is_empty() {
        true => keyed(angle)(node).map(|angle| Rotation::AxisAngle { axis: axis.into(), angle }),
        false => rotation(node),
    }
}

fn axis_angle(node: Node<'_>) -> Option<Rotation> {
    let mut fields = Fields::of(node, "`AxisAngle`")?;
    let axis = fields.required("axis", keyed(direction));
    let angle = fields.required("angle", keyed(angle));
    fields.finish();
    Some(Rotation::AxisAngle { axis: axis?, angle: angle? })
}

fn euler(node: Node<'_>) -> Option<Rotation> {
    let mut fields = Fields::of(node, "`Euler`")?;
    let [x, y, z] = ["x", "y", "z"].map(|name| fields.or(name, keyed(angle), Angle(0.0)));
    fields.finish();
    Some(Rotation::Euler { x: x?, y: y?, z: z? })
}

/// `Quaternion((x, y, z, w))`, or keys of such tuples.
fn quaternion(node: Node<'_>) -> Option<Rotation> {
    match node.content()? {
        NodeContent::Tuple(items) if items.len() == 1 => {
            node.ask(|| Ask::Tuple { what: "a quaternion".to_owned(), count: 1 });
            keyed(unit_quaternion)(items[0]).map(Rotation::Quaternion)
        }
        _ => {
            node.expected("Quaternion((x, y, z, w)) or Quaternion([keys])");
            None
        }
    }
}

fn unit_quaternion(node: Node<'_>) -> Option<DQuat> {
    let parts = each(tuple(node, "four numbers (x, y, z, w)")?, number)?;
    let rotation = math::unit_quaternion(parts);
    if rotation.is_none() {
        let fault = node.mismatch("a quaternion (x, y, z, w)").label("is zero, which is no rotation");
        node.fault(fault.help("(0, 0, 0, 1) is no turn"));
    }
    rotation
}
