//! The emitter stage: adds the light of lights that paths hit.

use super::interaction::SurfaceInteraction;
use super::light::emitted_radiance;
use super::path::{has_flag, mis_weight};
use super::path_queue::PathQueue;
use super::shade::{WaveState, active};
use super::stream::flags;
use crate::base::lanes::{Bits, Level, Lookup, Mask, Row, Select, SimdKernel};

/// Adds the light of the lights that the paths of a queue hit.
pub struct HandleEmitters<'a, 's> {
    pub wave: &'s mut WaveState<'a>,
    pub queue: &'s PathQueue,
}

impl SimdKernel for HandleEmitters<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { wave, queue } = self;
        let context = wave.context;
        for items in queue.rows() {
            let at = Lookup::ascending(items);
            let active = active::<L::F64>(items);
            let path = wave.paths.gather::<L::F64>(&at);
            let hit = SurfaceInteraction::gather(context, &path, (wave.hits, &at), active);
            let weight = match context.columns.mis {
                true => {
                    let lights = &context.lights;
                    mis_weight(
                        &path,
                        lights.pdf_of_hit(context.scattering(&path), hit.primitive, &hit.surface, active),
                    )
                }
                false => {
                    let counted = has_flag::<L::F64>(path.flags, flags::LIGHT_COUNTED);
                    L::F32::select(counted, L::F32::splat(0.0), L::F32::splat(1.0))
                }
            };
            let light = path.throughput.at_emitter() * weight;
            let (indices, mut rest) = (hit.material.to_array(), active.bits());
            while rest != 0 {
                let index = indices[rest.trailing_zeros() as usize];
                let same = active & hit.material.eq(L::U32::splat(index));
                rest &= !same.bits();
                let source = &context.scene.shading.lights[index as usize];
                let seen = light * emitted_radiance::<L::F64>(source, hit.outside);
                wave.sums.add::<L::F64>(source.layer, seen, same, path.slot);
            }
        }
    }
}
