//! Traversal of small trees along a bundle of rays: first all boxes, then the leaves that rays meet.

use super::bundle::{BundleStack, BundleVisitor, Place};
use super::bundle_slabs::BundleSlabs;
use super::tree::{Child, Tree};
use crate::base::lanes::{Bits, LaneKernel, Level, Mask, Row};

/// The most leaves that are visited together.
const MOST: usize = 64;

/// Trees of at most this many nodes are swept.
const SWEPT: usize = 64;

/// Memory for a sweep, whose content before and after it has no meaning.
pub(super) struct SweepMemory {
    /// The rays at each node. Those at leaves go to the last entry.
    open: [u32; SWEPT + 1],
    /// The leaves that some rays meet, and the bits of these rays.
    leaves: [(Place, u32); MOST],
    keys: Keys,
}

impl Default for SweepMemory {
    fn default() -> Self {
        Self { open: [0; SWEPT + 1], leaves: [(Place::new(Child(0), 0), 0); MOST], keys: [0; MOST + 8] }
    }
}

impl Tree {
    /// Whether the tree is small enough for a [sweep](Tree::sweep).
    #[inline(always)]
    pub(super) fn is_swept(&self) -> bool {
        self.nodes.len() <= SWEPT
    }

    /// Visits every leaf of a small tree that the rays may hit. Eight rays are tested with a box in less time than a walk
    /// takes to postpone one and to find the next. So the boxes of all children are tested, parents first, without a
    /// branch for each: which of them rays meet cannot be predicted.
    #[inline(always)]
    pub(super) fn sweep<L: Level, T: BundleVisitor<L>>(
        &self,
        slabs: &BundleSlabs<L>,
        rays: u32,
        leaves: &mut T,
        stack: &mut BundleStack,
    ) {
        L::call_with(Sweep { tree: self, slabs, rays, leaves, stack });
    }

    #[inline(always)]
    fn sweep_inline<L: Level, T: BundleVisitor<L>>(
        &self,
        slabs: &BundleSlabs<L>,
        rays: u32,
        leaves: &mut T,
        BundleStack { met, work, .. }: &mut BundleStack,
    ) {
        // The bits of the nodes that rays meet. Children follow their parents.
        let mut nodes = 1u64 << (self.root.0 % SWEPT as u32);
        met.open[self.root.0 as usize % SWEPT] = rays;
        while nodes != 0 {
            let (mut count, limit) = (0, leaves.limit());
            while nodes != 0 && count <= MOST - 8 {
                let index = nodes.trailing_zeros();
                nodes &= nodes - 1;
                let (node, rays) = (&self.nodes[index as usize], met.open[index as usize % SWEPT]);
                work.add(rays);
                for (slot, &child) in node.children.iter().enumerate() {
                    let (bits, enter) = slabs.test(node, slot, limit);
                    let rays = bits & rays;
                    let (is_met, is_leaf) = (rays != 0, child.as_leaf().is_some());
                    let enter = enter.to_array()[rays.trailing_zeros() as usize & 7];
                    nodes |= u64::from(is_met && !is_leaf) << (child.0 % SWEPT as u32);
                    met.open[if is_leaf { SWEPT } else { child.0 as usize % SWEPT }] = rays;
                    // Rays enter at t ≥ 0, so the bits ascend with t, but for the lowest ones.
                    met.keys[count % MOST] = enter.to_bits() & !(MOST as u32 - 1) | count as u32;
                    met.leaves[count % MOST] = (Place::new(Child(index), slot), rays);
                    count += usize::from(is_met && is_leaf);
                }
            }
            self.visit_met(slabs, (met, count), leaves);
        }
    }

    /// Visits leaves that rays meet.
    #[inline(always)]
    fn visit_met<L: Level, T: BundleVisitor<L>>(
        &self,
        slabs: &BundleSlabs<L>,
        (met, count): (&mut SweepMemory, usize),
        leaves: &mut T,
    ) {
        L::U32::splat(u32::MAX).store(&mut met.keys, count);
        let is_sorted = T::IN_ORDER && count > 1;
        let order = if is_sorted { sorted::<L>(&met.keys, count) } else { IN_PLACE };
        for number in &order[..count] {
            let (place, mut rays) = met.leaves[usize::from(*number) % MOST];
            let (node, slot) = place.of(self);
            if is_sorted {
                // Hits in nearer leaves may have ended the searches of its rays.
                rays &= slabs.test(node, slot, leaves.limit()).0;
            }
            if rays != 0
                && let Some(leaf) = node.children[slot].as_leaf()
            {
                leaves.visit(leaf, rays);
            }
        }
    }
}

/// A sweep, out of line: beside walks, it would take their registers.
struct Sweep<'a, L: Level, T> {
    tree: &'a Tree,
    slabs: &'a BundleSlabs<L>,
    rays: u32,
    leaves: &'a mut T,
    stack: &'a mut BundleStack,
}

impl<L: Level, T: BundleVisitor<L>> LaneKernel<L> for Sweep<'_, L, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        self.tree.sweep_inline(self.slabs, self.rays, self.leaves, self.stack);
    }
}

/// Where rays enter leaves, in numbers that all differ.
type Keys = [u32; MOST + 8];

/// The places of `count` keys in ascending order. The eight keys behind them are the largest.
#[inline(always)]
fn sorted<L: Level>(keys: &Keys, count: usize) -> [u8; MOST] {
    let mut order = [0; MOST];
    for (number, &key) in keys.iter().enumerate().take(count) {
        let (key, mut rank) = (L::U32::splat(key), 0);
        for from in (0..count).step_by(8) {
            rank += L::U32::load(keys, from).lt(key).bits().count_ones();
        }
        order[rank as usize % MOST] = number as u8;
    }
    order
}

