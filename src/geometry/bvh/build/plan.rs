//! What becomes of the nodes of a binary tree in one with eight children per node, so that rays have the least to do: by
//! dynamic programming from the leaves up, after Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs
//! Through Compressed Wide BVHs".
//!
//! A node and a leaf cost the same, once per ray that meets its box: eight boxes are tested at a time, or the things of
//! a leaf.

/// What a subtree costs as a forest of at most so many roots: [0] as a single one.
pub type Costs = [f32; 7];

/// How many roots of a forest belong to the left child, four bits for each number of roots of both. 0 for a forest that
/// is a single root. The lowest four bits say whether that is a leaf.
#[derive(Clone, Copy, Debug, Default)]
pub struct Plan(u32);

/// The costs of a leaf.
pub fn leaf(measure: f32) -> Costs {
    [measure; 7]
}

/// The costs of two subtrees of `count` things together, and the plan for them. They may be a leaf if `fits`.
#[inline(always)]
pub fn join(left: &Costs, right: &Costs, measure: f32, count: usize, fits: bool) -> (Costs, Plan) {
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
    // A leaf is better than a node of leaves.
    let (below, of_left) = if fits { (0.0, 0) } else { distributed(8) };
    let single = measure + below;
    let (mut costs, mut plan) = ([single; 7], of_left << 28 | u32::from(fits));
    let (mut cost, mut of_left) = (single, 0);
    for roots in 2..8 {
        // There are no more roots than things.
        if roots <= count {
            (cost, of_left) = distributed(roots);
        }
        if cost < single {
            costs[roots - 1] = cost;
            plan |= of_left << (4 * (roots - 1));
        }
    }
    (costs, Plan(plan))
}

impl Plan {
    /// Of a leaf that is not divided.
    pub const LEAF: Self = Self(1);

    pub fn is_leaf(self) -> bool {
        self.0 & 1 == 1
    }

    /// How many of at most `roots` roots belong to the left child, if there is more than one.
    pub fn of_left(self, roots: usize) -> Option<usize> {
        let of_left = self.0 >> (4 * (roots - 1)) & 15;
        (roots > 1 && of_left > 0).then_some(of_left as usize)
    }
}
