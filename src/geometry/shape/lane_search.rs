//! Searches along the rays of lanes, one ray at a time: for shapes that lanes would search in different places.

use super::{LaneHit, RayInterval, ShapeHit, StoredRays, store_lanes};
use crate::base::lanes::{Mask, Real, lanes};
use crate::base::math::LaneRay;
use crate::geometry::bvh::TraversalRay;

/// Searches along the ray of each lane that may hit something.
#[inline(always)]
pub fn search_each<F: Real>(
    ray: &LaneRay<F>,
    within: RayInterval<F>,
    mut search: impl FnMut(usize, &TraversalRay, RayInterval<f64>),
) {
    let (rays, wanted) = (StoredRays::of(ray), within.min.lt(within.max).bits());
    let [min, max] = [store_lanes(within.min), store_lanes(within.max)];
    for lane in lanes(wanted) {
        let span = RayInterval { min: min[lane], max: max[lane] };
        search(lane, &TraversalRay::new(rays.one(lane)), span);
    }
}

/// The hit that a search finds along the ray of each lane.
#[inline(always)]
pub fn first_hits<F: Real>(
    ray: &LaneRay<F>,
    within: RayInterval<F>,
    mut first: impl FnMut(&TraversalRay, RayInterval<f64>) -> Option<ShapeHit>,
) -> LaneHit<F> {
    let mut hits = [None; 8];
    search_each(ray, within, |lane, ray, span| hits[lane] = first(ray, span));
    LaneHit::from_lanes(&hits)
}
