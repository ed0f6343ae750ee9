//! Searches along the rays of lanes, one ray at a time: for shapes that lanes would search in different places.

use super::{LaneHit, PreparedRay, RayInterval, ShapeHit, StoredRays, store_lanes};
use crate::base::lanes::{Mask, Real, Row, lanes};
use crate::geometry::bvh::TraversalRay;

/// Searches along the ray of each lane that may hit something.
#[inline(always)]
pub fn search_each<F: Real>(
    ray: &PreparedRay<F>,
    within: RayInterval<F>,
    mut search: impl FnMut(usize, &TraversalRay, RayInterval<f64>),
) {
    let (rays, wanted) = (StoredRays::of(&ray.ray), within.min.lt(within.max).bits());
    let [min, max] = [store_lanes(within.min), store_lanes(within.max)];
    for lane in lanes(wanted) {
        let span = RayInterval { min: min[lane], max: max[lane] };
        search(lane, &TraversalRay::new(rays.one(lane)), span);
    }
}

/// The hit that a search finds along the ray of each lane.
#[inline(always)]
pub fn first_hits<F: Real>(
    ray: &PreparedRay<F>,
    within: RayInterval<F>,
    mut first: impl FnMut(&TraversalRay, RayInterval<f64>) -> Option<ShapeHit>,
) -> LaneHit<F> {
    let (mut t, mut parts) = (F::splat(f64::INFINITY).to_array(), F::U32::splat(0).to_array());
    let mut coincident = 0;
    search_each(ray, within, |lane, ray, span| {
        if let Some(at) = first(ray, span) {
            (t[lane], parts[lane]) = (at.t, at.part);
            coincident |= u32::from(at.coincident) << lane;
        }
    });
    LaneHit {
        t: F::from_array(t),
        part: F::U32::from_array(parts),
        coincident: F::Mask::from_bits(coincident),
    }
}
