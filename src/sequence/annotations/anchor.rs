//! Decodes the points to which annotations are tied.

use super::common::pair;
use super::scene_names::SceneNames;
use crate::annotate::{Anchor, ObjectPoint};
use crate::base::math::{DVec3, UpAxis};
use crate::geometry::shape::{self, Shape};
use crate::sequence::Object;
use crate::sequence::fault::Fault;
use crate::sequence::fields::Fields;
use crate::sequence::keys::keyed;
use crate::sequence::node::{Node, NodeContent};
use crate::sequence::schema::Ask;
use crate::sequence::values::{vector, whole, world_vector};
use crate::sequence::words::word;

/// A point: `(x, y, z)` or keys, `Object("name")`, or `Screen(x, y)`.
pub fn anchor<'s>(scene: &SceneNames<'_>) -> impl Fn(Node<'s>) -> Option<Anchor> {
    move |node| {
        node.ask_words("point", ["Object", "Screen", "Track"]);
        any_anchor(node, scene)
    }
}

/// [`anchor`] for points of the world.
pub fn world_anchor<'s>(scene: &SceneNames<'_>) -> impl Fn(Node<'s>) -> Option<Anchor> {
    move |node| {
        node.ask_words("point of the world", ["Object", "Track"]);
        if node.word() == "Screen" {
            node.expected("a point of the world: (x, y, z) or Object(\"name\")");
            return None;
        }
        any_anchor(node, scene)
    }
}

fn any_anchor(node: Node<'_>, scene: &SceneNames<'_>) -> Option<Anchor> {
    match node.word() {
        "Object" => object_point(node, scene),
        "Screen" => screen(node),
        "" | "Track" if !node.is_text() => keyed(world_vector)(node).map(Anchor::World),
        _ => {
            let fault = node.mismatch("a point (x, y, z), Object(\"name\") or Screen(x, y)");
            node.fault(match node.is_text() {
                true => fault.help(format!("write Object({}) for a point of an object", node.text())),
                false => fault,
            });
            None
        }
    }
}

/// Shares of the picture's width and height.
fn screen(node: Node<'_>) -> Option<Anchor> {
    let keys = match node.content()? {
        NodeContent::Tuple(items) => {
            node.ask(|| Ask::Tuple { what: "a place".to_owned(), count: 1 });
            <[Node<'_>; 1]>::try_from(items).ok()
        }
        _ => None,
    };
    match keys {
        Some([keys]) => keyed(pair)(keys).map(Anchor::Screen),
        None => pair(node).map(|place| Anchor::Screen(place.into())),
    }
}

fn object_point(node: Node<'_>, scene: &SceneNames<'_>) -> Option<Anchor> {
    let mut fields = Fields::of_or_only(node, "`Object`", "name")?;
    let index = fields.required("name", |node| scene.object(node));
    let places = ["side", "point", "vertex"].map(|name| fields.has(name).then(|| fields.place(name)));
    let side = fields.optional("side", side);
    let point = fields.optional("point", vector);
    let vertex = fields.optional("vertex", |node| vertex(node, index.map(|index| scene.object_at(index))));
    fields.finish();
    let given: Vec<_> = places.into_iter().flatten().collect();
    if let [first, second, ..] = &given[..] {
        let title = "a point of an object is given by `side`, `point` or `vertex`";
        node.fault(
            Fault::new(second.clone(), title, "one too many").also(first.clone(), "the other one is here"),
        );
        return None;
    }
    let place = match (side?, point?, vertex?) {
        (Some(side), ..) => ObjectPoint::Box(side),
        (_, Some(point), _) | (.., Some(point)) => ObjectPoint::Point(point),
        _ => ObjectPoint::Box(DVec3::ZERO),
    };
    Some(Anchor::Object(index?, place))
}

/// A side of a box, or a vector whose parts go from -1 to 1.
fn side(node: Node<'_>) -> Option<DVec3> {
    if node.opens_with('(') && node.word().is_empty() {
        let side = vector(node)?;
        if side.abs().max_element() > 1.0 {
            node.expected("a place in the box: numbers from -1 to 1 (x, y, z)");
            return None;
        }
        return Some(side);
    }
    let named = [
        ("Center", DVec3::ZERO),
        ("Right", DVec3::X),
        ("Left", DVec3::NEG_X),
        ("Top", DVec3::Y),
        ("Bottom", DVec3::NEG_Y),
        ("Front", DVec3::Z),
        ("Back", DVec3::NEG_Z),
    ];
    let up: UpAxis = node.file.up.get();
    word(node, "side", &named).map(|side| up.from_y_up(side))
}

/// The place of a vertex of a mesh. `object` is None if the name of the object is wrong.
fn vertex(node: Node<'_>, object: Option<Option<&Object>>) -> Option<DVec3> {
    let index = whole(0..=u32::MAX)(node)?;
    let object = object?;
    if object.is_some_and(|object| object.tracks.is_some()) {
        let title = "a vertex of a series has no place of its own: each file has other vertices";
        let fault = Fault::new(node.span(), title, "not one mesh");
        node.fault(fault.help("write a point of the world with keys, or a `side` of the box"));
        return None;
    }
    let Some(Shape::Mesh(shape::Mesh { mesh, .. })) = object.map(|object| &object.shape) else {
        node.fault(Fault::new(node.span(), "only meshes have vertices", "this object is no mesh"));
        return None;
    };
    let found = mesh.positions().get(index as usize).copied();
    if found.is_none() {
        node.expected(format!("a whole number from 0 to {}", mesh.positions().len().saturating_sub(1)));
    }
    found
}
