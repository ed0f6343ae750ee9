//! Decodes `Mesh`: from a file, or inline.

use super::colors::color;
use super::fault::Fault;
use super::fields::Fields;
use super::mesh_series::{is_list, series};
use super::node::{Node, NodeContent};
use super::shape_tracks::ShapeTracks;
use super::suggest::shortened;
use super::values::{
    PATHS, angle_between, each, file_path, list, number, positive, tuple, up_axis, vector, whole,
};
use super::words::word;
use super::{Named, Object, Sequence};
use crate::base::math::{Angle, DVec2, DVec3};
use crate::base::time::Time;
use crate::geometry::mesh::{self, Center, Corners, MeshData, NO_FILE, Normals, Preparation};
use crate::geometry::shape::{Mesh, Shape};
use std::collections::HashSet;
use std::ops::Range;
use std::sync::Arc;

/// Decodes a mesh from these fields.
pub fn mesh(fields: &mut Fields<'_>) -> Option<(Mesh, Option<ShapeTracks>)> {
    if fields.has("series") {
        only_without(fields, "series", &["file", "vertices", "triangles", "uvs", "colors"]);
        let series = series(fields)?;
        return Some((series.named(Time::from_integer(0)), Some(ShapeTracks::Series(series))));
    }
    only_without(fields, "file", &INLINE);
    let mesh = if fields.has("file") { from_file(fields) } else { inline(fields) };
    only_with(fields, "series", &["at", "numbers", "between", "repeat"]);
    mesh.map(|mesh| (mesh, None))
}

/// Reports fields that a mesh with the field `name` has no use for.
fn only_without(fields: &mut Fields<'_>, name: &str, others: &[&'static str]) {
    let given: Vec<_> = others.iter().copied().filter(|other| fields.has(other)).collect();
    if let (true, [first, ..]) = (fields.has(name), &given[..]) {
        let title = "a mesh is read from a file, from a series of files, or written out";
        let label = format!("only for a mesh without `{name}`");
        fields.node().fault(Fault::new(fields.place(first), title, label));
        given.into_iter().for_each(|other| fields.ignore(other));
    }
}

/// Reports fields that only a mesh with the field `name` has.
fn only_with(fields: &mut Fields<'_>, name: &str, others: &[&'static str]) {
    let given: Vec<_> = others.iter().copied().filter(|other| fields.has(other)).collect();
    for other in given {
        let title = format!("`{other}` belongs to a series of meshes");
        let label = format!("only for a mesh with `{name}`");
        fields.node().fault(Fault::new(fields.place(other), title, label));
        fields.ignore(other);
    }
}

/// A mesh that has the field `file`.
fn from_file(fields: &mut Fields<'_>) -> Option<Mesh> {
    let preparation = preparation(fields);
    let normals = fields.optional("normals", |node| shading(node, KINDS));
    let mesh = fields.required("file", |node| {
        let crease = normals.flatten().and_then(Shading::crease);
        file(node, &Preparation { crease, ..preparation.unwrap_or_default() })
    });
    preparation?;
    let (mesh, place) = (mesh?, fields.place("normals"));
    let given = if mesh.has_normals() { Normals::File } else { Normals::Flat };
    let normals = normals?.map_or(given, Shading::normals);
    if normals == Normals::File && !mesh.has_normals() {
        let fault = Fault::new(place, "the mesh has no normals of its own", "there are none in the file");
        fields.node().fault(fault.help("`Smooth` computes some; `Flat` needs none"));
        return None;
    }
    Some(placed(mesh, normals))
}

/// The place of the file's name, or of the whole value if the mesh is inline.
pub fn file_place(node: Node<'_>) -> Range<usize> {
    let file = match node.content() {
        Some(NodeContent::Tuple(items)) => items.first().copied(),
        Some(NodeContent::Fields(fields)) => {
            fields.into_iter().find(|(name, _)| ["file", "series"].contains(name)).map(|(_, value)| value)
        }
        _ => None,
    };
    file.map_or_else(|| node.head(), |file| file.span())
}

