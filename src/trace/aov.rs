//! The AOV stage: depth, normal and albedo of the first visible surface, or of the first one that scatters light.

use super::context::{Queue, TraceContext};
use super::interaction::SurfaceInteraction;
use super::materials::{Column, LobeSet, LobeTable};
use super::path::has_flag;
use super::shade::{LobeRows, WaveState, active};
use super::stream::{PathState, flags};
use super::textures;
use crate::base::lanes::{Color, Level, Lookup, Mask, Real, Row, SimdKernel, Single, lanes};
use crate::base::math::DVec3;
use crate::base::stats::Evaluations;

/// The surfaces whose properties are recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordedSurface {
    /// Those that camera rays hit.
    Visible,
    /// Those that are seen directly, in mirrors or through glass, and are neither. Their albedo is multiplied by the
    /// throughput of the path that sees them, and their place is 1 over their distance from the camera.
    Scattering,
}

impl RecordedSurface {
    /// The flag of paths that see such surfaces.
    fn flag(self) -> u32 {
        match self {
            Self::Visible => flags::FROM_EYE,
            Self::Scattering => flags::SPECULAR,
        }
    }

    /// Whether surfaces with these lobes are recorded. Paths go on from the others.
    fn includes(self, lobes: LobeSet) -> bool {
        let scattering = LobeSet::DIFFUSE | LobeSet::FUZZ | LobeSet::MICROFACET | LobeSet::EMISSION;
        self == Self::Visible || lobes.has(scattering)
    }
}

/// Records such surfaces where the paths of a queue see them, in the layers from `first` on.
pub struct RecordAovs<'a, 's> {
    pub wave: &'s mut WaveState<'a>,
    pub queue: Queue,
    pub first: usize,
    /// What is recorded of a sample is multiplied by this.
    pub scale: f64,
    pub surface: RecordedSurface,
}

impl SimdKernel for RecordAovs<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { wave, queue, first, scale, surface } = self;
        let context = wave.context;
        let lobes = match queue {
            Queue::Escaped => return,
            Queue::Light => None,
            Queue::Surface(class) => Some(context.classes[class as usize]),
        };
        if lobes.is_some_and(|lobes| !surface.includes(lobes)) {
            return;
        }
        for items in wave.hits.queue(queue).rows() {
            let at = Lookup::ascending(items);
            let active = active::<L::F64>(items);
            let path = wave.paths.gather::<L::F64>(&at);
            let seen = active & has_flag::<L::F64>(path.flags, surface.flag());
            if !seen.any() {
                continue;
            }
            let hit = SurfaceInteraction::gather(context, &path, (wave.hits, &at), seen);
            let white = Color::grey(L::F32::splat(1.0));
            let (albedo, active) = match lobes {
                Some(lobes) => albedo(context, &path, &hit, (lobes, seen), wave.rows),
                None => (white, seen),
            };
            let camera = context.scene.camera;
            let slots = path.slot.to_array();
            for lane in lanes(active.bits()) {
                // A surface behind a transparent one is not the first one.
                if wave.sums.get(first, slots[lane]).y != 0.0 {
                    continue;
                }
                let from_camera = hit.surface.point.lane(lane) - camera.position;
                let (place, color) = match surface {
                    RecordedSurface::Visible => (from_camera.dot(camera.basis.forward), albedo),
                    RecordedSurface::Scattering => {
                        (from_camera.length().recip(), albedo * path.throughput.at_surface())
                    }
                };
                let seen = [
                    DVec3::new(place, 1.0, 0.0),
                    hit.surface.shading.lane(lane),
                    color.lane(lane).as_dvec3(),
                ];
                for (layer, sum) in (first..).zip(seen) {
                    wave.sums.set(layer, slots[lane], sum * scale);
                }
            }
        }
    }
}

/// The albedo of surfaces: the sum of all lobes. Emitters have the albedo 1. Also gives the lanes whose surface is not
/// cut out.
#[inline(always)]
fn albedo<F: Real>(
    context: &TraceContext,
    path: &PathState<F>,
    hit: &SurfaceInteraction<F>,
    (lobes, seen): (LobeSet, F::Mask),
    room: &mut LobeTable,
) -> (Color<F::F32>, F::Mask) {
    let mut table = &context.table;
    if lobes.has(LobeSet::TEXTURED) {
        let unnoted = &mut Evaluations::default();
        textures::look_up(context, LobeSet::ALL, hit, path.ray.direction, [seen, seen], room, unnoted);
        table = room;
    }
    let rows = LobeRows::new::<F>(lobes, hit.material);
    let at = rows.at();
    let strength: F::F32 = table.number(Column::MICROFACET, at);
    let mut all: Color<F::F32> = table.color(Column::BASE, at) * strength;
    for column in [Column::DIFFUSE, Column::MIRROR, Column::REFRACTION, Column::EMISSION] {
        all = all + table.color(column, at);
    }
    let transparency: Color<F::F32> = table.color(Column::TRANSPARENCY, at);
    let all = all + transparency;
    let one = F::F32::splat(1.0);
    let mut active = seen;
    if lobes.has(LobeSet::TEXTURED) {
        let clear = one.le(transparency.r) & one.le(transparency.g) & one.le(transparency.b);
        let materials = hit.material.to_array();
        for lane in lanes((seen & clear).bits()) {
            if context.material(materials[lane]).is_cut_out() {
                active = active & !F::Mask::from_bits(1 << lane);
            }
        }
    }
    (Color { r: all.r.min(one), g: all.g.min(one), b: all.b.min(one) }, active)
}
