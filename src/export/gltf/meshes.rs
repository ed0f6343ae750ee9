//! Shapes as meshes. Equal shapes of the same materials share one.

use super::Exporter;
use super::document::ViewTarget;
use super::materials::MaterialIndices;
use crate::appearance::material::MaterialBinding;
use crate::base::digest::Digest;
use crate::base::math::DVec3;
use crate::export::tessellate::{Tessellation, tessellated};
use crate::geometry::shape::{Cuboid, Shape, Sphere};
use crate::sequence::Object;
use serde_json::{Value, json};
use std::collections::HashMap;

/// Where a mesh is in the space of its object: scaled, then moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    pub translation: DVec3,
    pub scale: DVec3,
}

/// The meshes of a file so far.
#[derive(Default)]
pub struct Meshes {
    known: HashMap<(Digest, Digest), usize>,
    pub triangles: usize,
}

impl Meshes {
    /// The index of the mesh of an object and its place; none if it shows nothing.
    pub fn of(
        &mut self,
        exporter: &mut Exporter<'_>,
        object: &Object,
        materials: &MaterialIndices,
    ) -> Option<(usize, Placement)> {
        let (shape, placement) = canonical(&object.shape);
        let key = (Digest::of(&shape), Digest::of(&object.made_of));
        if let Some(mesh) = self.known.get(&key) {
            return Some((*mesh, placement));
        }
        let triangles = tessellated(&shape, exporter.options.tolerance, exporter.reach)?;
        if matches!(shape, Shape::Plane(_)) {
            exporter.left_out.note_of("all but a large square", "infinite plane");
        }
        self.triangles += triangles.groups.iter().map(|(_, group)| group.len()).sum::<usize>();
        let mesh = write(exporter, &triangles, object.made_of, materials);
        self.known.insert(key, mesh);
        Some((mesh, placement))
    }
}

/// The shape that others share, and its place: spheres and boxes differ only in place and size.
fn canonical(shape: &Shape) -> (Shape, Placement) {
    let as_it_is = Placement { translation: DVec3::ZERO, scale: DVec3::ONE };
    match shape {
        Shape::Sphere(Sphere { center, radius }) => {
            let placement = Placement { translation: *center, scale: DVec3::splat(*radius) };
            (Shape::Sphere(Sphere { center: DVec3::ZERO, radius: 1.0 }), placement)
        }
        // Flat boxes have no inverse scale.
        Shape::Cuboid(Cuboid { min, max }) if (*max - *min).min_element() > 0.0 => {
            let placement = Placement { translation: (*min + *max) * 0.5, scale: (*max - *min) * 0.5 };
            (Shape::Cuboid(Cuboid { min: DVec3::NEG_ONE, max: DVec3::ONE }), placement)
        }
        _ => (shape.clone(), as_it_is),
    }
}

impl Exporter<'_> {
    /// Adds the mesh of a shape with a material of the file.
    pub fn single_mesh(&mut self, shape: &Shape, material: usize) -> Option<usize> {
        let triangles = tessellated(shape, self.options.tolerance, self.reach)?;
        let materials = MaterialIndices::only(material);
        Some(write(self, &triangles, MaterialBinding::One(0), &materials))
    }
}

fn write(
    exporter: &mut Exporter<'_>,
    mesh: &Tessellation,
    made_of: MaterialBinding,
    materials: &MaterialIndices,
) -> usize {
    let Exporter { document, .. } = exporter;
    let target = Some(ViewTarget::Vertices);
    let all = || mesh.vertices.iter();
    let mut attributes =
        json!({ "POSITION": document.floats(all().map(|v| v.position.to_array()), target, true) });
    if mesh.has.normals {
        attributes["NORMAL"] = json!(document.floats(all().map(|v| v.normal.to_array()), target, false));
    }
    if mesh.has.uvs {
        // v points downwards in glTF.
        let down = all().map(|v| [v.uv.x, 1.0 - v.uv.y]);
        attributes["TEXCOORD_0"] = json!(document.floats(down, target, false));
    }
    let slot = |slot: Option<u16>| match (made_of, slot) {
        (MaterialBinding::One(index), _) => index,
        (MaterialBinding::Slots { first, count } | MaterialBinding::Capped { first, count, .. }, slot) => {
            first + slot.map_or(count, u32::from).min(count)
        }
    };
    let colored =
        mesh.has.colors && mesh.groups.iter().any(|(group, _)| materials.shows_colors(slot(*group)));
    if colored {
        attributes["COLOR_0"] = json!(document.floats(all().map(|v| v.color.to_array()), target, false));
    }
    let primitives = mesh.groups.iter().map(|(group, triangles)| {
        let indices = document.indices(triangles, mesh.vertices.len());
        json!({ "attributes": attributes, "indices": indices, "material": materials.of(slot(*group)) })
    });
    let primitives: Vec<Value> = primitives.collect();
    document.push("meshes", json!({ "primitives": Value::Array(primitives) }))
}