/// Kinds of normals as files name them.
#[derive(Clone, Copy)]
pub enum Shading {
    Kind(Normals),
    /// Smooth except at creases of more than this angle.
    Crease(Angle),
}

impl Shading {
    pub fn crease(self) -> Option<Angle> {
        if let Self::Crease(angle) = self { Some(angle) } else { None }
    }

    /// Crease normals replace those of the file.
    pub fn normals(self) -> Normals {
        if let Self::Kind(normals) = self { normals } else { Normals::File }
    }
}

/// The angle of `Crease` without fields: it keeps chamfers of 45 degrees sharp, and smooths cylinders of twelve sides.
pub const CREASE: Angle = Angle(40.0);

pub const KINDS: &[(&str, Shading)] = &[
    ("File", Shading::Kind(Normals::File)),
    ("Smooth", Shading::Kind(Normals::Smooth)),
    ("Flat", Shading::Kind(Normals::Flat)),
    ("Crease", Shading::Crease(CREASE)),
];

/// One of these kinds, or `Crease(angle: 40)`.
pub fn shading(node: Node<'_>, kinds: &[(&'static str, Shading)]) -> Option<Shading> {
    if !node.begins_with("Crease") {
        return word(node, "kind of normals", kinds);
    }
    let mut fields = Fields::of(node, "`Crease`")?;
    let angle = fields.or("angle", angle_between(0.0, 180.0), CREASE);
    fields.finish();
    angle.map(Shading::Crease)
}

/// The fields that change the coordinates of a mesh.
pub fn preparation(fields: &mut Fields<'_>) -> Option<Preparation> {
    let own = fields.node().file.up.get();
    let up = fields.or("up", up_axis, own);
    let scale = fields.or("scale", positive, 1.0);
    let centers = &[("Bounds", Center::Bounds), ("Base", Center::Base)];
    let center = fields.or("center", |node| word(node, "centre", centers), Center::Origin);
    Some(Preparation { up: (up?, own), center: center?, scale: scale?, crease: None })
}

/// The fields of an inline mesh, except its normals.
const INLINE: [&str; 4] = ["vertices", "triangles", "uvs", "colors"];

/// Computes smooth normals while loading, where progress is displayed, instead of in the first frame.
fn placed(mesh: Arc<mesh::TriangleMesh>, normals: Normals) -> Mesh {
    if normals == Normals::Smooth {
        mesh.smooth_normals();
    }
    Mesh::new(mesh, normals)
}

/// The mesh in the file with the quoted name.
fn file(node: Node<'_>, preparation: &Preparation) -> Option<Arc<mesh::TriangleMesh>> {
    let name = file_path(node)?;
    match node.file.meshes.mesh(&name, preparation) {
        Ok(mesh) => Some(mesh),
        Err(why) => {
            let title = format!("cannot read the mesh {:?}", shortened(&name));
            let (missing, lists) = (why == NO_FILE, is_list(&name));
            let fault = Fault::new(node.span(), title, why);
            node.fault(match (missing, lists) {
                (true, _) => fault.help(PATHS),
                (_, true) => fault.help(format!("write Mesh(series: {:?})", shortened(&name))),
                _ => fault,
            });
            None
        }
    }
}

/// A list of normals, or a kind of normals.
enum NormalsField {
    Listed(Vec<DVec3>),
    Shading(Shading),
}

