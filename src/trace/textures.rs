//! What textures say of points of surfaces.

use super::context::TraceContext;
use super::interaction::SurfaceInteraction;
use super::materials::LobeTable;
use crate::appearance::material::Material;
use crate::appearance::texture::Footprint;
use crate::base::color::Rgb;
use crate::base::lanes::{Color, Mask, Real, Row, Vec3, lanes};
use crate::base::math::DVec3;
use crate::base::stats::Evaluations;
use crate::geometry::shape::{Crossing, LaneSurface, Surface};
use crate::scene::Scene;
use crate::scene::top_level::Hit;

/// Puts the lobes of points into the rows of their lanes. Those that are wanted have all of their lobes looked up, others
/// that are there only what they emit and let pass.
#[inline(always)]
pub fn look_up<F: Real>(
    context: &TraceContext,
    surface: &SurfaceInteraction<F>,
    direction: Vec3<F>,
    (there, wanted): (F::Mask, F::Mask),
    (rows, counts): (&mut LobeTable, &mut Evaluations),
) {
    let points = Points::new(surface, direction);
    points.look_up(context, [there.bits(), wanted.bits()], (rows, counts));
}

/// Points in memory.
struct Points {
    surfaces: [Surface; 8],
    directions: [DVec3; 8],
    t: [f64; 8],
    parts: [u32; 8],
    primitives: [u32; 8],
    materials: [u32; 8],
    widths: [f64; 8],
}

impl Points {
    #[inline(always)]
    fn new<F: Real>(surface: &SurfaceInteraction<F>, direction: Vec3<F>) -> Self {
        let lane = |lane: usize| lane.min(F::LANES - 1);
        let (t, parts) = (surface.at.t.to_array(), surface.at.part.to_array());
        let (primitives, materials) = (surface.primitive.to_array(), surface.material.to_array());
        let widths = surface.width.to_array();
        Self {
            surfaces: surface.surface.store(),
            directions: direction.store(),
            t: std::array::from_fn(|k| t[lane(k)]),
            parts: std::array::from_fn(|k| parts[lane(k)]),
            primitives: std::array::from_fn(|k| primitives[lane(k)]),
            materials: std::array::from_fn(|k| materials[lane(k)]),
            widths: std::array::from_fn(|k| widths[lane(k)]),
        }
    }

    #[inline(never)]
    fn look_up(
        &self,
        context: &TraceContext,
        [there, wanted]: [u32; 2],
        (rows, counts): (&mut LobeTable, &mut Evaluations),
    ) {
        for lane in lanes(there) {
            let material = context.material(self.materials[lane]);
            if !material.is_painted(wanted >> lane & 1) {
                rows.set(lane, &material.lobes);
                continue;
            }
            counts.paint += 1;
            let surface = &self.surfaces[lane];
            let seen = Footprint::new(self.widths[lane], self.directions[lane], surface.normal);
            let at = Crossing::of_part(self.t[lane], self.parts[lane]);
            let hit = Hit { at, primitive: self.primitives[lane] };
            let spot = context.scene.geometry.spot(&hit, surface, &seen, material.is_printed());
            rows.set(lane, &material.painted(&spot));
        }
    }
}

/// What a primitive emits at points of its surface.
#[inline(always)]
pub fn emission<F: Real>(
    scene: &Scene,
    primitive: u32,
    surface: &LaneSurface<F>,
    part: F::U32,
) -> Color<F::F32> {
    let material = scene.geometry.primitives[primitive as usize].material(0);
    let material = &scene.shading.materials[material.unwrap_or_default() as usize];
    if material.paints.is_empty() {
        return Color::splat(material.lobes.emission);
    }
    let (surfaces, parts) = (surface.store(), part.to_array());
    let zero = F::F32::splat(0.0).to_array();
    let (mut r, mut g, mut b) = (zero, zero, zero);
    for lane in 0..F::LANES {
        let Rgb { x, y, z } = painted(scene, material, primitive, &surfaces[lane], parts[lane]);
        (r[lane], g[lane], b[lane]) = (x, y, z);
    }
    Color { r: Row::from_array(r), g: Row::from_array(g), b: Row::from_array(b) }
}

#[inline(never)]
fn painted(scene: &Scene, material: &Material, primitive: u32, surface: &Surface, part: u32) -> Rgb {
    let hit = Hit { at: Crossing::of_part(0.0, part), primitive };
    let seen = Footprint::default();
    let spot = scene.geometry.spot(&hit, surface, &seen, material.is_printed());
    material.painted(&spot).emission
}
