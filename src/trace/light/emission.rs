//! Light that objects emit, at points of their surfaces.

use crate::appearance::material::Material;
use crate::appearance::texture::{Footprint, TextureInputs};
use crate::base::color::Rgb;
use crate::base::lanes::{Color, Real, Row};
use crate::geometry::shape::{LaneSurface, ShapeHit, Surface};
use crate::scene::Scene;
use crate::scene::top_level::Hit;

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
    let (surfaces, parts) = (surface.store(), part.to_array());
    let zero = F::F32::splat(0.0).to_array();
    let (mut r, mut g, mut b) = (zero, zero, zero);
    for lane in 0..F::LANES {
        let Rgb { x, y, z } =
            textured_emission(scene, (material, inputs), primitive, &surfaces[lane], parts[lane]);
        (r[lane], g[lane], b[lane]) = (x, y, z);
    }
    Color { r: Row::from_array(r), g: Row::from_array(g), b: Row::from_array(b) }
}

#[inline(never)]
fn textured_emission(
    scene: &Scene,
    (material, inputs): (&Material, TextureInputs),
    primitive: u32,
    surface: &Surface,
    part: u32,
) -> Rgb {
    let hit = Hit { at: ShapeHit::of_part(0.0, part), primitive };
    let seen = Footprint::default();
    let at = scene.geometry.texture_context(&hit, surface, &seen, inputs);
    material.lobes_at(&at).emission
}