fn inline(fields: &mut Fields<'_>) -> Option<Mesh> {
    if !INLINE.into_iter().any(|name| fields.has(name)) {
        INLINE.into_iter().for_each(|name| fields.ignore(name));
        ["normals", "up", "scale", "center"].into_iter().for_each(|name| fields.ignore(name));
        let title = "`Mesh` has no `file`";
        let fault = Fault::new(fields.node().head(), title, "needs a file, or `vertices` and `triangles`");
        fields.node().fault(fault.help("write Mesh(\"name.obj\") for the mesh in a file"));
        return None;
    }
    let vertices = fields.required("vertices", |node| list(node, "points", vector));
    let count = vertices.as_ref().map(Vec::len);
    let triangles = fields.required("triangles", |node| triangles(node, count));
    let normals = fields.or(
        "normals",
        |node| normals(node, count),
        NormalsField::Shading(Shading::Kind(Normals::Flat)),
    );
    let uvs = fields.optional("uvs", |node| per_vertex(node, "texture coordinates", count, uv));
    let colors = fields.optional("colors", |node| per_vertex(node, "colours", count, color));
    let preparation = preparation(fields);
    let (kind, crease, listed) = match normals? {
        NormalsField::Shading(shading) => (shading.normals(), shading.crease(), None),
        NormalsField::Listed(listed) => (Normals::File, None, Some(listed)),
    };
    let as_f32 = |normals: Vec<DVec3>| normals.into_iter().map(|n| n.normalize_or_zero().as_vec3()).collect();
    let mut parts = MeshData {
        positions: vertices?,
        triangles: triangles?,
        normals: listed.map(|normals| Corners::per_vertex(as_f32(normals))),
        uvs: uvs?.map(Corners::per_vertex),
        colors: colors?.unwrap_or_default(),
        ..MeshData::default()
    };
    Preparation { crease, ..preparation? }.apply(&mut parts);
    match mesh::TriangleMesh::new(parts) {
        Ok(mesh) => Some(placed(Arc::new(mesh), kind)),
        Err(error) => {
            let fault = Fault::new(fields.node().head(), "this mesh cannot be seen", error.to_string());
            fields.node().fault(fault);
            None
        }
    }
}

fn triangles(node: Node<'_>, count: Option<usize>) -> Option<Vec<[u32; 3]>> {
    if let Some(count) = count.filter(|count| *count < 3) {
        let there = ["`vertices` has none", "`vertices` has one", "`vertices` has two"][count];
        node.fault(Fault::new(node.span(), "a triangle has three vertices", there));
        return None;
    }
    // If the vertices are missing, a fault is already reported, so any index is accepted.
    let last = count.map_or(u32::MAX - 1, |count| count as u32 - 1);
    list(node, "triangles", |node| each(tuple(node, "three vertices (a, b, c)")?, whole(0..=last)))
}

fn normals(node: Node<'_>, count: Option<usize>) -> Option<NormalsField> {
    if node.opens_with('[') {
        return per_vertex(node, "normals", count, vector).map(NormalsField::Listed);
    }
    shading(node, &KINDS[1..]).map(NormalsField::Shading)
}

fn uv(node: Node<'_>) -> Option<DVec2> {
    each(tuple(node, "two numbers (u, v)")?, number).map(DVec2::from_array)
}

/// A list with one entry for each vertex.
fn per_vertex<'s, T>(
    node: Node<'s>,
    what: &str,
    count: Option<usize>,
    decode: impl Fn(Node<'s>) -> Option<T>,
) -> Option<Vec<T>> {
    let values = list(node, what, decode)?;
    if count.is_some_and(|count| count != values.len()) {
        let expected = format!("as many {what} as vertices, {}", count.unwrap_or_default());
        node.fault(Fault::expected(node.span(), expected, format!("found {}", values.len())));
        return None;
    }
    Some(values)
}

#[warn(missing_docs)]
impl Sequence {
    /// The different meshes, each with the first object that uses it. Of a series, the first mesh.
    pub fn meshes(&self) -> Vec<(&str, &mesh::TriangleMesh)> {
        let mut meshes: Vec<(&str, &mesh::TriangleMesh)> = Vec::new();
        let mut seen = HashSet::new();
        for Named { name, value: Object { shape, .. } } in &self.objects {
            if let Shape::Mesh(Mesh { mesh, .. }) = shape
                && seen.insert(Arc::as_ptr(mesh))
            {
                meshes.push((name, mesh));
            }
        }
        meshes
    }
}
