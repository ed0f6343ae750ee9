//! Traces a few patches of a frame to measure what all of them would cost.

use super::frame_state::FrameState;
use super::prepared_world::PreparedWorld;
use crate::base::clock::{ElapsedTime, TimeSource, timed};
use crate::base::color::Rgb;
use crate::base::stats::Counts;
use crate::film::{AovSet, LayerId};
use crate::scene::Weights;
use crate::sequence::Sequence;
use crate::trace::{Moment, PilotBlocks};
use std::ops::Range;

/// A sequence's world with the systems up to Accelerate.
pub struct Prober {
    world: PreparedWorld,
    /// Measures the time of a pass.
    clock: TimeSource,
}

/// The cost of a pass over all moments of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PassCost {
    /// Time to place objects and build trees.
    pub prepare: ElapsedTime,
    pub trace: ElapsedTime,
    pub rays: u64,
}

impl Prober {
    pub fn new(sequence: &Sequence, aovs: AovSet, clock: TimeSource) -> Self {
        Self { world: PreparedWorld::new(sequence, aovs), clock }
    }

    /// A probe of this number of patches of a frame.
    pub fn probe(&self, state: &FrameState, patches: usize) -> PilotBlocks {
        let settings = &self.world.settings;
        let layers = state.weights.len() + settings.aovs.layers();
        PilotBlocks::new(settings.size, patches, layers, self.world.seed_of(state.frame))
    }

    /// Traces `samples` of all pixels of the probe with the layers `lit`. None if the frame has no camera.
    pub fn pass(
        &mut self,
        state: &FrameState,
        lit: &[LayerId],
        probe: &mut PilotBlocks,
        samples: &Range<u32>,
    ) -> Option<PassCost> {
        let moments = self.world.moments(state);
        let mut weights = Weights(vec![Rgb::ZERO; state.weights.len()]);
        lit.iter().for_each(|layer| weights.0[layer.index()] = Rgb::ONE);
        let mut done = PassCost { prepare: ElapsedTime::ZERO, trace: ElapsedTime::ZERO, rays: 0 };
        probe.begin_pass();
        for (now, moment) in moments {
            let (ready, took) = timed(|| self.world.prepare(now, moment));
            ready.ok()?;
            let (counts, traced) = timed(|| self.trace(&weights, moment, state.random, probe, samples));
            let rays = counts?.rays.total();
            done.prepare = done.prepare + self.clock.elapsed(took, 0);
            done.trace = done.trace + self.clock.elapsed(traced, rays);
            done.rays += rays;
        }
        Some(done)
    }

    fn trace(
        &self,
        weights: &Weights,
        moment: Moment,
        random: bool,
        probe: &mut PilotBlocks,
        samples: &Range<u32>,
    ) -> Option<Counts> {
        let (scene, bvh) = self.world.scene(weights)?;
        Some(probe.trace(&scene, bvh, &self.world.settings, (moment, random), samples))
    }
}
