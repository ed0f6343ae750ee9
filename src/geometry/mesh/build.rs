//! Parts → [`Mesh`]: checked, without what cannot be hit, with a tree.

use super::corners::retain;
use super::{Mesh, MeshError, Packet, Parts, Place};
use crate::base::digest::{Content, Digest, Digester};
use crate::base::lanes::prefetch;
use crate::base::math::{Aabb, DVec3};
use crate::geometry::bvh::{Contents, Tree, fetch_ahead};
use glam::Vec3;
use rayon::prelude::*;
use std::sync::OnceLock;

/// Coordinates beyond this are refused: their squares and products must stay far from overflow.
pub(super) const LARGEST: f64 = 1e30;

/// Triangles of one mesh at most.
const MOST_TRIANGLES: usize = 1 << 30;

/// Triangles, and leaves of them, that are not worth more than one thread.
pub(crate) const FEW: usize = 4096;

impl Mesh {
    /// The mesh of these parts; triangles without an area are left out and counted.
    pub fn new(mut parts: Parts) -> Result<Self, MeshError> {
        check(&parts)?;
        let (solid, bounds) = solid(&parts);
        let skipped = parts.triangles.len() - solid;
        if solid == 0 {
            return Err(MeshError::new(match skipped {
                0 => "it has no triangles".to_owned(),
                _ => "none of its triangles has an area".to_owned(),
            }));
        }
        if skipped > 0 {
            let has_area = |&triangle: &[u32; 3]| has_area(corners(&parts, triangle));
            let keep: Vec<bool> = parts.triangles.iter().map(has_area).collect();
            drop_triangles(&mut parts, &keep);
        }
        if let Some(normals) = &mut parts.normals {
            normals.change(unit);
        }
        let ((tree, packets), digest) = rayon::join(|| tree(&parts, bounds), || digest(&parts));
        let exact = first(&parts.positions, |position| !tree.space().is_exact(*position)).is_none();
        Ok(Self {
            tree,
            packets,
            exact,
            bounds,
            skipped,
            parts,
            digest,
            smooth: OnceLock::new(),
            areas: OnceLock::new(),
        })
    }
}

/// The tree over triangles within `bounds`, and the packets of its leaves.
fn tree(parts: &Parts, bounds: Aabb) -> (Tree, Vec<Packet>) {
    let (tree, leaves) = Tree::of_triangles(bounds, &parts.positions, &parts.triangles);
    let packet = |leaf| {
        fetch_leaves(&leaves, leaf, parts);
        Packet::new(tree.space(), leaves.leaf(leaf), parts)
    };
    let packets = (0..leaves.len() as u32).into_par_iter().with_min_len(FEW).map(packet).collect();
    (tree, packets)
}

/// What there is but for materials.
fn digest(parts: &Parts) -> Digest {
    let Parts { positions, triangles, normals, uvs, colors, slots, materials: _ } = parts;
    let mut digester = Digester::new();
    (positions, triangles, colors).feed(&mut digester);
    (normals, uvs, slots).feed(&mut digester);
    digester.finish()
}

/// Leaves between asking for the triangles of one, or for their corners, and needing them.
const AHEAD: u32 = 4;

/// Asks for what leaves hold that come up soon after another one.
#[inline(always)]
fn fetch_leaves(leaves: &Contents, now: u32, parts: &Parts) {
    if (now + 2 * AHEAD) as usize >= leaves.len() {
        return;
    }
    for &part in leaves.leaf(now + 2 * AHEAD) {
        prefetch(&parts.triangles, part as usize);
    }
    for vertex in leaves.leaf(now + AHEAD).iter().flat_map(|&part| parts.triangles[part as usize]) {
        prefetch(&parts.positions, vertex as usize);
    }
}

fn check(parts: &Parts) -> Result<(), MeshError> {
    let Parts { positions, triangles, colors, slots, .. } = parts;
    if triangles.len() > MOST_TRIANGLES {
        return Err(MeshError::new(format!("it has more than {MOST_TRIANGLES} triangles")));
    }
    if let Some(vertex) = first(positions, |position| !is_placed(*position)) {
        return Err(not_placed(Place::Vertex(vertex as u64), positions[vertex], None));
    }
    let outside = |vertex: &u32| *vertex as usize >= positions.len();
    if let Some(face) = first(triangles, |triangle| triangle.iter().any(outside)) {
        let vertex = triangles[face].iter().copied().find(outside).unwrap_or_default();
        let why = format!("there is no vertex {vertex}; the mesh has {}", positions.len());
        return Err(MeshError::at(Place::Face(face as u64), why));
    }
    let fits = |len: usize, expected: usize| len == 0 || len == expected;
    if !fits(colors.len(), positions.len()) || !fits(slots.len(), triangles.len()) {
        return Err(MeshError::new("it needs a colour for every vertex, and a slot for every triangle"));
    }
    Ok(())
}

