use super::*;
use crate::base::math::gamma;
use crate::geometry::bvh::tree::{Child, Node};
use crate::testing::Random;

fn cube(at: DVec3, side: f64) -> Aabb {
    Aabb { min: at, max: at + DVec3::splat(side) }
}

/// Checks that each primitive is in one leaf, that its box lies within all boxes above, and that these are tight.
fn check(boxes: &[Aabb]) -> (Tree, LeafPrimitives) {
    let (tree, contents) = Tree::of_boxes(boxes);
    let mut seen = vec![0; boxes.len()];
    let everywhere = [[f32::NEG_INFINITY; 3], [f32::INFINITY; 3]];
    let mut waiting = vec![(tree.root, everywhere)];
    while let Some((child, [low, high])) = waiting.pop() {
        let is_tight = |corners| [low, high] == everywhere || [low, high] == corners;
        if let Some(leaf) = child.as_leaf() {
            for &primitive in contents.leaf(leaf) {
                seen[primitive as usize] += 1;
                let [min, max] = Bounds::new(tree.space().outward(boxes[primitive as usize])).corners();
                assert!(is_tight([min, max]));
            }
            continue;
        }
        let node = &tree.nodes[child.0 as usize];
        assert!(is_tight(node.corners()));
        let Node { planes, children } = node;
        for (slot, &child) in children.iter().enumerate().filter(|(_, child)| **child != Child::NONE) {
            let side = |side: usize| [0, 1, 2].map(|axis: usize| planes[axis][side][slot]);
            waiting.push((child, [side(0), side(1)]));
        }
    }
    assert!(seen.into_iter().all(|count| count == 1));
    (tree, contents)
}

fn depth(tree: &Tree, child: Child) -> u32 {
    if child == Child::NONE || child.as_leaf().is_some() {
        return 0;
    }
    let children = tree.nodes[child.0 as usize].children;
    1 + children.into_iter().map(|child| depth(tree, child)).max().unwrap_or(0)
}

/// Boxes in a row, in a plane, in one place and nested, and points: the tree must be shallow and quick to build.
#[test]
fn equal_boxes_make_balanced_trees() {
    let row = |i: u32| cube(DVec3::X * f64::from(i), 0.5);
    let points = |i: u32| cube(DVec3::X * f64::from(i), 0.0);
    let plane = |i: u32| cube(DVec3::new(f64::from(i % 64), 0.0, f64::from(i / 64)), 0.5);
    let stack = |_: u32| cube(DVec3::ONE, 0.5);
    let point = |_: u32| cube(DVec3::ONE, 0.0);
    let around = |i: u32| cube(DVec3::splat(-0.5 * f64::from(i)), f64::from(i));
    let all: [&dyn Fn(u32) -> Aabb; 6] = [&row, &points, &plane, &stack, &point, &around];
    for (boxes, count) in all.into_iter().flat_map(|boxes| [(boxes, 4096), (boxes, 100_000)]) {
        let boxes: Vec<_> = (0..count).map(boxes).collect();
        let (tree, _) = check(&boxes);
        assert!(depth(&tree, tree.root) <= 12, "{}", depth(&tree, tree.root));
    }
}

#[test]
fn few_and_strange_boxes() {
    assert!(Tree::of_boxes(&[]).1.is_empty());
    let mut random = Random(3);
    for count in 1..40 {
        check(&(0..count).map(|_| cube(random.point(3.0), random.unit())).collect::<Vec<_>>());
    }
    // Every box is a tenth of the previous one, and a tenth as far away. Scales range from underflow to the largest
    // that can be squared.
    for scale in [1e-300, 1e-30, 1.0, 1e100] {
        let shrinking = |i: i32| cube(DVec3::X * scale * libm::exp10(-f64::from(i)), scale * 1e-3);
        let boxes: Vec<_> = (0..300).map(shrinking).collect();
        let (tree, _) = check(&boxes);
        assert!(depth(&tree, tree.root) <= 90);
    }
}

/// Independent of the number of threads.
#[test]
fn trees_are_the_same_on_all_threads() {
    let mut random = Random(11);
    let boxes: Vec<_> = (0..60_000).map(|_| cube(random.point(3.0), 0.1 * random.unit())).collect();
    let corners: Vec<[DVec3; 3]> = (0..60_000)
        .map(|i| {
            let a = random.point(3.0);
            [a, a + random.point(if i % 100 == 0 { 2.0 } else { 0.02 }), a + random.point(0.02)]
        })
        .collect();
    let positions: Vec<DVec3> = corners.into_iter().flatten().collect();
    let triangles: Vec<_> = (0..60_000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let bounds = Aabb::around(positions.iter().copied());
    let build = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let both = || [Tree::of_boxes(&boxes), Tree::of_triangles(bounds, &positions, &triangles)];
        pool.install(both).map(|(tree, contents)| {
            let bits = |node: &Node| (node.planes.map(|p| p.map(|p| p.map(f32::to_bits))), node.children);
            (tree.nodes.iter().map(bits).collect::<Vec<_>>(), contents)
        })
    };
    let alone = build(1);
    assert!(build(2) == alone && build(3) == alone);
}

/// Leaves move and empty, and a refitted tree knows its cost: the sum over single boxes, one after the other.
#[test]
fn refitted_costs_are_those_of_all_boxes() {
    const ROUNDS: u32 = 20;
    let mut random = Random(5);
    let mut boxes: Vec<Aabb> = (0..300).map(|_| cube(random.point(8.0), random.unit())).collect();
    // They keep the space of the tree.
    boxes.extend([cube(DVec3::splat(-9.0), 1.0), cube(DVec3::splat(8.0), 1.0)]);
    let (mut tree, contents) = Tree::of_boxes(&boxes);
    let mut refitter = Refitter::new(&tree, contents.len());
    for _ in 0..ROUNDS {
        for leaf in 0..contents.len() as u32 {
            let (moves, empty) = (random.unit() < 0.3, random.unit() < 0.1);
            let bounds = cube(random.point(8.0), random.unit());
            if moves {
                assert!(refitter.set_leaf(&mut tree, leaf, (!empty).then_some(bounds)));
            }
        }
        refitter.finish(&mut tree);
        let mut area = 0.0;
        for node in &tree.nodes {
            for slot in 0..8 {
                let side = |side: usize| [0, 1, 2].map(|axis: usize| node.planes[axis][side][slot]);
                let bounds = Bounds::new([side(0), side(1)]);
                let is_empty = bounds.low.x > bounds.high.x;
                area += if is_empty { 0.0 } else { f64::from(bounds.half_area()) };
            }
        }
        let root = f64::from(Bounds::new(tree.nodes[0].corners()).half_area());
        let expected = 1.0 + area / root;
        // Sums of areas in another order; in the refitter, with a sum and a difference for each node of each round.
        let error = gamma((ROUNDS + 8) * 2 * tree.nodes.len() as u32) * expected;
        for cost in [refitter.cost(&tree), tree.cost()] {
            assert!((cost - expected).abs() <= error, "{cost} {expected}");
        }
    }
}
