//! The shadow stage: how much of the sampled light arrives.
//!
//! In: shadow rays to one light, in the order in which surfaces sampled it. Out: light for the sums.

use super::accumulate::Accumulator;
use super::coincident::Events;
use super::context::TraceContext;
use super::materials::LobeTable;
use super::medium::MediaLists;
use super::segment::transmittance;
use super::shadow_stream::ShadowStream;
use super::transmit::Transmit;
use crate::base::lanes::{Color, Level, Lookup, Mask, Select, SimdKernel};
use crate::base::stats::Counts;
use crate::film::LayerId;
use crate::geometry::shape::Span;
use crate::scene::top_level::{Coherence, Stacks};

/// Casts the shadow rays to one light, and adds what of its light arrives.
pub struct Cast<'a> {
    pub context: &'a TraceContext<'a>,
    pub shadows: &'a ShadowStream,
    /// Of the light.
    pub layer: LayerId,
    pub coherence: Coherence,
    pub events: &'a mut Events,
    pub media: &'a mut MediaLists,
    pub rows: &'a mut LobeTable,
    pub sums: &'a mut Accumulator,
    pub counts: &'a mut Counts,
}

impl SimdKernel for Cast<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(mut self) {
        let mut stacks = Stacks::default();
        for first in (0..self.shadows.len()).step_by(8) {
            self.cast::<L>(first, &mut stacks);
        }
    }
}

impl Cast<'_> {
    /// Casts the rays from `first` on, eight at most.
    #[inline(always)]
    fn cast<L: Level>(&mut self, first: usize, stacks: &mut Stacks) {
        let Self { context, shadows, .. } = *self;
        let count = (shadows.len() - first).min(8);
        let at = Lookup::run(first as u32, count);
        let there = L::Mask::from_bits(0xff >> (8 - count));
        let shadow = shadows.ray::<L::F64>(&at);
        // Rays at the light itself lead nowhere: nothing can stand in their way.
        let leads = there & shadow.ray.direction.is_not_zero();
        self.counts.rays.shadow += u64::from(leads.bits().count_ones());
        let (within, passing) = (Span::up_to(shadow.t_max), context.passing());
        let (bvh, geometry) = (context.bvh, context.scene.geometry);
        let found =
            bvh.occlusion::<L>(geometry, &shadow.ray, within, leads, (self.coherence, passing), stacks);
        let mut light: Color<L::F32> = shadows.light(&at);
        let mut weighed: Color<L::F32> = Color::black();
        if context.clear {
            weighed = shadows.weighed(&at);
        }
        let open = there & !found.blocked & !found.dimmed;
        if context.media {
            let inside = shadows.media::<L::U32>(&at);
            let length = shadow.ray.direction.length() * shadow.t_max;
            if let Some(left) = transmittance::<L::F64>(self.media, inside, length) {
                light = Color::select(open, light * left, light);
                weighed = Color::select(open, weighed * left, weighed);
            }
        }
        let mut arrives = open;
        if found.dimmed.any() {
            let inside = shadows.media::<L::U32>(&at);
            let (context, coherence) = (self.context, self.coherence);
            let Self { events, media, rows, counts, .. } = self;
            let (ray, wanted) = (&shadow, found.dimmed);
            let walk =
                Transmit { context, ray, inside, wanted, coherence, stacks, events, media, rows, counts };
            let left = L::call_with::<Transmit<L>>(walk);
            light = Color::select(found.dimmed, light * left.whole, light);
            weighed = Color::select(found.dimmed, weighed * left.transmitted, weighed);
            arrives = arrives | found.dimmed;
        }
        self.sums.add::<L::F64>(self.layer, light - weighed, arrives, shadows.slots(&at));
    }
}
