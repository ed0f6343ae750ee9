//! Evaluation of textures at points of surfaces.

use super::context::TraceContext;
use super::interaction::SurfaceInteraction;
use super::materials::LobeTable;
use crate::appearance::texture::Footprint;
use crate::base::lanes::{Mask, Real, Row, Vec3, lanes};
use crate::base::math::DVec3;
use crate::base::stats::Evaluations;
use crate::geometry::shape::{ShapeHit, Surface};
use crate::scene::top_level::Hit;

/// Writes the lobes of points into the rows of their lanes. Wanted lanes get all lobes. Other active lanes get only
/// emission and straight transmission.
#[inline(always)]
pub fn look_up<F: Real>(
    context: &TraceContext,
    surface: &SurfaceInteraction<F>,
    direction: Vec3<F>,
    (active, wanted): (F::Mask, F::Mask),
    (rows, counts): (&mut LobeTable, &mut Evaluations),
) {
    let points = TexturePoints::new(surface, direction);
    points.look_up(context, [active.bits(), wanted.bits()], (rows, counts));
}

/// Points in memory, lane by lane.
struct TexturePoints {
    surfaces: [Surface; 8],
    directions: [DVec3; 8],
    t: [f64; 8],
    parts: [u32; 8],
    primitives: [u32; 8],
    materials: [u32; 8],
    widths: [f64; 8],
}

impl TexturePoints {
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
        [active, wanted]: [u32; 2],
        (rows, counts): (&mut LobeTable, &mut Evaluations),
    ) {
        for lane in lanes(active) {
            let material = context.material(self.materials[lane]);
            if !material.is_textured(wanted >> lane & 1) {
                rows.set(lane, &material.lobes);
                continue;
            }
            counts.paint += 1;
            let surface = &self.surfaces[lane];
            let seen = Footprint::new(self.widths[lane], self.directions[lane], surface.normal);
            let at = ShapeHit::of_part(self.t[lane], self.parts[lane]);
            let hit = Hit { at, primitive: self.primitives[lane] };
            let at_point = context.scene.geometry.spot(&hit, surface, &seen, material.is_uv_mapped());
            rows.set(lane, &material.lobes_at(&at_point));
        }
    }
}
