//! The escape stage: adds the light of the sky to paths that hit nothing.

use super::path::mis_weight;
use super::path_queue::PathQueue;
use super::shade::{WaveState, active};
use crate::base::lanes::{Bits, Color, Level, Lookup, Mask, Row, SimdKernel, Vec3};

/// Adds the light of the sky to the paths of a queue. A path straight from the camera sees the background instead,
/// which may be held out.
pub struct HandleEscaped<'a, 's> {
    pub wave: &'s mut WaveState<'a>,
    pub queue: &'s PathQueue,
}

impl SimdKernel for HandleEscaped<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { wave, queue } = self;
        let context = wave.context;
        if context.environment.is_none() && context.holdout.is_none() {
            return;
        }
        for items in queue.rows() {
            let at = Lookup::ascending(items);
            let mut active = active::<L::F64>(items);
            let path = wave.paths.gather::<L::F64>(&at);
            if let Some(holdout) = context.holdout {
                let from_eye = active & path.bounces_left.eq(L::U32::splat(context.quality.surfaces()));
                wave.sums.add::<L::F64>(holdout, path.throughput.at_emitter(), from_eye, path.slot);
                active = active & !from_eye;
            }
            let Some(environment) = context.environment.filter(|_| active.any()) else { continue };
            let direction: Vec3<L::F64> = path.ray.direction;
            let mut light: Color<L::F32> = path.throughput.at_emitter() * environment.radiance(direction);
            if context.lights.samples_sky() {
                light = light
                    * mis_weight(&path, context.lights.pdf_of_sky(context.scattering(&path), direction));
            }
            wave.sums.add::<L::F64>(environment.layer, light, active, path.slot);
        }
    }
}
