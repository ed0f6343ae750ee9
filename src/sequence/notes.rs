//! What a user should know about a sequence before it is rendered.

use super::suggest::{listed, shortened};
use super::{Named, Object, Sequence};
use crate::humane::counted;
use crate::material::MadeOf;
use crate::mesh::Mesh;
use crate::shape::{self, Shape};
use std::collections::HashSet;
use std::sync::Arc;

impl Sequence {
    /// What is no mistake, but may not be what was meant.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = self.skipped_triangles();
        notes.extend(self.left_out());
        notes.extend(self.missing_libraries());
        notes
    }

    fn skipped_triangles(&self) -> Vec<String> {
        let skipped = self.meshes().into_iter().filter(|(_, mesh)| mesh.skipped > 0);
        let note = |(name, mesh): (&str, &Mesh)| {
            let triangles = counted(mesh.skipped as u64, "triangle");
            format!("the mesh of `{}`: {triangles} without an area left out", shortened(name))
        };
        skipped.map(note).collect()
    }

    /// What the materials of meshes say that is not read, where objects are made of them.
    fn left_out(&self) -> Vec<String> {
        let mut seen = HashSet::new();
        let mut notes = Vec::new();
        for Named { name, value: Object { shape, made_of, .. } } in &self.objects {
            let (Shape::Mesh(shape::Mesh { mesh, .. }), MadeOf::Slots { .. }) = (shape, made_of) else {
                continue;
            };
            if !seen.insert(Arc::as_ptr(mesh)) {
                continue;
            }
            let mut kinds: Vec<&str> = Vec::new();
            for kind in mesh.materials().iter().flat_map(|material| &material.left_out) {
                if !kinds.contains(kind) {
                    kinds.push(kind);
                }
            }
            if !kinds.is_empty() {
                let kinds = listed(kinds);
                notes.push(format!("the mesh of `{}`: {kinds} of its materials left out", shortened(name)));
            }
        }
        notes
    }

    /// Material libraries that are not there, where nothing is made of them. Elsewhere they are mistakes.
    fn missing_libraries(&self) -> Vec<String> {
        let mut notes = Vec::new();
        for (name, mesh) in self.meshes() {
            if let Some(why) = mesh.materials().iter().find_map(|material| material.missing.as_ref()) {
                notes.push(format!("the mesh of `{}`: {why}, and none is needed", shortened(name)));
            }
        }
        notes
    }
}
