//! Notes for the user about a sequence, before it is rendered.

mod energy_gain;
mod images;
mod meshes;

use super::quality::{Denoise, Quality, SampleReuse};
use super::{Named, Object, Sequence};
use crate::annotate::AnnotationKind;
use crate::appearance::material::{MaterialBinding, MaterialTracks};
use crate::camera::path::Lens;
use crate::encode::{listed_letters, missing_glyphs_note};
use crate::geometry::shape::{self, Shape};
use std::collections::BTreeSet;

#[warn(missing_docs)]
impl Sequence {
    /// Things that are valid but may not be intended.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = self.warnings.clone();
        notes.extend(self.skipped_triangles());
        notes.extend(self.left_out());
        notes.extend(self.white_ambient());
        notes.extend(self.ignored_alpha());
        notes.extend(self.missing_libraries());
        notes.extend(self.cuts_without_caps());
        notes.extend(self.energy_gains());
        notes.extend(self.unused_reuse());
        let height = self.output.size.1;
        if let Some(caption) = &self.output.caption {
            notes.extend(missing_glyphs_note(&caption.missing_glyphs(&self.name)));
            notes.extend(caption.overflow(height).map(|lines| format!("the caption has {lines}")));
        }
        notes.extend(self.annotations.iter().filter_map(|Named { name, value }| {
            value.overflow(height).map(|lines| format!("the annotation {name:?} has {lines}"))
        }));
        notes.extend(self.scales_without_depth());
        notes.extend(self.annotations.iter().filter_map(|Named { name, value }| {
            let letters = listed_letters(&value.missing_glyphs(&self.name))?;
            Some(format!("the annotation {name:?} is without {letters}, which its font does not have"))
        }));
        notes
    }

    /// Scales that a perspective camera does not show.
    fn scales_without_depth(&self) -> impl Iterator<Item = String> {
        let perspective =
            self.cameras.iter().any(|camera| matches!(camera.value.lens, Lens::Perspective { .. }));
        let without = move |kind: &AnnotationKind| {
            perspective && matches!(kind, AnnotationKind::ScaleBar(bar) if bar.at.is_none())
        };
        self.annotations.iter().filter(move |annotation| without(&annotation.value.kind)).map(|annotation| {
            let name = &annotation.name;
            format!(
                "perspective cameras do not show the scale {name:?}: it needs `at`, a point at whose depth it is exact"
            )
        })
    }

    /// Why `reuse: Zoom` has no effect, whatever the camera does.
    fn unused_reuse(&self) -> Option<String> {
        let Quality { reuse, noise, filter, denoise, vary_noise, .. } = self.quality;
        let why = match reuse {
            SampleReuse::Off => return None,
            SampleReuse::Zoom if noise.is_some() => {
                "a target error (`noise`) gives each frame its own number of samples; write `samples` instead"
            }
            SampleReuse::Zoom if denoise != Denoise::Off => {
                "frames that are denoised (`denoise`) need samples of their own; write `denoise: Off`"
            }
            SampleReuse::Zoom if vary_noise && self.quality.integrator.samples_lights() => {
                "frames with noise of their own (`vary_noise`) share no samples; leave one of the two out"
            }
            SampleReuse::Zoom if filter.width < 1.0 => {
                "the filter is narrower than a pixel; make it at least 1 wide"
            }
            SampleReuse::Zoom => return None,
        };
        Some(format!("`reuse: Zoom` has no effect: {why}"))
    }

    /// The materials of visible shapes, in their order.
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
        // Without a material of their own, faces at which planes cut the mesh open show that of the rest.
        (MaterialBinding::Slots { .. }, Some(_)) if !object.clip.is_empty() => None,
        (
            MaterialBinding::Slots { first, count } | MaterialBinding::Capped { first, count, .. },
            Some(mesh),
        ) => {
            let all = (0..mesh.triangles().len() as u32).all(|part| mesh.material_of(part).is_some());
            all.then_some(first + count)
        }
        _ => None,
    };
    indices.filter(move |index| Some(*index) != rest)
}
