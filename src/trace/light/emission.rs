//! Light that objects emit, at points of their surfaces.

use crate::appearance::texture::{Footprint, TextureInputs};
use crate::base::lanes::{Color, Mask, Real, Row};
use crate::geometry::shape::LaneSurface;
use crate::scene::Scene;

/// The emission of a primitive at points of its surface. `inputs` is what its textures read.
#[inline(always)]
pub fn emission<F: Real>(
    scene: &Scene,
    primitive: u32,
    inputs: TextureInputs,
    surface: &LaneSurface<F>,
    part: F::U32,
) -> Color<F::F32> {
    let material = scene.geometry.primitives[primitive as usize].material(0);
    let material = &scene.shading.materials[material.unwrap_or_default() as usize];
    if material.textures.is_empty() {
        return Color::splat(material.lobes.emission);
    }
    let (all, seen) = (F::Mask::splat(true), Footprint::zero());
    let at = (F::U32::splat(primitive), part);
    let at = scene.geometry.texture_context(at, surface, &seen, inputs, all);
    material.lobes_at(&at, all).emission
}
