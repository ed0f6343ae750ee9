//! Walking the tree along a ray.

use super::{Node, Probe, Tree};
use crate::math::{DVec3, gamma};

/// Children put off at once. Deeper trees than this are walked by recursion.
const STACK: usize = 64;

impl Tree {
    /// Calls `leaf` with the indices in every leaf that the ray may meet before `t_max`, nearer ones first.
    /// `leaf` returns the new limit; a negative one ends the walk.
    #[inline]
    pub fn visit(&self, probe: &Probe, t_max: f64, mut leaf: impl FnMut(&[u32]) -> f64) {
        self.walk(0, probe, t_max, &mut leaf);
    }

    /// [`Tree::visit`] from a node on; gives the limit that holds at its end.
    fn walk(&self, from: u32, probe: &Probe, mut t_max: f64, leaf: &mut impl FnMut(&[u32]) -> f64) -> f64 {
        let Some(start) = self.nodes.get(from as usize) else { return t_max };
        let Some(t) = entry(start, probe, t_max) else { return t_max };
        let mut stack = [(t, from); STACK];
        let mut top = 1_usize;
        while let Some(last) = top.checked_sub(1) {
            top = last;
            let (t, mut index) = stack[top];
            // A box entered exactly at the limit may hold an equally near primitive of a lower index.
            if t > t_max {
                continue;
            }
            while let Some((near, far)) = self.children(index, probe, t_max) {
                match far {
                    Some(far) if top < STACK => {
                        stack[top] = far;
                        top += 1;
                    }
                    Some((_, far)) => t_max = self.walk(far, probe, t_max, leaf),
                    None => {}
                }
                index = near;
            }
            let node = &self.nodes[index as usize];
            if node.count > 0 {
                let first = node.first as usize;
                t_max = leaf(&self.leaves[first..first + node.count as usize]);
            }
        }
        t_max
    }

    /// The child to go on with and, if the ray may meet both, the other with its distance. None for a leaf,
    /// and for a node neither of whose children the ray may meet; the latter counts no primitives.
    fn children(&self, index: u32, probe: &Probe, t_max: f64) -> Option<(u32, Option<(f64, u32)>)> {
        let node = &self.nodes[index as usize];
        if node.count > 0 {
            return None;
        }
        let (a, b) = (node.first, node.first + 1);
        let enter = |child: u32| entry(&self.nodes[child as usize], probe, t_max);
        match (enter(a), enter(b)) {
            (Some(ta), Some(tb)) if tb < ta => Some((b, Some((ta, a)))),
            (Some(_), Some(tb)) => Some((a, Some((tb, b)))),
            (Some(_), None) => Some((a, None)),
            (None, Some(_)) => Some((b, None)),
            (None, None) => None,
        }
    }
}

/// Where the ray enters a node's box, rounded down, or none if it passes by or enters beyond `t_max`.
///
/// The slab test in f64 with its own rounding bounded: each distance is off by at most gamma(3) of itself
/// (Ize, *Robust BVH Ray Traversal*, 2013), so the exit is moved out and the entry in by twice that. A ray
/// within a slab's plane gives 0·∞: the comparisons keep the value before it, which keeps the node.
#[inline]
fn entry(node: &Node, probe: &Probe, t_max: f64) -> Option<f64> {
    let [min, max] = node.corners();
    let (a, b) = (distances(min, probe), distances(max, probe));
    let (mut enter, mut leave) = (0.0, t_max);
    for axis in 0..3 {
        let forward = probe.inverse[axis].is_sign_positive();
        let (near, far) = if forward { (a[axis], b[axis]) } else { (b[axis], a[axis]) };
        if near > enter {
            enter = near;
        }
        if far < leave {
            leave = far;
        }
    }
    let (enter, leave) = (enter * (1.0 - 2.0 * gamma(3)), leave * (1.0 + 2.0 * gamma(3)));
    (enter <= leave).then_some(enter)
}

#[inline]
fn distances(corner: DVec3, probe: &Probe) -> DVec3 {
    (corner - probe.ray.origin) * probe.inverse
}
