//! The shadow stage: traces shadow rays and adds the unoccluded light.
//!
//! In: shadow rays to one light, in the order of the surfaces that sampled it. Out: light for the sums.

use super::accumulate::Accumulator;
use super::coincident::Events;
use super::context::TraceContext;
use super::marks::Marks;
use super::materials::LobeTable;
use super::medium::MediaLists;
use super::segment::transmittance;
use super::shadow_stream::ShadowStream;
use super::transmittance::TraceTransmittance;
use crate::base::lanes::{Color, Level, Lookup, Mask, Select, SimdKernel};
use crate::base::stats::Counts;
use crate::film::LayerId;
use crate::geometry::ray_kinds::RayKind;
use crate::geometry::shape::RayInterval;
use crate::scene::top_level::{Coherence, Stacks};
use std::mem::take;

/// Traces the shadow rays to one light, and adds the light that arrives.
pub struct TraceShadowRays<'a> {
    pub context: &'a TraceContext<'a>,
    pub shadows: &'a ShadowStream,
    /// The layer of the light.
    pub layer: LayerId,
    pub coherence: Coherence,
    pub stacks: &'a mut Stacks,
    pub events: &'a mut Events,
    pub media: &'a mut MediaLists,
    pub rows: &'a mut LobeTable,
    pub sums: &'a mut Accumulator,
    pub marks: &'a mut Marks,
    pub counts: &'a mut Counts,
}

impl SimdKernel for TraceShadowRays<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(mut self) {
        let mut stacks = take(self.stacks);
        for first in (0..self.shadows.len()).step_by(8) {
            self.cast::<L>(first, &mut stacks);
        }
        *self.stacks = stacks;
    }
}

impl TraceShadowRays<'_> {
    /// Traces the rays from `first` on, at most eight.
    #[inline(always)]
    fn cast<L: Level>(&mut self, first: usize, stacks: &mut Stacks) {
        let Self { context, shadows, .. } = *self;
        let count = (shadows.len() - first).min(8);
        let at = Lookup::run(first as u32, count);
        let active = L::Mask::from_bits(0xff >> (8 - count));
        let shadow = shadows.ray::<L::F64>(&at);
        // Rays that start at the light have no direction, and nothing can block them.
        let leads = active & shadow.ray.direction.is_not_zero();
        self.counts.rays.shadow += u64::from(leads.bits().count_ones());
        let (within, passing) = (RayInterval::up_to(shadow.t_max), context.passing());
        let (bvh, geometry) = (context.bvh.of(RayKind::Shadow), context.scene.geometry);
        let found =
            bvh.occlusion::<L>(geometry, &shadow.ray, within, leads, (self.coherence, passing), stacks);
        if let Some(movers) = context.movers {
            let open = leads & !found.blocked & !found.dimmed;
            self.marks.mark_shadows::<L>(movers, &shadow, shadows.slots(&at), (open, found.dimmed));
        }
        let mut light: Color<L::F32> = shadows.light(&at);
        let mut mis_complement: Color<L::F32> = Color::black();
        if context.has_transparency() {
            mis_complement = shadows.mis_complement(&at);
        }
        let open = active & !found.blocked & !found.dimmed;
        if context.absorbs {
            let inside = shadows.media::<L::U32>(&at);
            let length = shadow.ray.direction.length() * shadow.t_max;
            if let Some(left) = transmittance::<L::F64>(self.media, inside, length) {
                light = Color::select(open, light * left, light);
                mis_complement = Color::select(open, mis_complement * left, mis_complement);
            }
        }
        let mut arrives = open;
        if found.dimmed.any() {
            let inside = shadows.media::<L::U32>(&at);
            let (context, coherence) = (self.context, self.coherence);
            let Self { events, media, rows, counts, .. } = self;
            let (ray, wanted) = (&shadow, found.dimmed);
            let walk = TraceTransmittance {
                context,
                ray,
                inside,
                wanted,
                coherence,
                stacks,
                events,
                media,
                rows,
                counts,
            };
            let left = L::call_with::<TraceTransmittance<L>>(walk);
            light = Color::select(found.dimmed, light * left.all, light);
            mis_complement = Color::select(found.dimmed, mis_complement * left.unrefracted, mis_complement);
            arrives = arrives | found.dimmed;
        }
        self.sums.add::<L::F64>(self.layer, light - mis_complement, arrives, shadows.slots(&at));
    }
}
