//! Vertex normals of the smooth surface that a mesh approximates.

use super::corners::FEW;
use crate::base::lanes::{Level, Real, Row, SimdKernel, Vec3 as LaneVec3, dispatch};
use crate::base::math::{DVec3, atan2};
use glam::Vec3;
use hashbrown::HashTable;
use hashbrown::hash_table::Entry;
use rayon::prelude::*;
use rustc_hash::FxBuildHasher;
use std::hash::BuildHasher;

/// Triangles whose terms are in memory at once.
const BLOCK: usize = 1 << 16;

/// Triangles of one task.
const TASK: usize = 1 << 10;

/// A unit normal per position, or zero if the position has none. Triangles around a position are weighted by their
/// angle there (Thürmer, Wüthrich 1998). So the result does not depend on the triangulation of a face. Equal positions
/// share their normal, whatever their indices.
pub fn normals(positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let shared = first_equal(positions);
    let mut sums = vec![DVec3::ZERO; positions.len()];
    let mut terms = vec![[DVec3::ZERO; 3]; triangles.len().min(BLOCK)];
    for triangles in triangles.chunks(BLOCK) {
        // Sums depend on the order, so only their terms are computed in parallel.
        let terms = &mut terms[..triangles.len()];
        triangles.par_chunks(TASK).zip(terms.par_chunks_mut(TASK)).for_each(|(triangles, terms)| {
            dispatch(WeightedNormals { positions, triangles, terms });
        });
        for (term, vertex) in terms.as_flattened().iter().zip(triangles.as_flattened()) {
            sums[shared[*vertex as usize] as usize] += *term;
        }
    }
    let normal = |&first: &u32| sums[first as usize].normalize_or_zero().as_vec3();
    shared.par_iter().with_min_len(FEW).map(normal).collect()
}

/// Computes the normal of each triangle, times its angle at each of its corners.
struct WeightedNormals<'a> {
    positions: &'a [DVec3],
    triangles: &'a [[u32; 3]],
    terms: &'a mut [[DVec3; 3]],
}

impl SimdKernel for WeightedNormals<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        for (triangles, terms) in self.triangles.chunks(8).zip(self.terms.chunks_mut(8)) {
            let mut lanes = [[[0.0; 8]; 3]; 3];
            for (lane, triangle) in triangles.iter().enumerate() {
                for (corner, &vertex) in lanes.iter_mut().zip(triangle) {
                    let position = self.positions[vertex as usize].to_array();
                    corner.iter_mut().zip(position).for_each(|(row, value)| row[lane] = value);
                }
            }
            let [a, b, c] = [corner::<L>(&lanes[0]), corner::<L>(&lanes[1]), corner::<L>(&lanes[2])];
            let normal = (b - a).cross(c - a).normalize_or(LaneVec3::zero());
            for (k, (at, p, q)) in [(a, b, c), (b, c, a), (c, a, b)].into_iter().enumerate() {
                let weighted = (normal * angle(at, p, q)).store();
                terms.iter_mut().zip(weighted).for_each(|(term, weighted)| term[k] = weighted);
            }
        }
    }
}

#[inline(always)]
fn corner<L: Level>([x, y, z]: &[[f64; 8]; 3]) -> LaneVec3<L::F64> {
    LaneVec3::new(L::F64::load(x, 0), L::F64::load(y, 0), L::F64::load(z, 0))
}

/// The angle at the first of three corners, in radians. Exact to a few roundings, also for flat angles.
#[inline(always)]
pub(super) fn angle<F: Real>(at: LaneVec3<F>, p: LaneVec3<F>, q: LaneVec3<F>) -> F {
    let (u, v) = (p - at, q - at);
    atan2(u.cross(v).length(), u.dot(v))
}

/// For each position, the index of the first equal one.
pub fn first_equal(positions: &[DVec3]) -> Vec<u32> {
    // Adding zero turns -0 into 0.
    let key = |index: u32| (positions[index as usize] + DVec3::ZERO).to_array().map(f64::to_bits);
    let hash = |index: &u32| FxBuildHasher.hash_one(key(*index));
    // The indices alone: a map with positions as keys is too large for the caches.
    let mut firsts = HashTable::with_capacity(positions.len());
    let first = |index: u32| match firsts.entry(hash(&index), |first| key(*first) == key(index), hash) {
        Entry::Occupied(known) => *known.get(),
        Entry::Vacant(new) => *new.insert(index).get(),
    };
    (0..positions.len() as u32).map(first).collect()
}
