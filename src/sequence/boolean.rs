//! Decodes solids made of solids: `Difference`, `Intersection` and `Union`.

use super::fault::Fault;
use super::fields::Fields;
use super::node::Node;
use super::shape::shape;
use super::text_shape::TEXT;
use super::values::list;
use crate::geometry::shape::{Geometric, Operation, Shape, Solid, encloses, part_count};

/// The words for solids made of others.
pub const OPERATIONS: &[(&str, Operation)] = &[
    (Solid::NAME, Operation::Difference),
    ("Intersection", Operation::Intersection),
    ("Union", Operation::Union),
];

/// The most parts of a solid, with those of its parts. Each ray tests all of them.
const MOST: usize = 256;

/// The solid of these fields.
pub fn solid(fields: &mut Fields<'_>, operation: Operation) -> Option<Solid> {
    Some(Solid::new(operation, fields.required("of", operands)?))
}

fn operands(node: Node<'_>) -> Option<Vec<Shape>> {
    let parts = list(node, "solids", operand)?;
    let all: usize = parts.iter().map(Shape::solid_count).sum();
    let (title, label) = match parts.len() {
        0 | 1 => ("this list has the wrong length", "needs at least two solids".to_owned()),
        _ if all > MOST => {
            ("this solid has too many parts", format!("{all} parts with those of its parts; at most {MOST}"))
        }
        // Parts of meshes count too. Planes of a cut need a few numbers more.
        _ if parts.iter().map(|part| u64::from(part_count(part))).sum::<u64>() > u64::from(u32::MAX / 2) => {
            ("this solid has too many parts", "more than 2 billion triangles".to_owned())
        }
        _ => return Some(parts),
    };
    node.fault(Fault::new(node.span(), title, label));
    None
}

fn operand(node: Node<'_>) -> Option<Shape> {
    let one = shape(node)?;
    let title = "only what encloses a volume can be part of a solid";
    let (label, help) = match &one.shape {
        Shape::Mesh(_) if one.tracks.is_some() => ("changes over time", "use a mesh of a single file"),
        Shape::Mesh(_) if node.word() == TEXT && !encloses(&one.shape) => {
            ("is flat", "give the text a `depth`")
        }
        Shape::Mesh(_) if !encloses(&one.shape) => ("has open edges", "close the holes of the mesh"),
        Shape::Cylinder(_) | Shape::Cone(_) if !encloses(&one.shape) => {
            ("is open", "leave out `capped: false`")
        }
        Shape::Particles(_) => {
            ("particles cannot be parts", "write spheres, or use `clip` to cut particles open")
        }
        Shape::Group => ("is a group", "write a shape"),
        _ if !encloses(&one.shape) => {
            ("encloses nothing", "use a solid, such as a Box instead of a Rectangle")
        }
        _ => return Some(one.shape),
    };
    node.fault(Fault::new(node.head(), title, label).help(help));
    None
}
