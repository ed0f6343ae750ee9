//! Decides which nodes of a binary tree become nodes with eight children, at the lowest traversal cost. Dynamic
//! programming from the leaves up, after Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs
//! Through Compressed Wide BVHs".
//!
//! A node and a leaf cost the same per ray that hits their box: one test of eight boxes, or of the primitives in a
//! leaf.

/// The cost of a subtree as a forest of at most 1, 2, ... 7 roots. Element 0 is the cost as a single root.
pub type Costs = [f32; 7];

/// For each number of roots (four bits each), how many of them belong to the left child. 0 stands for a single root.
/// The lowest bit is set if that root is a leaf.
#[derive(Clone, Copy, Debug, Default)]
pub struct CollapsePlan(u32);

/// The costs of a leaf.
pub fn leaf(half_area: f32) -> Costs {
    [half_area; 7]
}

/// The costs and the plan of two subtrees that are joined; `count` is their number of primitives. They may form a leaf
/// if `fits`.
#[inline(always)]
pub fn join(left: &Costs, right: &Costs, half_area: f32, count: usize, fits: bool) -> (Costs, CollapsePlan) {
    let distributed = |roots: usize| {
        let mut best = (f32::INFINITY, 1);
        for of_left in 1..roots {
            let cost = left[of_left - 1] + right[roots - of_left - 1];
            if cost < best.0 {
                best = (cost, of_left as u32);
            }
        }
        best
    };
    // One leaf costs less than a node of leaves.
    let (below, of_left) = if fits { (0.0, 0) } else { distributed(8) };
    let single = half_area + below;
    let (mut costs, mut plan) = ([single; 7], of_left << 28 | u32::from(fits));
    let (mut cost, mut of_left) = (single, 0);
    for roots in 2..8 {
        // There are never more roots than primitives.
        if roots <= count {
            (cost, of_left) = distributed(roots);
        }
        if cost < single {
            costs[roots - 1] = cost;
            plan |= of_left << (4 * (roots - 1));
        }
    }
    (costs, CollapsePlan(plan))
}

impl CollapsePlan {
    /// The plan of an undivided leaf.
    pub const LEAF: Self = Self(1);

    pub fn is_leaf(self) -> bool {
        self.0 & 1 == 1
    }

    /// How many of at most `roots` roots belong to the left child. None if there is one root.
    pub fn of_left(self, roots: usize) -> Option<usize> {
        let of_left = self.0 >> (4 * (roots - 1)) & 15;
        (roots > 1 && of_left > 0).then_some(of_left as usize)
    }
}
