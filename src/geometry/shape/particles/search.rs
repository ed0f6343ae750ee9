//! Searches particles along a single ray, eight spheres at a time.

use super::Particles;
use super::packet::SpherePacket;
use crate::base::lanes::{Level, Mask, Row, lanes};
use crate::geometry::bvh::{Slabs, Tree};
use crate::geometry::shape::nearest_part::NearestPart;
use crate::geometry::shape::part_search::{AnyPart, EveryPart, PartSearch, PartedShape};
use crate::geometry::shape::{Geometric, PreparedRay, RayInterval, ShapeHit};

impl PartedShape for Particles {
    type Packet = SpherePacket;
    type Prepared = ();

    #[inline(always)]
    fn tree(&self) -> &Tree {
        self.0.tree()
    }

    #[inline(always)]
    fn packets(&self) -> &[SpherePacket] {
        self.0.packets()
    }

    #[inline(always)]
    fn nearest_in<L: Level>(
        search: &mut PartSearch<Self, NearestPart>,
        leaf: u32,
        slabs: &Slabs,
        _: f32,
    ) -> f32 {
        let (packet, nearest) = (&search.shape.packets()[leaf as usize], &mut search.kept);
        let row = L::F64::splat;
        let within = RayInterval { min: row(nearest.within.min), max: row(nearest.limit()) };
        let at = packet.lanes::<L>().intersect(&PreparedRay::splat(search.ray), within);
        let (hit, t) = (at.is_hit().bits(), at.t.to_array());
        for lane in lanes(hit & ((1 << packet.count()) - 1)) {
            if t[lane] < nearest.limit() {
                nearest.consider(ShapeHit::of_part(t[lane], packet.part(lane)));
            }
        }
        slabs.limit(nearest.limit())
    }

    #[inline(always)]
    fn any_in<L: Level>(search: &mut PartSearch<Self, AnyPart>, leaf: u32, _: &Slabs, _: f32) -> bool {
        let (row, within) = (L::F64::splat, search.kept.within);
        let within = RayInterval { min: row(within.min), max: row(within.max) };
        let spheres = search.shape.packets()[leaf as usize].lanes::<L>();
        spheres.intersect(&PreparedRay::splat(search.ray), within).is_hit().any()
    }

    #[inline(always)]
    fn every_in<L: Level>(search: &mut PartSearch<Self, EveryPart>, leaf: u32, _: &Slabs, _: f32) {
        let (packet, ray) = (&search.shape.packets()[leaf as usize], PreparedRay::splat(search.ray));
        for lane in 0..packet.count() {
            let (sphere, mut within) = (packet.sphere(lane), search.kept.within);
            while let Some(at) = sphere.intersect(&ray, within).one() {
                (search.kept.take)(ShapeHit::of_part(at.t, packet.part(lane)));
                within.min = at.t;
            }
        }
    }
}
