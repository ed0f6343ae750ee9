//! From a binary tree to one with eight children per node.

use super::binary::{Binary, Subtree};
use crate::math::DVec3;
use crate::tree::{Child, Contents, Node, Space, Tree};

/// The tree that a binary one becomes by its plans, with what is in its leaves. What is below a node stands behind it,
/// its children side by side.
pub fn collapse(binary: &Binary, space: Space) -> (Tree, Contents) {
    let all = binary.root();
    let contents = Contents::with_capacity(all.count);
    let mut wide = Wide { binary, nodes: Vec::with_capacity(all.count / LIKELY), contents };
    let bounds = all.corners(binary).map(|corner| DVec3::from_array(corner.map(f64::from)));
    let mut waiting = Vec::new();
    let root = wide.child(all, &mut waiting);
    while let Some((subtree, node)) = waiting.pop() {
        wide.fill(subtree, node, &mut waiting);
    }
    wide.nodes.shrink_to_fit();
    wide.contents.shrink_to_fit();
    (Tree { space, bounds, nodes: wide.nodes, root }, wide.contents)
}

/// Boxes for a node of most trees over triangles.
const LIKELY: usize = 24;

struct Wide<'a> {
    binary: &'a Binary,
    nodes: Vec<Node>,
    contents: Contents,
}

/// Nodes that have no children yet, and what goes below them.
type Waiting = Vec<(Subtree, usize)>;

impl Wide<'_> {
    /// A leaf, or a node that waits for its children.
    fn child(&mut self, subtree: Subtree, waiting: &mut Waiting) -> Child {
        if subtree.plan(self.binary).is_leaf() {
            let things = subtree.boxes(self.binary).iter().map(|boxed| boxed.thing());
            return Child::leaf(self.contents.push(things));
        }
        let planes = [[[f32::INFINITY; 8], [f32::NEG_INFINITY; 8]]; 3];
        waiting.push((subtree, self.nodes.len()));
        self.nodes.push(Node { planes, children: [Child::NONE; 8] });
        Child(self.nodes.len() as u32 - 1)
    }

    fn fill(&mut self, subtree: Subtree, node: usize, waiting: &mut Waiting) {
        let (mut roots, mut count) = ([subtree; 8], 0);
        self.roots(subtree, 8, &mut roots, &mut count);
        for (slot, root) in roots.into_iter().enumerate().take(count) {
            let child = self.child(root, waiting);
            let [low, high] = root.corners(self.binary);
            let node = &mut self.nodes[node];
            node.children[slot] = child;
            for (axis, planes) in node.planes.iter_mut().enumerate() {
                (planes[0][slot], planes[1][slot]) = (low[axis], high[axis]);
            }
        }
    }

    /// The subtrees, at most `most`, that become the children of a node.
    fn roots(&self, subtree: Subtree, most: usize, roots: &mut [Subtree; 8], count: &mut usize) {
        let Some(of_left) = subtree.plan(self.binary).of_left(most) else {
            roots[*count] = subtree;
            *count += 1;
            return;
        };
        let [left, right] = subtree.children(self.binary);
        self.roots(left, of_left, roots, count);
        self.roots(right, most - of_left, roots, count);
    }
}
