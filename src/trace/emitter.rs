//! The emitter stage: paths that meet a light see it.

use super::interaction::SurfaceInteraction;
use super::light::seen_radiance;
use super::path::{has_flag, mis_weight};
use super::shade::Stage;
use super::stream::flags;
use crate::base::lanes::{Bits, Level, Lookup, Mask, Row, Select, SimdKernel};

/// Adds the light of the lights that the paths of a queue have met.
pub struct Emitter<'a, 's> {
    pub stage: &'s mut Stage<'a>,
    pub queue: &'s [u32],
}

impl SimdKernel for Emitter<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { stage, queue } = self;
        let context = stage.context;
        for which in queue.chunks(8) {
            let at = Lookup::new(which);
            let there = L::Mask::from_bits(0xff >> (8 - which.len()));
            let path = stage.paths.gather::<L::F64>(&at);
            let hit = SurfaceInteraction::gather(context, &path, (stage.hits, &at), there);
            let weight = match context.columns.mis {
                true => {
                    let lights = &context.lights;
                    mis_weight(
                        &path,
                        lights.pdf_of_hit(path.scattered_at, hit.primitive, &hit.surface, there),
                    )
                }
                false => {
                    let counted = has_flag::<L::F64>(path.flags, flags::LIGHT_COUNTED);
                    L::F32::select(counted, L::F32::splat(0.0), L::F32::splat(1.0))
                }
            };
            let light = path.throughput.shining() * weight;
            let (indices, mut rest) = (hit.material.to_array(), there.bits());
            while rest != 0 {
                let index = indices[rest.trailing_zeros() as usize];
                let same = there & hit.material.eq(L::U32::splat(index));
                rest &= !same.bits();
                let source = &context.scene.shading.lights[index as usize];
                let seen = light * seen_radiance::<L::F64>(source, hit.outside);
                stage.sums.add::<L::F64>(source.layer, seen, same, path.slot);
            }
        }
    }
}
