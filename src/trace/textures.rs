//! Evaluation of textures at points of surfaces.

use super::context::TraceContext;
use super::interaction::SurfaceInteraction;
use super::materials::{LobeSet, LobeTable};
use crate::appearance::material::{Material, PointLobes};
use crate::appearance::texture::{Footprint, TextureEvalContext, TextureInputs};
use crate::base::lanes::{Bits, Mask, Real, Row, Vec3, lanes, out_of_line};
use crate::base::math::DVec3;
use crate::base::stats::Evaluations;
use crate::geometry::shape::{LaneSurface, Surface};

out_of_line! {
    /// Writes the lobes of points into the rows of their lanes, as far as they are in a set. `masks` are the lanes that are
    /// active, and those among them that get all lobes. The others get only emission and straight transmission.
    pub fn look_up<'k, F>(
        context: &'k TraceContext<'k>,
        lobes: LobeSet,
        surface: &'k SurfaceInteraction<F>,
        direction: Vec3<F>,
        masks: [F::Mask; 2],
        rows: &'k mut LobeTable,
        counts: &'k mut Evaluations,
    ) -> () {
        let [active, wanted] = masks;
        let (mut textured, mut inputs) = (F::Mask::splat(false), TextureInputs::default());
        let (materials, mut rest) = (surface.material.to_array(), active.bits());
        while rest != 0 {
            let index = materials[rest.trailing_zeros() as usize];
            let same = surface.material.eq(F::U32::splat(index)) & active;
            rest &= !same.bits();
            let material = context.material(index);
            let varied = textured_lanes::<F>(material, same, wanted);
            if (same & !varied).any() {
                rows.write::<F::F32>(0, same & !varied, &PointLobes::splat(&material.lobes), lobes);
            }
            if varied.any() {
                (textured, inputs) = (textured | varied, inputs | context.texture_inputs(index));
            }
        }
        if !textured.any() {
            return;
        }
        counts.paint += u64::from(textured.bits().count_ones());
        let at = texture_context(context, surface, direction, inputs, textured);
        rest = textured.bits();
        while rest != 0 {
            let index = materials[rest.trailing_zeros() as usize];
            let same = surface.material.eq(F::U32::splat(index)) & textured;
            rest &= !same.bits();
            rows.write::<F::F32>(0, same, &context.material(index).lobes_at(&at, same), lobes);
        }
    }
}

/// The lanes among those of a material in which textures matter: all, the wanted ones, or none.
#[inline(always)]
fn textured_lanes<F: Real>(material: &Material, of_material: F::Mask, wanted: F::Mask) -> F::Mask {
    if material.is_textured(0) {
        of_material
    } else if material.is_textured(1) {
        of_material & wanted
    } else {
        F::Mask::splat(false)
    }
}

/// What textures read at points in the lanes of a mask.
#[inline(always)]
fn texture_context<'c, F: Real>(
    context: &'c TraceContext,
    surface: &SurfaceInteraction<F>,
    direction: Vec3<F>,
    inputs: TextureInputs,
    wanted: F::Mask,
) -> TextureEvalContext<'c, F> {
    let seen = match inputs.footprint | inputs.footprint_uv {
        true => Footprint::new(surface.width, direction, surface.surface.normal),
        false => Footprint::zero(),
    };
    let at = (surface.primitive, surface.at.part);
    context.scene.geometry.texture_context(at, &surface.surface, &seen, inputs, wanted)
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
        ReliefPoints::new(surface, direction).turned(context, active.bits(), surface.outside.bits());
    surface.surface.shading = Vec3::new(F::load(&x, 0), F::load(&y, 0), F::load(&z, 0));
}

/// Points in memory, lane by lane: each has neighbours of its own.
struct ReliefPoints {
    surfaces: [Surface; 8],
    directions: [DVec3; 8],
    parts: [u32; 8],
    primitives: [u32; 8],
    materials: [u32; 8],
    widths: [f64; 8],
}

impl ReliefPoints {
    #[inline(always)]
    fn new<F: Real>(surface: &SurfaceInteraction<F>, direction: Vec3<F>) -> Self {
        let lane = |lane: usize| lane.min(F::LANES - 1);
        let (parts, widths) = (surface.at.part.to_array(), surface.width.to_array());
        let (primitives, materials) = (surface.primitive.to_array(), surface.material.to_array());
        Self {
            surfaces: surface.surface.store(),
            directions: direction.store(),
            parts: std::array::from_fn(|k| parts[lane(k)]),
            primitives: std::array::from_fn(|k| primitives[lane(k)]),
            materials: std::array::from_fn(|k| materials[lane(k)]),
            widths: std::array::from_fn(|k| widths[lane(k)]),
        }
    }

    /// What textures read at the point of a lane.
    fn texture_context<'c>(&self, context: &'c TraceContext, lane: usize) -> TextureEvalContext<'c> {
        let (surface, inputs) = (&self.surfaces[lane], context.texture_inputs(self.materials[lane]));
        let seen = match inputs.footprint | inputs.footprint_uv {
            true => Footprint::new(self.widths[lane], self.directions[lane].into(), surface.normal.into()),
            false => Footprint::zero(),
        };
        let at = (self.primitives[lane], self.parts[lane]);
        context.scene.geometry.texture_context(at, &LaneSurface::from(surface), &seen, inputs, true)
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
}
