//! The escape stage: paths that meet nothing see the sky.

use super::path::mis_weight;
use super::shade::Stage;
use crate::base::lanes::{Bits, Color, Level, Lookup, Mask, Row, SimdKernel, Vec3};

/// Adds what the sky sends to the paths of a queue. A path that comes straight from the eye sees the picture's background,
/// which may be held out.
pub struct Escape<'a, 's> {
    pub stage: &'s mut Stage<'a>,
    pub queue: &'s [u32],
}

impl SimdKernel for Escape<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { stage, queue } = self;
        let context = stage.context;
        if context.environment.is_none() && context.holdout.is_none() {
            return;
        }
        for which in queue.chunks(8) {
            let at = Lookup::new(which);
            let mut there = L::Mask::from_bits(0xff >> (8 - which.len()));
            let path = stage.paths.gather::<L::F64>(&at);
            if let Some(holdout) = context.holdout {
                let from_eye = there & path.left.eq(L::U32::splat(context.quality.surfaces()));
                stage.sums.add::<L::F64>(holdout, path.throughput.shining(), from_eye, path.slot);
                there = there & !from_eye;
            }
            let Some(environment) = context.environment.filter(|_| there.any()) else { continue };
            let direction: Vec3<L::F64> = path.ray.direction;
            let mut light: Color<L::F32> = path.throughput.shining() * environment.radiance(direction);
            if context.lights.samples_sky() {
                light = light * mis_weight(&path, context.lights.pdf_of_sky(direction));
            }
            stage.sums.add::<L::F64>(environment.layer, light, there, path.slot);
        }
    }
}
