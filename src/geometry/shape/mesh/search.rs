//! Searches a mesh along a single ray.

use super::Mesh;
use super::encounters::Encounters;
use crate::base::lanes::{Level, Row, lanes};
#[cfg(doc)]
use crate::geometry::bvh::CLEARANCE;
use crate::geometry::bvh::{Slabs, TraversalRay, Tree};
use crate::geometry::mesh::{Packet, ShearedRay};
use crate::geometry::shape::nearest_part::NearestPart;
use crate::geometry::shape::part_search::{AnyPart, EveryPart, PartSearch, PartedShape};
use crate::geometry::shape::triangle::{TriangleLanes, covers};
use crate::geometry::shape::{PreparedRay, ShapeHit};

/// What the leaves of a search share.
pub struct Prepared {
    sheared: ShearedRay,
    encounters: Encounters,
}

impl Prepared {
    #[inline(always)]
    fn new(ray: &TraversalRay, slabs: &Slabs) -> Self {
        Self { sheared: ShearedRay::new(ray, slabs), encounters: Encounters::new() }
    }
}

impl PartedShape for Mesh {
    type Packet = Packet;
    type Prepared = Prepared;

    #[inline(always)]
    fn tree(&self) -> &Tree {
        self.mesh.tree()
    }

    #[inline(always)]
    fn packets(&self) -> &[Packet] {
        self.mesh.packets()
    }

    /// Certain hits of the filter are not tested again; only their t is computed.
    ///
    /// A certain hit is isolated if no other triangle that the ray's line meets, or may meet, reaches its depth. The
    /// filter's error is far above [`CLEARANCE`], so it calls no triangle so near to the hit a miss. It leaves out
    /// triangles before the ray's start and beyond a limit, which never comes before the hit.
    #[inline(always)]
    fn nearest_in<L: Level>(
        search: &mut PartSearch<Self, NearestPart>,
        leaf: u32,
        slabs: &Slabs,
        mut limit: f32,
    ) -> f32 {
        let (mesh, ray, within) = (&search.shape.mesh, search.ray, search.kept.within);
        let packet = &mesh.packets()[leaf as usize];
        let Prepared { sheared, encounters } =
            search.prepared.get_or_insert_with(|| Prepared::new(ray, slabs));
        let edge_test = sheared.test_edges::<L::F32>(packet, limit);
        let classes = sheared.classify(&edge_test, limit);
        let mut candidates = classes.hit | classes.unsure;
        if candidates == 0 {
            return limit;
        }
        let (near, prepared) = (classes.near.to_array(), PreparedRay::<f64>::splat(ray));
        // No closure: it would be compiled without the level's instructions.
        let depths = if search.kept.isolates { Some(sheared.depths(&edge_test)) } else { None };
        while candidates != 0 {
            let lane = candidates.trailing_zeros() as usize & 7;
            let sure = classes.hit >> lane & 1 == 1;
            candidates &= candidates - 1;
            if let Some([near, far]) = &depths {
                encounters.add([near[lane], far[lane]], packet.part(lane));
            }
            if sure && near[lane] > limit {
                continue;
            }
            let triangle = TriangleLanes::splat(mesh.packed_corners(packet, lane));
            let sheared = triangle.sheared(&prepared);
            if !sure && !covers(&sheared) {
                continue;
            }
            let Some(at) = triangle.crossing(&prepared, &sheared, true, within).one() else { continue };
            let isolated = sure && depths.is_some();
            search.kept.consider(ShapeHit { isolated, ..ShapeHit::of_part(at.t, packet.part(lane)) });
            limit = slabs.limit(search.kept.limit());
        }
        if depths.is_some()
            && let Some(at) = &mut search.kept.hit
        {
            at.isolated &= encounters.is_isolated(at.part, slabs.limit(at.t));
        }
        limit
    }

    #[inline(always)]
    fn any_in<L: Level>(
        search: &mut PartSearch<Self, AnyPart>,
        leaf: u32,
        slabs: &Slabs,
        limit: f32,
    ) -> bool {
        let (mesh, ray, within) = (&search.shape.mesh, search.ray, search.kept.within);
        let packet = &mesh.packets()[leaf as usize];
        let Prepared { sheared, .. } = search.prepared.get_or_insert_with(|| Prepared::new(ray, slabs));
        let edge_test = sheared.test_edges::<L::F32>(packet, limit);
        // The filter's certain results assume t = 0 as the start.
        let from_start = within.min == 0.0;
        if from_start && sheared.within_whole(&edge_test, limit) != 0 {
            return true;
        }
        let classes = sheared.classify(&edge_test, limit);
        let mut candidates = classes.hit | classes.unsure;
        if candidates == 0 {
            return false;
        }
        if from_start && sheared.within(&classes, limit) != 0 {
            return true;
        }
        let prepared = PreparedRay::<f64>::splat(ray);
        while candidates != 0 {
            let lane = candidates.trailing_zeros() as usize & 7;
            candidates &= candidates - 1;
            let triangle = TriangleLanes::splat(mesh.packed_corners(packet, lane));
            let sheared = triangle.sheared(&prepared);
            let covered = classes.hit >> lane & 1 == 1 || covers(&sheared);
            if triangle.crossing(&prepared, &sheared, covered, within).is_hit() {
                return true;
            }
        }
        false
    }

    #[inline(always)]
    fn every_in<L: Level>(search: &mut PartSearch<Self, EveryPart>, leaf: u32, slabs: &Slabs, limit: f32) {
        let (mesh, ray) = (&search.shape.mesh, search.ray);
        let packet = &mesh.packets()[leaf as usize];
        let Prepared { sheared, .. } = search.prepared.get_or_insert_with(|| Prepared::new(ray, slabs));
        let classes = sheared.classify(&sheared.test_edges::<L::F32>(packet, limit), limit);
        let candidates = classes.hit | classes.unsure;
        if candidates == 0 {
            return;
        }
        let (ray, EveryPart { within, take }) = (PreparedRay::splat(ray), &mut search.kept);
        for lane in lanes(candidates) {
            let triangle = TriangleLanes::splat(mesh.packed_corners(packet, lane));
            if let Some(at) = triangle.intersect(&ray, *within).one() {
                take(ShapeHit::of_part(at.t, packet.part(lane)));
            }
        }
    }
}
