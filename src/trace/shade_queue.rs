//! The shade stage: calls the integrator for the surfaces of a queue.

use super::materials::LobeSet;
use super::path_queue::PathQueue;
use super::shade::WaveState;
use super::{path, whitted};
use crate::base::lanes::{Level, SimdKernel};
use crate::sequence::quality::Integrator;

/// Shades the surfaces of a queue.
pub struct ShadeQueue<'a, 's> {
    pub wave: &'s mut WaveState<'a>,
    pub queue: &'s PathQueue,
    pub lobes: LobeSet,
}

impl SimdKernel for ShadeQueue<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { wave, queue, lobes } = self;
        for items in queue.rows() {
            match wave.context.quality.integrator {
                Integrator::Path(settings) => L::call(path::ShadePaths { wave, items, lobes, settings }),
                Integrator::Whitted => L::call(whitted::ShadeWhitted { wave, items, lobes }),
            }
        }
    }
}