/// The order of the tree.
const IN_PLACE: [u8; MOST] = {
    let (mut order, mut number) = ([0; MOST], 0);
    while number < MOST {
        order[number] = number as u8;
        number += 1;
    }
    order
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::lanes::tests::on_all_levels;
    use crate::base::lanes::{SimdKernel, dispatch};
    use crate::base::math::{Aabb, DVec3, Ray};
    use crate::testing::{Random, eight_rays};

    #[test]
    fn keys_are_sorted() {
        let mut random = Random(3);
        for count in 0..=MOST {
            let mut keys = [u32::MAX; MOST + 8];
            for (number, key) in keys.iter_mut().enumerate().take(count) {
                *key = (random.unit() * 4.0) as u32 * 64 + number as u32;
            }
            for (_, order) in on_all_levels(|| dispatch(Sort(&keys, count))) {
                let found: Vec<u32> =
                    order[..count].iter().map(|number| keys[usize::from(*number)]).collect();
                let mut expected = keys[..count].to_vec();
                expected.sort_unstable();
                assert_eq!(found, expected);
            }
        }
    }

    struct Sort<'a>(&'a Keys, usize);

    impl SimdKernel for Sort<'_> {
        type Output = [u8; MOST];

        #[inline(always)]
        fn run<L: Level>(self) -> [u8; MOST] {
            sorted::<L>(self.0, self.1)
        }
    }

    /// Records the leaves that are visited, and their rays.
    struct Record<L: Level, const IN_ORDER: bool> {
        limit: L::F32,
        visits: Vec<(u32, u32)>,
    }

    impl<L: Level, const IN_ORDER: bool> BundleVisitor<L> for Record<L, IN_ORDER> {
        const IN_ORDER: bool = IN_ORDER;

        #[inline(always)]
        fn visit(&mut self, leaf: u32, rays: u32) {
            self.visits.push((leaf, rays));
        }

        #[inline(always)]
        fn limit(&self) -> L::F32 {
            self.limit
        }
    }

    struct Compare<'a, const IN_ORDER: bool>(&'a Tree, &'a [Ray; 8]);

    impl<const IN_ORDER: bool> SimdKernel for Compare<'_, IN_ORDER> {
        /// The number of leaves that are visited.
        type Output = usize;

        #[inline(always)]
        fn run<L: Level>(self) -> usize {
            let (tree, ray) = (self.0, eight_rays::<L>(self.1));
            let (slabs, near, _) = BundleSlabs::<L>::new(tree, &ray, L::F64::splat(0.0), 0xff);
            let limit = slabs.limit(L::F64::splat(20.0));
            // All leaves that rays meet, with where their lowest ray enters them.
            let (mut pending, mut expected) = (vec![(tree.root, near)], Vec::new());
            while let Some((at, rays)) = pending.pop() {
                let node = &tree.nodes[at.0 as usize];
                for (slot, &child) in node.children.iter().enumerate() {
                    let (bits, enter) = slabs.test(node, slot, limit);
                    let rays = bits & rays;
                    match child.as_leaf() {
                        _ if rays == 0 => {}
                        None => pending.push((child, rays)),
                        Some(leaf) => {
                            expected.push((leaf, rays, enter.to_array()[rays.trailing_zeros() as usize]));
                        }
                    }
                }
            }
            let mut record = Record::<L, IN_ORDER> { limit, visits: Vec::new() };
            tree.sweep(&slabs, near, &mut record, &mut BundleStack::default());
            let entered = |visit: &(u32, u32)| {
                expected.iter().find(|(leaf, rays, _)| (*leaf, *rays) == *visit).map(|found| found.2)
            };
            let enters: Vec<f32> = record.visits.iter().filter_map(entered).collect();
            assert_eq!((record.visits.len(), enters.len()), (expected.len(), expected.len()));
            if IN_ORDER && enters.len() <= MOST - 8 {
                assert!(enters.windows(2).all(|pair| pair[0] <= pair[1] * 1.0001), "{enters:?}");
            }
            record.visits.sort_unstable();
            record.visits.dedup_by_key(|(leaf, _)| *leaf);
            assert_eq!(record.visits.len(), expected.len());
            expected.len()
        }
    }

    #[test]
    fn sweeps_visit_every_leaf_that_rays_meet_once() {
        let mut random = Random(12);
        let mut most = 0;
        for (count, size) in [(9, 1.0), (40, 1.0), (200, 1.0), (200, 8.0), (300, 20.0)] {
            let boxes: Vec<Aabb> = (0..count)
                .map(|_| {
                    let min = random.point(4.0);
                    Aabb { min, max: min + DVec3::splat(size * random.unit()) }
                })
                .collect();
            let (tree, _) = Tree::of_boxes(&boxes);
            if !tree.is_swept() {
                continue;
            }
            for _ in 0..100 {
                let rays = [0; 8].map(|_| Ray { origin: random.point(6.0), direction: random.point(1.0) });
                for (_, met) in on_all_levels(|| dispatch(Compare::<true>(&tree, &rays))) {
                    most = most.max(met);
                }
                on_all_levels(|| dispatch(Compare::<false>(&tree, &rays)));
            }
        }
        // More than are visited together.
        assert!(most > MOST, "{most}");
    }
}
