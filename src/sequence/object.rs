//! `objects`: shapes with a material, a place and a parent.

use super::fault::Fault;
use super::fields::Fields;
use super::keys::keyed;
use super::material::{Given, is_material, material, resembles_a_kind};
use super::mesh::file_place;
use super::mtl::{Own, own_materials};
use super::names::{Entry, Names};
use super::node::Node;
use super::reach::TransformPlace;
use super::shape::shape;
use super::suggest::shortened;
use super::transform::transform;
use super::values::switch;
use crate::geometry::shape::{Mesh, Shape};
use crate::geometry::transform::TransformTracks;
use crate::track::Animated;
use std::ops::Range;

/// An object whose material is not yet an index.
pub struct Draft {
    pub shape: Shape,
    pub material: Surface,
    pub transform: TransformTracks,
    pub visible: Animated<bool>,
    pub place: TransformPlace,
}

/// Where an object's material comes from.
pub enum Surface {
    Default,
    /// Index into the named materials.
    Named(usize),
    Inline(Box<Given>),
    /// Those that came with the mesh.
    Own(Own),
}

/// The parent that an object names.
#[derive(Clone)]
pub struct Parent {
    pub index: usize,
    pub place: Range<usize>,
}

/// One object, and the parent it names. The parent is known even if something else is wrong.
pub fn object(node: Node<'_>, materials: &Names<'_>, objects: &Names<'_>) -> (Option<Draft>, Option<Parent>) {
    let Some(mut fields) = Fields::of(node, "an object") else { return (None, None) };
    let mut place = fields.place("shape");
    let shape = fields.required("shape", |node| {
        let shape = shape(node)?;
        if let Shape::Mesh(_) = shape {
            place = file_place(node);
        }
        Some(shape)
    });
    let material = fields.or("material", |node| surface(node, materials), Surface::Default);
    let material = match (&shape, material) {
        (Some(Shape::Mesh(mesh)), Some(Surface::Default)) => own(node, place, mesh),
        (_, material) => material,
    };
    let place_of = |name| fields.place(name);
    let placed = TransformPlace { scale: place_of("scale"), translation: place_of("translation") };
    let transform = transform(&mut fields);
    let visible = fields.or("visible", keyed(switch), true);
    let parent = fields
        .optional("parent", |node| objects.index(node).map(|index| Parent { index, place: node.span() }));
    fields.finish();
    let draft = || {
        let (Some(_), shape) = (&parent, shape?) else { return None };
        Some(Draft { shape, material: material?, transform: transform?, visible: visible?, place: placed })
    };
    (draft(), parent.flatten())
}

/// What a mesh without a material is made of.
fn own(node: Node<'_>, place: Range<usize>, shape: &Mesh) -> Option<Surface> {
    let mesh = &shape.mesh;
    let any = !mesh.materials().is_empty() || mesh.has_colors();
    if any {
        node.file.meshes.own(mesh, || own_materials(node, &place, mesh)).map(Surface::Own)
    } else {
        Some(Surface::Default)
    }
}

fn surface(node: Node<'_>, materials: &Names<'_>) -> Option<Surface> {
    if node.is_text() {
        return materials.index(node).map(Surface::Named);
    }
    let misspelt = |word: &str| !materials.has(word) && resembles_a_kind(word);
    if is_material(node) || node.bare_word().is_some_and(misspelt) {
        return material(node).map(|given| Surface::Inline(Box::new(given)));
    }
    let fault = node.mismatch("a material's name in quotes, its fields in ( ), or a kind such as Metal( )");
    node.fault(match node.bare_word() {
        Some(word) => fault.help(format!("write \"{}\"", shortened(word))),
        None => fault,
    });
    None
}

/// Reports parents that lead in a circle, each circle once.
pub fn report_circles(node: Node<'_>, names: &[Entry<'_>], parents: &[Option<Parent>]) {
    // 0: not visited; otherwise the number of the walk that came by first.
    let mut walks = vec![0usize; parents.len()];
    for start in 0..parents.len() {
        let mut at = start;
        while walks[at] == 0 {
            walks[at] = start + 1;
            let Some(parent) = &parents[at] else { break };
            at = parent.index;
            if walks[at] == start + 1 {
                report_circle(node, names, parents, at);
            }
        }
    }
}

fn report_circle(node: Node<'_>, names: &[Entry<'_>], parents: &[Option<Parent>], on: usize) {
    // The circle is told from its first object in the file.
    let round = |from: usize| {
        std::iter::successors(Some(from), |&at| parents[at].as_ref().map(|parent| parent.index))
            .take(parents.len())
            .enumerate()
            .take_while(move |&(step, at)| step == 0 || at != from)
            .map(|(_, at)| at)
    };
    let first = round(on).min().unwrap_or(on);
    let Some(parent) = &parents[first] else { return };
    let way: Vec<String> = round(first).take(8).map(|at| format!("`{}`", names[at].name)).collect();
    let way = match round(first).count() {
        1 => "an object cannot be its own parent".to_owned(),
        2..=8 => format!("the way up is {} and `{}` again", way.join(", "), names[first].name),
        more => format!("the way up is {} and {} more", way.join(", "), more - 8),
    };
    node.fault(Fault::new(parent.place.clone(), "parents lead in a circle", way));
}
