//! The surfaces that paths hit, in lanes.

use super::coincident::{Events, NO_EVENT};
use super::context::TraceContext;
use super::intersect::HitStream;
use super::materials::LobeSet;
use super::stream::PathState;
use crate::base::lanes::{Bits, Lookup, Mask, Real, Row, Select, Vec3, lanes};
use crate::base::math::LaneRay;
use crate::geometry::shape::{LaneHit, LaneSurface};

/// The point where a path hits a surface, in each lane.
#[derive(Clone, Copy)]
pub struct SurfaceInteraction<F: Real> {
    pub at: LaneHit<F>,
    /// The surface, turned towards the origin of the path.
    pub surface: LaneSurface<F>,
    /// Lanes that come from the side of the surface's own normal.
    pub outside: F::Mask,
    pub primitive: F::U32,
    pub material: F::U32,
    /// The width of the path's ray cone.
    pub width: F,
    /// The event, if surfaces coincide; [`ISOLATED`](super::coincident::ISOLATED) or [`NO_EVENT`] otherwise.
    pub event: F::U32,
}

impl<F: Real> SurfaceInteraction<F> {
    /// The hits of paths in the lanes of a mask. `places` are their indices in the stream.
    #[inline(always)]
    pub fn gather(
        context: &TraceContext,
        path: &PathState<F>,
        (hits, places): (&HitStream, &Lookup),
        wanted: F::Mask,
    ) -> Self {
        let mut all = Self::at_hits(path, (hits, places));
        all.find(context, &path.ray, wanted);
        all
    }

    /// The hits of paths, without the surfaces, which [`SurfaceInteraction::find`] adds.
    #[inline(always)]
    pub fn at_hits(path: &PathState<F>, (hits, places): (&HitStream, &Lookup)) -> Self {
        let at = hits.at::<F>(places);
        Self {
            surface: LaneSurface::nowhere(),
            outside: F::Mask::splat(true),
            primitive: F::U32::gather(&hits.primitive, places),
            material: F::U32::gather(&hits.material, places),
            width: path.cone.width_at(at.t),
            event: F::U32::gather(&hits.event, places),
            at,
        }
    }

    /// The points where rays in the lanes of a mask hit primitives of these materials, for cones of this width.
    #[inline(always)]
    pub fn new(
        context: &TraceContext,
        ray: &LaneRay<F>,
        (at, primitive, material): (LaneHit<F>, F::U32, F::U32),
        width: F,
        wanted: F::Mask,
    ) -> Self {
        let (surface, outside) = (LaneSurface::nowhere(), F::Mask::splat(true));
        let event = F::U32::splat(NO_EVENT);
        let mut all = Self { at, surface, outside, primitive, material, width, event };
        all.find(context, ray, wanted);
        all
    }

    /// Finds the surfaces at the hits of rays in the lanes of a mask.
    #[inline(always)]
    pub fn find(&mut self, context: &TraceContext, ray: &LaneRay<F>, wanted: F::Mask) {
        let geometry = context.scene.geometry;
        geometry.find_surfaces(ray, (self.at, self.primitive), wanted, &mut self.surface);
        if !context.quality.smooth_terminator {
            self.surface.lift = Vec3::zero();
        }
        // Surfaces are two-sided: the normal faces the eye.
        self.outside = self.surface.normal.dot(ray.direction).le(F::splat(0.0));
        self.surface.flip(!self.outside);
    }

    /// Prepares the surfaces for rays that pass them, for materials with these lobes: moves hits off the edges of
    /// triangles, and widens error bounds by surfaces that coincide.
    #[inline(always)]
    pub fn prepare(&mut self, context: &TraceContext, lobes: LobeSet, events: &Events, wanted: F::Mask) {
        if lobes.has(LobeSet::PASSES) {
            let (indices, parts, mut rest) = (self.primitive.to_array(), self.at.part, wanted.bits());
            while rest != 0 {
                let index = indices[rest.trailing_zeros() as usize];
                let same = self.primitive.eq(F::U32::splat(index));
                rest &= !same.bits();
                // As in `Geometry::find_surfaces`.
                let own = F::U32::select(same, parts, F::U32::splat(0));
                let passed = context.scene.geometry.primitives[index as usize].passed(self.surface, own);
                self.surface = LaneSurface::select(same, passed, self.surface);
            }
        }
        if events.is_empty() {
            return;
        }
        let numbers = self.event.to_array();
        for lane in lanes(wanted.bits()) {
            if numbers[lane] != NO_EVENT
                && let Some(event) = events.get(numbers[lane])
            {
                let here = F::Mask::from_bits(1 << lane);
                let reach = F::select(here, F::splat(event.reach), F::splat(0.0));
                self.surface.error = self.surface.error + self.surface.normal.abs() * reach;
            }
        }
    }
}
