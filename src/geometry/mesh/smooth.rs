//! Vertex normals of the smooth surface that a mesh approximates.

use crate::base::math::DVec3;
use glam::Vec3;
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// A unit normal per position, or zero if the position has none. Triangles around a position are weighted by their
/// angle there (Thürmer, Wüthrich 1998). So the result does not depend on the triangulation of a face. Equal positions
/// share their normal, whatever their indices.
pub fn normals(positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let shared = first_equal(positions);
    let mut sums = vec![DVec3::ZERO; positions.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        for (corner, vertex) in [(a, b, c), (b, c, a), (c, a, b)].into_iter().zip(triangle) {
            sums[shared[*vertex as usize] as usize] += normal * angle(corner);
        }
    }
    shared.iter().map(|&first| sums[first as usize].normalize_or_zero().as_vec3()).collect()
}

/// The angle at the first of three corners, in radians. Exact to a few roundings, also for flat angles.
pub(super) fn angle((at, p, q): (DVec3, DVec3, DVec3)) -> f64 {
    let (u, v) = (p - at, q - at);
    libm::atan2(u.cross(v).length(), u.dot(v))
}

/// For each position, the index of the first equal one.
pub fn first_equal(positions: &[DVec3]) -> Vec<u32> {
    let mut first: HashMap<[u64; 3], u32> = HashMap::with_capacity(positions.len());
    let index_of = |(index, position): (u32, &DVec3)| {
        // Adding zero turns -0 into 0.
        match first.entry((*position + DVec3::ZERO).to_array().map(f64::to_bits)) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(new) => *new.insert(index),
        }
    };
    (0..).zip(positions).map(index_of).collect()
}
