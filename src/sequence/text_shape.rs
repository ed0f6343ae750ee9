//! Decodes `Text`: letters as a solid.

use super::fault::Fault;
use super::fields::Fields;
use super::font_files::font;
use super::mesh::CREASE;
use super::node::Node;
use super::values::{not_negative, one_of, positive, text};
use crate::base::math::UpAxis;
use crate::drawing::{Align, Font, OUTLINE_UNITS, text_outlines};
use crate::encode::listed_letters;
use crate::geometry::mesh::{Center, Normals, Preparation, TriangleMesh, extruded};
use crate::geometry::shape::Mesh;
use std::sync::Arc;

/// The name of the shape.
pub const TEXT: &str = "Text";
/// Letters at most.
const MAX_LETTERS: usize = 1000;
/// The usual depth relative to the height of a line.
const DEPTH: f64 = 0.2;

/// A text that stands on the ground and looks to the front.
pub fn text_solid(node: Node<'_>) -> Option<Mesh> {
    let mut fields = Fields::of_or_only(node, "`Text`", "text")?;
    let mut place = node.span();
    let words = fields.required("text", |node| {
        place = node.span();
        text(node)
    });
    let size = fields.or("size", positive, 1.0);
    let depth = fields.optional("depth", not_negative);
    let font = fields.or("font", font, Font::default());
    let sides = &[("Left", Align::Left), ("Center", Align::Center), ("Right", Align::Right)];
    let align = fields.or("align", one_of("alignment", sides), Align::Center);
    fields.finish();
    let (words, size, depth, font, align) = (words?, size?, depth?, font?, align?);
    let refuse = |title: String, label: &str| {
        node.fault(Fault::new(place.clone(), title, label));
        None
    };
    if let Some(letters) = listed_letters(&font.missing_glyphs(&words.lines().collect::<String>())) {
        return refuse(format!("the font does not have {letters}"), "cannot be shown");
    }
    if words.chars().count() > MAX_LETTERS {
        return refuse(format!("a text has at most {MAX_LETTERS} letters"), "longer than that");
    }
    let outlines = text_outlines(&font, &words, align);
    let depth = depth.unwrap_or(DEPTH * size);
    let mut data = extruded(&outlines, size / OUTLINE_UNITS, depth);
    let own = node.file.up.get();
    Preparation { up: (UpAxis::Y, own), center: Center::Origin, scale: 1.0, crease: Some(CREASE) }
        .apply(&mut data);
    match TriangleMesh::new(data) {
        Ok(mesh) => Some(Mesh::new(Arc::new(mesh), Normals::File)),
        Err(_) => refuse("this text has no letters that can be seen".to_owned(), "shows nothing"),
    }
}
