//! Evaluation of textures at points of surfaces.

use super::context::TraceContext;
use super::interaction::SurfaceInteraction;
use super::materials::{LobeSet, LobeTable};
use crate::appearance::texture::{Footprint, TextureEvalContext};
use crate::base::lanes::{Mask, Real, Row, Vec3, lanes};
use crate::base::math::DVec3;
use crate::base::stats::Evaluations;
use crate::geometry::shape::{ShapeHit, Surface};
use crate::scene::top_level::Hit;

/// Writes the lobes of points into the rows of their lanes, as far as they are in a set. Wanted lanes get all of them.
/// Other active lanes get only emission and straight transmission.
#[inline(always)]
pub fn look_up<F: Real>(
    context: &TraceContext,
    lobes: LobeSet,
    surface: &SurfaceInteraction<F>,
    direction: Vec3<F>,
    (active, wanted): (F::Mask, F::Mask),
    (rows, counts): (&mut LobeTable, &mut Evaluations),
) {
    let points = TexturePoints::new(surface, direction);
    points.look_up((context, lobes), [active.bits(), wanted.bits()], (rows, counts));
}

/// Turns the shading normals of points in the lanes of a mask, as the relief of their materials says. A normal that then
/// faces away from the eye belongs to the hidden side of the relief: its mirror image across the line of sight takes its
/// place, so that shading stays continuous.
#[inline(always)]
pub fn turn_normals<F: Real>(
    context: &TraceContext,
    surface: &mut SurfaceInteraction<F>,
    direction: Vec3<F>,
    active: F::Mask,
) {
    let [x, y, z] =
        TexturePoints::new(surface, direction).turned(context, active.bits(), surface.outside.bits());
    surface.surface.shading = Vec3::new(F::load(&x, 0), F::load(&y, 0), F::load(&z, 0));
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

    /// What textures read at the point of a lane.
    #[inline]
    fn texture_context<'c>(&self, context: &'c TraceContext, lane: usize) -> TextureEvalContext<'c> {
        let (surface, inputs) = (&self.surfaces[lane], context.texture_inputs(self.materials[lane]));
        let seen = match inputs.footprint | inputs.footprint_uv {
            true => Footprint::new(self.widths[lane], self.directions[lane], surface.normal),
            false => Footprint::default(),
        };
        let at = ShapeHit::of_part(self.t[lane], self.parts[lane]);
        let hit = Hit { at, primitive: self.primitives[lane] };
        context.scene.geometry.texture_context(&hit, surface, &seen, inputs)
    }

    /// The coordinates of the shading normals.
    #[inline(never)]
    fn turned(&self, context: &TraceContext, active: u32, outside: u32) -> [[f64; 8]; 3] {
        let mut normals = self.surfaces.map(|surface| surface.shading);
        for lane in lanes(active) {
            let material = context.material(self.materials[lane]);
            if !material.has_relief() {
                continue;
            }
            let surface = &self.surfaces[lane];
            let at_point = self.texture_context(context, lane);
            let geometry = context.scene.geometry;
            let side = if outside >> lane & 1 == 1 { 1.0 } else { -1.0 };
            // Normals are moved by the inverse transpose of the map of points.
            let to_normal = geometry.origin(self.primitives[lane] as usize).to_object().matrix3.transpose();
            let own = (to_normal.inverse() * (surface.shading * side)).try_normalize();
            let turned = own.map(|own| to_normal * material.normal_at(&at_point, own) * side);
            let Some(turned) = turned.and_then(DVec3::try_normalize) else { continue };
            let away = turned.dot(self.directions[lane]);
            normals[lane] = if away > 0.0 { turned - self.directions[lane] * (2.0 * away) } else { turned };
        }
        [normals.map(|normal| normal.x), normals.map(|normal| normal.y), normals.map(|normal| normal.z)]
    }

    #[inline(never)]
    fn look_up(
        &self,
        (context, lobes): (&TraceContext, LobeSet),
        [active, wanted]: [u32; 2],
        (rows, counts): (&mut LobeTable, &mut Evaluations),
    ) {
        for lane in lanes(active) {
            let material = context.material(self.materials[lane]);
            if !material.is_textured(wanted >> lane & 1) {
                rows.set(lane, &material.lobes, lobes);
                continue;
            }
            counts.paint += 1;
            rows.set(lane, &material.lobes_at(&self.texture_context(context, lane)), lobes);
        }
    }
}