/// The first of many entries that is as looked for.
fn first<T: Sync>(entries: &[T], is_it: impl Fn(&T) -> bool + Sync) -> Option<usize> {
    let in_group = |(group, entries): (usize, &[T])| Some(group * FEW + entries.iter().position(&is_it)?);
    entries.par_chunks(FEW).enumerate().find_map_first(in_group)
}

/// Whether a position can be computed with.
pub(crate) fn is_placed(position: DVec3) -> bool {
    // False for NaN as well.
    position.abs().max_element() <= LARGEST && position.is_finite()
}

/// The fault of a vertex that is nowhere, with the face that uses it.
pub(crate) fn not_placed(place: Place, position: DVec3, face: Option<u64>) -> MeshError {
    let axis = (0..3).find(|&axis| !is_placed(DVec3::splat(position[axis]))).unwrap_or(0);
    let user = face.map_or_else(String::new, |face| format!(", and face {face} uses it"));
    let why = format!(
        "the vertex has {} = {}{user}; coordinates are finite and at most 1e30",
        ["x", "y", "z"][axis],
        position[axis]
    );
    MeshError::at(place, why)
}

/// How many triangles have an area, and a box around them.
fn solid(parts: &Parts) -> (usize, Aabb) {
    let some = |triangles: &[[u32; 3]]| {
        let (mut count, mut bounds) = (0, Aabb::EMPTY);
        for (now, &triangle) in triangles.iter().enumerate() {
            fetch_ahead(&parts.positions, triangles, now);
            let corners = corners(parts, triangle);
            if has_area(corners) {
                count += 1;
                bounds = bounds.union(Aabb::around(corners));
            }
        }
        (count, bounds)
    };
    parts
        .triangles
        .par_chunks(FEW)
        .map(some)
        .reduce(|| (0, Aabb::EMPTY), |(n, a), (m, b)| (n + m, a.union(b)))
}

#[inline(always)]
fn corners(parts: &Parts, [a, b, c]: [u32; 3]) -> [DVec3; 3] {
    let position = |vertex: u32| parts.positions[vertex as usize];
    [position(a), position(b), position(c)]
}

/// What the sine of a triangle's angle has to be more than, and twice its area no less than.
const SINE: f64 = 4.0 * f64::EPSILON;
const DOUBLED: f64 = 2.0 * f32::MIN_POSITIVE as f64;

/// Whether a triangle encloses an area: its corners differ, are not in one line to within rounding, and what
/// they enclose is more than the smallest normal f32, below which nothing about it could be computed.
fn has_area([a, b, c]: [DVec3; 3]) -> bool {
    let (u, v) = (b - a, c - a);
    let [square, of_sides] = [u.cross(v).length_squared(), u.length_squared() * v.length_squared()];
    // What is more than that by half, after roundings, needs no roots. Squares in this range are normal numbers.
    if square > 2.0 * SINE * SINE * of_sides && square > 2.0 * DOUBLED * DOUBLED {
        return true;
    }
    let doubled = square.sqrt();
    let sine = doubled / (u.length() * v.length());
    // False for the quotient of zeros as well.
    sine > SINE && doubled >= DOUBLED
}

fn drop_triangles(parts: &mut Parts, keep: &[bool]) {
    retain(&mut parts.triangles, keep);
    retain(&mut parts.slots, keep);
    if let Some(normals) = &mut parts.normals {
        normals.retain(keep);
    }
    if let Some(uvs) = &mut parts.uvs {
        uvs.retain(keep);
    }
}

/// The normal at length 1, or zero if it has no direction. In f64, where squares of f32 neither under- nor
/// overflow.
fn unit(normal: Vec3) -> Vec3 {
    normal.as_dvec3().normalize_or_zero().as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    /// Squares decide as the lengths themselves do, of every size and at the limits.
    #[test]
    fn areas_are_told_without_roots() {
        let by_lengths = |[a, b, c]: [DVec3; 3]| {
            let doubled = (b - a).cross(c - a).length();
            let sine = doubled / ((b - a).length() * (c - a).length());
            sine > 4.0 * f64::EPSILON && 0.5 * doubled >= f64::from(f32::MIN_POSITIVE)
        };
        let mut random = Random(13);
        let mut counts = [0; 2];
        for exponent in -170..=30 {
            for _ in 0..200 {
                let (a, b) = (random.point(1.0), random.point(1.0));
                let slender = libm::exp2(-60.0 * random.unit() * random.unit());
                let c = a + (b - a) * random.unit() + random.point(slender);
                let triangle = [a, b, c].map(|corner| corner * libm::exp10(f64::from(exponent)));
                assert_eq!(has_area(triangle), by_lengths(triangle), "{triangle:?}");
                counts[usize::from(has_area(triangle))] += 1;
            }
        }
        assert!(counts.into_iter().all(|count| count > 1000), "{counts:?}");
    }
}
