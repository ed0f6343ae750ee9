//! Box tests of the rays of a bundle one by one, each with the eight children of a node at once.

use super::slabs::{SPREAD, WideSlabs};
use super::tree::Node;
use crate::base::lanes::{Mask, Single};

/// The rays of a bundle in memory, in the form of [`BundleSlabs`](super::BundleSlabs).
pub(super) struct Rows {
    enter: [[[f32; 8]; 2]; 3],
    leave: [[[f32; 8]; 2]; 3],
    backwards: [u32; 3],
    from: [f32; 8],
}

/// The children of a node that some rays may hit.
pub(super) struct Met {
    /// Their bits.
    pub children: u32,
    /// The bits of the children that each ray may hit, a byte for a ray.
    by_ray: u64,
    /// Where the first of its rays enters each child.
    pub enter: [f32; 8],
}

impl Met {
    /// The bits of the rays that may hit a child.
    #[inline(always)]
    pub fn rays(&self, slot: usize) -> u32 {
        // The product moves bit 0 of byte r to bit 56 + r. No two of its terms are the same bit.
        let bits = self.by_ray >> (slot & 7) & 0x0101_0101_0101_0101;
        (bits.wrapping_mul(0x0102_0408_1020_4080) >> 56) as u32
    }
}

impl Rows {
    #[inline(always)]
    pub fn new<S: Single<Array = [f32; 8]>>(
        enter: [[S; 2]; 3],
        leave: [[S; 2]; 3],
        backwards: [u32; 3],
        from: S,
    ) -> Self {
        Self { enter: store(enter), leave: store(leave), backwards, from: from.to_array() }
    }

    /// The children of a node that some rays may hit before their limits.
    #[inline(always)]
    pub fn test<S: Single<Array = [f32; 8]>>(&self, node: &Node, mut rays: u32, limit: S) -> Met {
        let limits = (limit * S::splat(SPREAD as f32)).to_array();
        let never = S::splat(f32::INFINITY);
        let (mut children, mut by_ray, mut first) = (0, 0, never);
        while rays != 0 {
            let ray = rays.trailing_zeros() as usize & 7;
            rays &= rays - 1;
            let (enter, leave) = self.ray::<S>(ray).crossings(node, limits[ray]);
            let is_met = enter.le(leave);
            first = first.min(S::select(is_met, enter, never));
            children |= is_met.bits();
            by_ray |= u64::from(is_met.bits()) << (8 * ray);
        }
        Met { children, by_ray, enter: first.to_array() }
    }

    /// A ray in the form that tests eight boxes at once.
    #[inline(always)]
    fn ray<S: Single<Array = [f32; 8]>>(&self, ray: usize) -> WideSlabs<S> {
        let nothing = [[S::splat(0.0); 2]; 3];
        let mut slabs =
            WideSlabs { enter: nothing, leave: nothing, near: [0; 3], from: S::splat(self.from[ray]) };
        for axis in 0..3 {
            for part in 0..2 {
                slabs.enter[axis][part] = S::splat(self.enter[axis][part][ray]);
                slabs.leave[axis][part] = S::splat(self.leave[axis][part][ray]);
            }
            slabs.near[axis] = (self.backwards[axis] >> ray & 1) as usize;
        }
        slabs
    }
}

#[inline(always)]
fn store<S: Single<Array = [f32; 8]>>([[a, b], [c, d], [e, f]]: [[S; 2]; 3]) -> [[[f32; 8]; 2]; 3] {
    [[a.to_array(), b.to_array()], [c.to_array(), d.to_array()], [e.to_array(), f.to_array()]]
}

#[cfg(test)]
mod tests {
    use super::super::bundle_slabs::BundleSlabs;
    use super::super::tree::Tree;
    use crate::base::lanes::tests::on_all_levels;
    use crate::base::lanes::{Level, Mask, Row, Select, SimdKernel, dispatch};
    use crate::base::math::{Aabb, DVec3, Ray};
    use crate::testing::{Random, eight_rays};

    struct Compare<'a>(&'a Tree, &'a [Ray; 8], u32, [f64; 8]);

    impl SimdKernel for Compare<'_> {
        /// The number of pairs of a ray and a child that meet.
        type Output = u32;

        #[inline(always)]
        fn run<L: Level>(self) -> u32 {
            let Self(tree, rays, wanted, max) = self;
            let ray = eight_rays::<L>(rays);
            let (slabs, near, _) = BundleSlabs::<L>::new(tree, &ray, L::F64::splat(0.0), wanted);
            let Some(rows) = &slabs.rows else { return 0 };
            let open = L::F64::select(L::Mask::from_bits(near), L::F64::from_array(max), L::F64::splat(-1.0));
            let (limit, mut count) = (slabs.limit(open), 0);
            for node in &tree.nodes {
                let met = rows.test(node, near, limit);
                for slot in 0..8 {
                    let (bits, enter) = slabs.test(node, slot, limit);
                    let (bits, enter) = (bits & near, enter.to_array());
                    assert_eq!(met.rays(slot), bits);
                    assert_eq!(met.children >> slot & 1 == 1, bits != 0);
                    let first = (0..8).filter(|ray| bits >> ray & 1 == 1).map(|ray| enter[ray]);
                    assert_eq!(met.enter[slot], first.fold(f32::INFINITY, f32::min));
                    count += bits.count_ones();
                }
            }
            count
        }
    }

    #[test]
    fn rays_meet_the_children_that_meet_them() {
        let mut random = Random(8);
        let boxes: Vec<Aabb> = (0..1000)
            .map(|_| {
                let min = random.point(4.0);
                Aabb { min, max: min + DVec3::splat(random.unit()) }
            })
            .collect();
        let (tree, _) = Tree::of_boxes(&boxes);
        let mut met = 0;
        for _ in 0..300 {
            let rays = [0; 8].map(|_| Ray { origin: random.point(6.0), direction: random.point(1.0) });
            let (wanted, max) = ((256.0 * random.unit()) as u32, [0; 8].map(|_| 20.0 * random.unit()));
            for (_, count) in on_all_levels(|| dispatch(Compare(&tree, &rays, wanted, max))) {
                met += count;
            }
        }
        assert!(met > 5000, "{met}");
    }
}
