//! Queries of the tree along eight rays.

use super::bundle_any_hit::LaneAnyHit;
use super::bvh::Bvh;
use super::closest::{LaneClosestHit, LaneHits};
use super::grouping::Grouping;
use super::occlusion::{Occlusion, TransmissiveFlags};
use crate::base::lanes::{Level, Mask, lanes};
use crate::base::math::LaneRay;
use crate::geometry::bvh::{BundleStack, BundleWork, Stack, TraversalRay};
use crate::geometry::shape::{PreparedRay, RayInterval, StoredRays};
use crate::scene::Geometry;

/// Whether the rays of a stage have similar directions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Coherence {
    /// Eight neighbours have similar directions: from the camera, or to a light.
    Coherent,
    #[default]
    Incoherent,
}

/// What the searches of a stage share: memory, whose content before and after a search has no meaning, and how rays
/// that go different ways are searched.
#[derive(Default)]
pub struct Stacks {
    single: Stack,
    /// For the trees of shapes in the leaves.
    parts: Stack,
    bundle: BundleStack,
    grouping: Grouping,
}

impl Stacks {
    /// Sets whether searches shall show which hits of meshes are isolated.
    pub fn find_isolated(&mut self, isolates: bool) {
        self.parts.isolates = isolates;
    }
}

#[warn(missing_docs)]
impl Bvh {
    /// The closest primitives along the rays in the lanes of a mask, within bounds.
    #[inline(always)]
    pub fn intersect<L: Level>(
        &self,
        geometry: &Geometry,
        ray: &LaneRay<L::F64>,
        within: RayInterval<L::F64>,
        wanted: L::Mask,
        coherence: Coherence,
        stacks: &mut Stacks,
    ) -> LaneHits<L::F64> {
        let prepared = PreparedRay::new(*ray);
        let mut nearest = LaneClosestHit::new(&prepared, self.reach, within, wanted);
        nearest.test(geometry, &self.direct, None);
        if self.tree.is_empty() && self.meshes.is_empty() {
            return nearest.hits;
        }
        let Stacks { single, parts, bundle, grouping } = stacks;
        let is_apart = self.has_parts && coherence == Coherence::Incoherent;
        nearest.test(geometry, &self.meshes, is_apart.then_some(&mut *parts));
        if self.tree.is_empty() {
            return nearest.hits;
        }
        let is_bundle = coherence == Coherence::Coherent || self.tree.is_small();
        if is_bundle || grouping.together() {
            bundle.work = BundleWork::default();
            self.intersect_in_bundle::<L>(geometry, &mut nearest, (bundle, is_apart.then_some(&mut *parts)));
            if !is_bundle {
                grouping.add(bundle.work);
            }
            return nearest.hits;
        }
        let rays = StoredRays::of(ray);
        let mut hits = nearest.hits.store();
        let within = nearest.bounds();
        for lane in lanes(wanted.bits()) {
            let ray = TraversalRay::new(rays.one(lane));
            let span = RayInterval { min: within[0][lane], max: within[1][lane] };
            let stacks = (&mut *single, &mut *parts);
            let hit = self.intersect_on::<L::Narrow>(geometry, &ray, span, hits.lane(lane), stacks);
            hits.set_lane(lane, hit);
        }
        hits.load()
    }

    /// The rays in the lanes of a mask that something blocks or dims, within bounds.
    #[inline(always)]
    pub fn occlusion<L: Level>(
        &self,
        geometry: &Geometry,
        ray: &LaneRay<L::F64>,
        within: RayInterval<L::F64>,
        wanted: L::Mask,
        (coherence, transmissive): (Coherence, Option<TransmissiveFlags>),
        stacks: &mut Stacks,
    ) -> Occlusion<L::Mask> {
        let prepared = PreparedRay::new(*ray);
        let mut found = LaneAnyHit::<L>::new(&prepared, within, wanted, transmissive);
        found.test(geometry, &self.direct, wanted, None);
        if (self.tree.is_empty() && self.meshes.is_empty()) || !found.open().any() {
            return found.occlusion();
        }
        let Stacks { single, parts, bundle, grouping } = stacks;
        let is_apart = self.has_parts && coherence == Coherence::Incoherent;
        found.test(geometry, &self.meshes, found.open(), is_apart.then_some(&mut *parts));
        if self.tree.is_empty() || !found.open().any() {
            return found.occlusion();
        }
        let is_bundle = coherence == Coherence::Coherent || self.tree.is_small();
        if is_bundle || grouping.together() {
            bundle.work = BundleWork::default();
            self.occlusion_in_bundle::<L>(geometry, &mut found, (bundle, is_apart.then_some(&mut *parts)));
            if !is_bundle {
                grouping.add(bundle.work);
            }
            return found.occlusion();
        }
        let rays = StoredRays::of(ray);
        let bounds = found.bounds();
        let mut bits = found.bits();
        for lane in lanes(found.open().bits()) {
            let ray = TraversalRay::new(rays.one(lane));
            let span = RayInterval { min: bounds[0][lane], max: bounds[1][lane] };
            let [blocked, dimmed] =
                self.occlusion_on::<L::Narrow>(geometry, &ray, span, transmissive, (single, parts));
            bits[0] |= u32::from(blocked) << lane;
            bits[1] |= u32::from(dimmed) << lane;
        }
        Occlusion { blocked: L::Mask::from_bits(bits[0]), dimmed: L::Mask::from_bits(bits[1] & !bits[0]) }
    }
}
