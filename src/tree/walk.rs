//! Walking a tree along a ray.

use super::slabs::Wide;
use super::{Child, Probe, Slabs, Tree};
use crate::simd::{Lanes, Work, dispatch};

/// What a tree's leaves hold, while a ray walks the tree.
pub trait Leaves {
    /// Whether leaves that are entered nearer are to be visited first, which pays if that lowers the limit.
    const IN_ORDER: bool;

    /// Tests what is in a leaf; gives the limit beyond which nothing is of interest any more, or none to end the walk.
    /// Implementations are `#[inline(always)]`.
    fn visit<L: Lanes>(&mut self, leaf: u32, slabs: &Slabs) -> Option<f32>;
}

/// Children put off at once. Deeper trees than these hold are walked by recursion.
const STACK: usize = 48;

impl Tree {
    /// Visits every leaf that the ray may meet before `t_max`.
    #[inline(always)]
    pub fn walk(&self, probe: &Probe, t_max: f64, leaves: &mut impl Leaves) {
        if self.root == Child::NONE {
            return;
        }
        if let Some(slabs) = Slabs::new(self, probe, t_max) {
            let limit = slabs.limit(t_max);
            dispatch(Walk { tree: self, slabs: &slabs, leaves, limit, from: self.root });
        }
    }
}

struct Walk<'a, V> {
    tree: &'a Tree,
    slabs: &'a Slabs,
    leaves: &'a mut V,
    limit: f32,
    from: Child,
}

/// A child with where the ray enters it.
type Entered = (f32, Child);

impl<V: Leaves> Work for Walk<'_, V> {
    /// The limit at the end of the walk; none if a leaf has ended it.
    type Output = Option<f32>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Option<f32> {
        let Self { tree, slabs, leaves, mut limit, from } = self;
        let wide = Wide::<L>::new(slabs);
        let mut stack = [(0.0, Child::NONE); STACK];
        let mut top = 0;
        let mut at = from;
        loop {
            if let Some(leaf) = at.as_leaf() {
                limit = leaves.visit::<L>(leaf, slabs)?;
            } else {
                let node = &tree.nodes[at.0 as usize];
                let (mut met, enter) = wide.test(node, limit);
                if met != 0 {
                    let first = met.trailing_zeros() as usize;
                    met &= met - 1;
                    if met == 0 {
                        at = node.children[first & 7];
                        continue;
                    }
                    let mut nearest = (enter[first & 7], node.children[first & 7]);
                    let bottom = top;
                    while met != 0 {
                        let slot = met.trailing_zeros() as usize;
                        met &= met - 1;
                        let mut other = (enter[slot & 7], node.children[slot & 7]);
                        if V::IN_ORDER && other.0 < nearest.0 {
                            (nearest, other) = (other, nearest);
                        }
                        if top == STACK {
                            let from = other.1;
                            limit = walk_apart(Walk { tree, slabs, leaves, limit, from })?;
                            continue;
                        }
                        if V::IN_ORDER {
                            put(&mut stack, bottom, top, other);
                        } else {
                            stack[top] = other;
                        }
                        top += 1;
                    }
                    at = nearest.1;
                    continue;
                }
            }
            loop {
                top = match top.checked_sub(1) {
                    Some(top) => top,
                    None => return Some(limit),
                };
                let (enter, child) = stack[top];
                // A box entered exactly at the limit may hold an equally near thing of a lower index.
                if !V::IN_ORDER || enter <= limit {
                    at = child;
                    break;
                }
            }
        }
    }
}

/// Puts a child among those above `bottom`, of which the nearest is on top.
#[inline(always)]
fn put(stack: &mut [Entered; STACK], bottom: usize, top: usize, child: Entered) {
    let mut place = top;
    while place > bottom && stack[place - 1].0 < child.0 {
        stack[place] = stack[place - 1];
        place -= 1;
    }
    stack[place] = child;
}

/// The same walk from another child on, out of line.
#[cold]
#[inline(never)]
fn walk_apart<V: Leaves>(walk: Walk<'_, V>) -> Option<f32> {
    dispatch(walk)
}
