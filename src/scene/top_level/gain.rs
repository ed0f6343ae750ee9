//! Whether a tree over a few primitives saves more tests than it takes.

use super::query::Coherence;
use crate::base::math::Aabb;
use crate::geometry::shape::Shape;
use crate::scene::Primitive;

/// The time of walking a tree of one or two nodes with eight rays, in the unit of [`cost`].
const WALK: f64 = 16.0;

/// The time of reaching a leaf, besides that of testing its primitives.
const LEAF: f64 = 8.0;

/// Beyond this cost of testing all primitives there is a tree, even if eight rays reach most boxes: it finds the nearest
/// first.
const DEAR: f64 = 128.0;

/// The time of testing a primitive with eight rays, in thirds of that of a sphere. Fitted to forty small scenes,
/// rendered with and without a tree.
pub fn cost(primitive: &Primitive) -> f64 {
    match (&primitive.shape, &primitive.transform) {
        (Shape::Sphere(_), None) => 3.0,
        (Shape::Rectangle(_) | Shape::Disk(_), None) => 4.0,
        (Shape::Cuboid(_), None) => 6.0,
        // Rays are prepared for a tree of the shape's own.
        (Shape::Mesh(_) | Shape::Particles(_), _) => 24.0,
        // All crossings of all parts, which are sorted.
        (Shape::Solid(_), _) => 32.0 * primitive.shape.solid_count() as f64,
        // At least the transforms of three corners or of the ray first.
        _ => 8.0,
    }
}

/// Whether eight rays are faster with a tree over `bounded` primitives, whose boxes lie within `all`, than without one.
///
/// Of the rays that meet `all`, the share that meets a box in it is the ratio of the surface areas, as in the surface
/// area heuristic (MacDonald and Booth 1990). A leaf is left out where all eight rays of a bundle miss it; neighbours in
/// a picture count as two rays, since most of them meet the same boxes. So small things in the open have a tree from
/// four boxes or a dozen spheres on, and a closed room needs more of them: all rays meet its walls.
pub fn pays<'a>(
    bounded: impl Iterator<Item = (&'a Primitive, Aabb)>,
    all: Aabb,
    coherence: Coherence,
) -> bool {
    let (area, mut count, mut sum, mut gain) = (all.area(), 0, 0.0, 0.0);
    for (primitive, bounds) in bounded {
        let share = bounds.area() / area;
        // A comparison with NaN is false.
        let missed = if share < 1.0 { 1.0 - share } else { 0.0 };
        let missed = match coherence {
            Coherence::Coherent => square(missed),
            Coherence::Incoherent => square(square(square(missed))),
        };
        let cost = cost(primitive);
        gain += missed * cost - (1.0 - missed) * LEAF;
        (count, sum) = (count + 1, sum + cost);
        if count > 1 && sum >= DEAR {
            return true;
        }
    }
    // The tree of a single primitive would be one leaf, whose box no node holds.
    count > 1 && gain >= WALK
}

fn square(x: f64) -> f64 {
    x * x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::DVec3;
    use crate::geometry::shape::{Cuboid, Rectangle};
    use crate::scene::Geometry;
    use crate::scene::top_level::Bvh;
    use crate::testing::geometry;

    fn has_tree(shapes: &[Shape], coherence: Coherence) -> bool {
        let geometry: Geometry = geometry(shapes.iter().cloned());
        let mut bvh = Bvh::for_rays(coherence);
        bvh.update(&geometry);
        !bvh.tree.is_empty()
    }

    fn boxes(count: u32) -> Vec<Shape> {
        let at = |k: u32| DVec3::new(f64::from(k), f64::from(k * k % 5), f64::from(k * k * k % 7));
        let cuboid = |k| Shape::Cuboid(Cuboid { min: at(k), max: at(k) + DVec3::splat(0.5) });
        (0..count).map(cuboid).collect()
    }

    fn walls() -> Vec<Shape> {
        let (zero, x, y, z) = (DVec3::ZERO, DVec3::X * 8.0, DVec3::Y * 6.0, DVec3::Z * 7.0);
        let all = [(zero, x, y), (z, x, y), (zero, y, z), (x, y, z), (zero, x, z), (y, x, z)];
        all.map(|(corner, u, v)| Shape::Rectangle(Rectangle { corner, u, v })).to_vec()
    }

    #[test]
    fn trees_pay_in_the_open_sooner_than_between_walls() {
        for coherence in [Coherence::Coherent, Coherence::Incoherent] {
            assert!(!has_tree(&boxes(2), coherence) && has_tree(&boxes(5), coherence));
            assert!(!has_tree(&walls(), coherence));
            assert!(has_tree(&[walls(), boxes(30)].concat(), coherence));
        }
        let room = [walls(), boxes(7)].concat();
        assert!(!has_tree(&room, Coherence::Incoherent) && has_tree(&room, Coherence::Coherent));
    }
}
