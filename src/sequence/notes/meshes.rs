//! Notes about contents of mesh files that are not rendered.

use crate::appearance::material::MaterialBinding;
use crate::base::units::counted;
use crate::geometry::mesh::{MtlMaterial, TriangleMesh};
use crate::geometry::shape::{self, Shape};
use crate::import::series::MeshSeries;
use crate::sequence::suggest::{listed, shortened};
use crate::sequence::{Named, Object, Sequence, ShapeTracks};
use std::collections::HashSet;
use std::sync::Arc;

impl Sequence {
    pub(super) fn skipped_triangles(&self) -> Vec<String> {
        let series: Vec<_> = self.series().collect();
        let is_single =
            |mesh: &TriangleMesh| series.iter().all(|(_, series)| !std::ptr::eq(&**series.first(), mesh));
        let single = self.meshes().into_iter().filter(|(_, mesh)| is_single(mesh));
        let single = single.map(|(name, mesh)| (name, mesh.skipped));
        let in_series =
            |(name, series): &(_, &MeshSeries)| (*name, series.steps().iter().map(|step| step.skipped).sum());
        let counts = single.chain(series.iter().map(in_series));
        let note = |(name, skipped): (&str, usize)| {
            let triangles = counted(skipped as u64, "triangle");
            format!("the mesh of `{}`: {triangles} without an area left out", shortened(name))
        };
        counts.filter(|(_, skipped)| *skipped > 0).map(note).collect()
    }

    /// The different series of meshes, each with the first object that shows it.
    fn series(&self) -> impl Iterator<Item = (&str, &MeshSeries)> {
        let mut seen = HashSet::new();
        self.objects.iter().filter_map(move |Named { name, value }| {
            let Some(ShapeTracks::Series(series)) = &value.tracks else { return None };
            seen.insert(Arc::as_ptr(series)).then_some((name.as_str(), &**series))
        })
    }

    /// Meshes whose own materials are visible, each once, with the first object that shows them.
    fn meshes_with_materials(&self) -> Vec<(&str, &TriangleMesh)> {
        let mut seen = HashSet::new();
        let mut meshes = Vec::new();
        for Named { name, value: Object { shape, made_of, .. } } in &self.objects {
            let (Shape::Mesh(shape::Mesh { mesh, .. }), false) =
                (shape, matches!(made_of, MaterialBinding::One(_)))
            else {
                continue;
            };
            if seen.insert(Arc::as_ptr(mesh)) {
                meshes.push((name.as_str(), &**mesh));
            }
        }
        meshes
    }

    /// Properties of mesh materials that Kinora ignores, if objects use these materials.
    pub(super) fn left_out(&self) -> Vec<String> {
        let mut notes = Vec::new();
        for (name, mesh) in self.meshes_with_materials() {
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

    /// Meshes with ambient reflectances that exporters write by default, if objects use these materials.
    pub(super) fn white_ambient(&self) -> Vec<String> {
        let left_out =
            |material: &MtlMaterial| material.ambient.is_some() && material.effective_ambient().is_none();
        let meshes = self.meshes_with_materials().into_iter();
        let meshes = meshes.filter(|(_, mesh)| mesh.materials().iter().any(left_out));
        let note = |(name, _): (&str, &TriangleMesh)| {
            format!(
                "the mesh of `{}`: `Ka` is ignored where it is white or equals `Kd`, as exporters write it by \
                 default; the `ambient` of `default_material` is used instead",
                shortened(name)
            )
        };
        meshes.map(note).collect()
    }

    /// Meshes with open edges that planes cut: they get no caps.
    pub(super) fn cuts_without_caps(&self) -> Vec<String> {
        let is_cut = |index: usize| self.ancestry(index).any(|at| !self.objects[at].value.clip.is_empty());
        let mut seen = HashSet::new();
        let mut notes = Vec::new();
        for (index, Named { name, value: Object { shape, .. } }) in self.objects.iter().enumerate() {
            let Shape::Mesh(shape::Mesh { mesh, .. }) = shape else { continue };
            if is_cut(index) && seen.insert(Arc::as_ptr(mesh)) && !mesh.is_closed() {
                notes.push(format!(
                    "the mesh of `{}` has open edges or sheets, so that `clip` leaves it open, without caps",
                    shortened(name)
                ));
            }
        }
        notes
    }

    /// Missing material libraries that no object needs. Otherwise, they are faults.
    pub(super) fn missing_libraries(&self) -> Vec<String> {
        let mut notes = Vec::new();
        for (name, mesh) in self.meshes() {
            if let Some(why) = mesh.materials().iter().find_map(|material| material.missing.as_ref()) {
                notes.push(format!("the mesh of `{}`: {why}, and none is needed", shortened(name)));
            }
        }
        notes
    }
}
