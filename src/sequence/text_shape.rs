//! Decodes `Text`: letters as a solid.

use super::fault::Fault;
use super::fields::Fields;
use super::font_files::font;
use super::mesh::CREASE;
use super::node::Node;
use super::values::{not_negative, one_of, positive, text};
use crate::base::digest::Digest;
use crate::base::math::UpAxis;
use crate::drawing::{Align, Font, OUTLINE_UNITS, text_outlines};
use crate::encode::listed_letters;
use crate::geometry::mesh::{Center, Normals, Preparation, TriangleMesh, extruded};
use crate::geometry::shape::Mesh;
use std::cell::RefCell;
use std::collections::HashMap;
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
    let key = TextKey {
        depth: depth.unwrap_or(DEPTH * size).to_bits(),
        size: size.to_bits(),
        font: Digest::of(&font),
        up: node.file.up.get(),
        text: words,
        align,
    };
    match node.file.texts.mesh(key, |key| mesh(key, &font)) {
        Some(mesh) => Some(Mesh::new(mesh, Normals::File)),
        None => refuse("this text has no letters that can be seen".to_owned(), "shows nothing"),
    }
}

/// The solid of a text. None if no letter can be seen.
fn mesh(key: &TextKey, font: &Font) -> Option<TriangleMesh> {
    let (size, depth) = (f64::from_bits(key.size), f64::from_bits(key.depth));
    let outlines = text_outlines(font, &key.text, key.align);
    let mut data = extruded(&outlines, size / OUTLINE_UNITS, depth);
    Preparation { up: (UpAxis::Y, key.up), center: Center::Origin, scale: 1.0, crease: Some(CREASE) }
        .apply(&mut data);
    TriangleMesh::new(data).ok()
}

/// What the mesh of a text depends on.
#[derive(PartialEq, Eq, Hash)]
struct TextKey {
    text: String,
    /// The bits of the numbers.
    size: u64,
    depth: u64,
    font: Digest,
    align: Align,
    up: UpAxis,
}

/// The meshes of the texts of a sequence, each made once.
#[derive(Default)]
pub struct TextMeshes(RefCell<HashMap<TextKey, Option<Arc<TriangleMesh>>>>);

impl TextMeshes {
    fn mesh(
        &self,
        key: TextKey,
        make: impl FnOnce(&TextKey) -> Option<TriangleMesh>,
    ) -> Option<Arc<TriangleMesh>> {
        self.0.borrow_mut().entry(key).or_insert_with_key(|key| make(key).map(Arc::new)).clone()
    }
}
