//! What a user should know about a sequence before it is rendered.

mod gains;
mod images;
mod meshes;

use super::{Named, Object, Sequence};
use crate::appearance::material::{MadeOf, MaterialTracks};
use crate::geometry::shape::{self, Shape};
use std::collections::BTreeSet;

impl Sequence {
    /// What is no mistake, but may not be what was meant.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = self.skipped_triangles();
        notes.extend(self.left_out());
        notes.extend(self.white_ambient());
        notes.extend(self.ignored_alpha());
        notes.extend(self.missing_libraries());
        notes.extend(self.gains());
        if let Some(caption) = &self.output.caption {
            notes.extend(caption.text.note(&self.name));
            notes.extend(caption.cut(self.output.size.1));
        }
        notes
    }

    /// The materials that are seen somewhere, in their order.
    fn used_materials(&self) -> impl Iterator<Item = &Named<MaterialTracks>> {
        let seen = self.objects.iter().filter(|object| object.value.shape != Shape::Group);
        let used: BTreeSet<u32> = seen.flat_map(|object| used(&object.value)).collect();
        used.into_iter().filter_map(|index| self.materials.get(index as usize))
    }
}

/// The materials that an object shows.
fn used(object: &Object) -> impl Iterator<Item = u32> {
    let indices = object.made_of.indices();
    let mesh = if let Shape::Mesh(shape::Mesh { mesh, .. }) = &object.shape { Some(mesh) } else { None };
    let rest = match (object.made_of, mesh) {
        (MadeOf::Slots { first, count }, Some(mesh)) => {
            let all = (0..mesh.triangles().len() as u32).all(|part| mesh.material_of(part).is_some());
            all.then_some(first + count)
        }
        _ => None,
    };
    indices.filter(move |index| Some(*index) != rest)
}
