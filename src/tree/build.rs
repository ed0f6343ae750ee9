//! Building the tree: PLOC clustering and reinsertion by `obvhs`, over boxes rounded outwards to f32.

use super::{Node, Tree};
use crate::math::Aabb;
use obvhs::BvhBuildParams;
use obvhs::bvh2::builder::build_bvh2;

impl Tree {
    /// A tree over things with an index and a box each. The same boxes give the same tree.
    pub fn build(things: impl IntoIterator<Item = (u32, Aabb)>) -> Self {
        let (indices, boxes): (Vec<u32>, Vec<_>) =
            things.into_iter().map(|(index, bounds)| (index, outward(bounds))).unzip();
        if boxes.is_empty() {
            return Self::default();
        }
        let tree = build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut std::time::Duration::default());
        let nodes = tree.nodes.iter().map(|node| Node {
            min: node.aabb().min.to_array(),
            max: node.aabb().max.to_array(),
            first: node.first_index,
            count: node.prim_count,
        });
        let leaves = tree.primitive_indices.iter().map(|&i| indices[i as usize]);
        Self { nodes: nodes.collect(), leaves: leaves.collect() }
    }
}

/// The smallest f32 box around an f64 one. Beyond the range of f32 it is the largest finite number, never
/// infinite: the builder computes areas, and the test of a box of all there is need not be sharp.
fn outward(bounds: Aabb) -> obvhs::aabb::Aabb {
    let down = |v: f64| if f64::from(v as f32) > v { (v as f32).next_down() } else { v as f32 };
    let up = |v: f64| if f64::from(v as f32) < v { (v as f32).next_up() } else { v as f32 };
    let min = bounds.min.to_array().map(|v| down(v).max(f32::MIN));
    let max = bounds.max.to_array().map(|v| up(v).min(f32::MAX));
    obvhs::aabb::Aabb { min: min.into(), max: max.into() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DVec3;

    #[test]
    fn boxes_are_rounded_outwards() {
        for v in [0.1, 1e-300, -0.1, 16_777_217.0, -16_777_217.0, 1e300, 0.0] {
            let b = outward(Aabb { min: DVec3::splat(v), max: DVec3::splat(v) });
            assert!(f64::from(b.min.x) <= v || b.min.x == f32::MIN);
            assert!(f64::from(b.max.x) >= v || b.max.x == f32::MAX);
        }
    }
}
