//! Builds a [`TriangleMesh`] from [`MeshData`]: checks it, removes triangles without area, and builds the tree.

use super::arrays::{Centering, DataArrays};
use super::corners::{FEW, retain};
use super::{MeshData, MeshError, MeshLocation, Packet, TriangleMesh};
use crate::base::digest::{Content, Digest, Digester};
use crate::base::lanes::prefetch;
use crate::base::math::{Aabb, DVec3};
use crate::geometry::bvh::{LeafBox, LeafPrimitives, Tree, TreeSpace, fetch_ahead};
use glam::Vec3;
use rayon::prelude::*;
use std::sync::OnceLock;

/// Largest absolute coordinate: squares and products must not overflow.
pub(super) const LARGEST: f64 = 1e30;

/// Most triangles of one mesh.
const MOST_TRIANGLES: usize = 1 << 30;

impl TriangleMesh {
    /// Builds a mesh. Triangles without an area are removed and counted.
    pub fn new(data: MeshData) -> Result<Self, MeshError> {
        Self::after(data, None)
    }

    /// [`TriangleMesh::new`], in less time if the mesh is one that moved: if `before` has the same triangles, its tree is
    /// refitted.
    pub fn after(mut data: MeshData, before: Option<&Self>) -> Result<Self, MeshError> {
        let (bounds, skipped) = checked(&data)?;
        if skipped > 0 {
            let has_area = |&triangle: &[u32; 3]| has_area(corners(&data, triangle));
            let keep: Vec<bool> = data.triangles.iter().map(has_area).collect();
            drop_triangles(&mut data, &keep);
        }
        if let Some(normals) = &mut data.normals {
            normals.change(unit);
        }
        let can_move =
            |before: &&Self| before.tree.can_be_refitted() && before.data.triangles == data.triangles;
        let moved = before.filter(can_move);
        let (digest, refitted) = (OnceLock::new(), moved.and_then(|before| before.refitted(&data, bounds)));
        let build = || {
            let digest = || before.is_none().then(|| digest.get_or_init(|| self::digest(&data)));
            rayon::join(|| tree(&data, bounds), digest).0
        };
        // Most meshes that move have names of their own. Only others are hashed, while their tree is built.
        let (tree, packets) = refitted.unwrap_or_else(build);
        let arrays = DataArrays::new(std::mem::take(&mut data.arrays));
        let exact = first(&data.positions, |position| !tree.space().is_exact(*position)).is_none();
        Ok(Self {
            tree,
            packets,
            exact,
            bounds,
            skipped,
            data,
            arrays,
            digest,
            smooth: OnceLock::new(),
            outline: OnceLock::new(),
            areas: OnceLock::new(),
            closed: OnceLock::new(),
        })
    }
}

/// The tree over triangles within `bounds`, and the packets of its leaves.
fn tree(data: &MeshData, bounds: Aabb) -> (Tree, Vec<Packet>) {
    let (tree, leaves) = Tree::of_triangles(bounds, &data.positions, &data.triangles);
    let packet = |leaf| {
        fetch_leaves(&leaves, leaf, data);
        Packet::new(tree.space(), leaves.leaf(leaf), data)
    };
    let packets = (0..leaves.len() as u32).into_par_iter().with_min_len(FEW).map(packet).collect();
    (tree, packets)
}

impl TriangleMesh {
    /// The tree with the same triangles elsewhere, and its packets. None if a new one is likely to be better.
    fn refitted(&self, data: &MeshData, bounds: Aabb) -> Option<(Tree, Vec<Packet>)> {
        let space = TreeSpace::around(bounds);
        let moved = |(index, before): (usize, &Packet)| {
            if let Some(soon) = self.packets.get(index + AHEAD as usize) {
                let corners = soon.parts().iter().flat_map(|&part| data.triangles[part as usize]);
                corners.for_each(|vertex| prefetch(&data.positions, vertex as usize));
            }
            let leaf = before.parts();
            let around =
                LeafBox::of_triangles(&space, &data.positions, &data.triangles, leaf.iter().copied());
            (Packet::new(&space, leaf, data), around)
        };
        let (packets, boxes): (Vec<_>, Vec<_>) =
            self.packets.par_iter().enumerate().with_min_len(FEW / 8).map(moved).unzip();
        Some((self.tree.refitted(space, &boxes)?, packets))
    }
}

/// The digest of everything except materials and data arrays.
pub(super) fn digest(data: &MeshData) -> Digest {
    let MeshData { positions, triangles, normals, uvs, colors, slots, materials: _, arrays: _ } = data;
    let mut digester = Digester::new();
    (positions, triangles, colors).feed(&mut digester);
    (normals, uvs, slots).feed(&mut digester);
    digester.finish()
}

/// Distance, in leaves, between prefetches of triangles, of their corners, and their use.
const AHEAD: u32 = 4;

/// Prefetches the triangles, and the corners, of leaves that will be used soon.
#[inline(always)]
fn fetch_leaves(leaves: &LeafPrimitives, now: u32, data: &MeshData) {
    if (now + 2 * AHEAD) as usize >= leaves.len() {
        return;
    }
    for &part in leaves.leaf(now + 2 * AHEAD) {
        prefetch(&data.triangles, part as usize);
    }
    for vertex in leaves.leaf(now + AHEAD).iter().flat_map(|&part| data.triangles[part as usize]) {
        prefetch(&data.positions, vertex as usize);
    }
}

/// Checks a mesh. Returns the bounds of its triangles with an area, and the number of the others.
pub(super) fn checked(data: &MeshData) -> Result<(Aabb, usize), MeshError> {
    check(data)?;
    let (solid, bounds) = solid(data);
    let skipped = data.triangles.len() - solid;
    match (solid, skipped) {
        (0, 0) => Err(MeshError::new("it has no triangles")),
        (0, _) => Err(MeshError::new("none of its triangles has an area")),
        _ => Ok((bounds, skipped)),
    }
}

fn check(data: &MeshData) -> Result<(), MeshError> {
    let MeshData { positions, triangles, colors, slots, arrays, .. } = data;
    if triangles.len() > MOST_TRIANGLES {
        return Err(MeshError::new(format!("it has more than {MOST_TRIANGLES} triangles")));
    }
    if let Some(vertex) = first(positions, |position| !is_placed(*position)) {
        return Err(not_placed(MeshLocation::Vertex(vertex as u64), positions[vertex], None));
    }
    let outside = |vertex: &u32| *vertex as usize >= positions.len();
    if let Some(face) = first(triangles, |triangle| triangle.iter().any(outside)) {
        let vertex = triangles[face].iter().copied().find(outside).unwrap_or_default();
        let why = format!("there is no vertex {vertex}; the mesh has {}", positions.len());
        return Err(MeshError::at(MeshLocation::Face(face as u64), why));
    }
    let fits = |len: usize, expected: usize| len == 0 || len == expected;
    if !fits(colors.len(), positions.len()) || !fits(slots.len(), triangles.len()) {
        return Err(MeshError::new("it needs a colour for every vertex, and a slot for every triangle"));
    }
    for array in arrays {
        let entries = match array.centering {
            Centering::Points => positions.len(),
            Centering::Cells => triangles.len(),
        };
        if array.components == 0 || array.values.len() != entries.saturating_mul(array.components) {
            let why =
                format!("its data {:?} needs {entries} entries, and has {}", array.name, array.entries());
            return Err(MeshError::new(why));
        }
    }
    Ok(())
}

/// The index of the first entry that satisfies `is_it`.
fn first<T: Sync>(entries: &[T], is_it: impl Fn(&T) -> bool + Sync) -> Option<usize> {
    let in_group = |(group, entries): (usize, &[T])| Some(group * FEW + entries.iter().position(&is_it)?);
    entries.par_chunks(FEW).enumerate().find_map_first(in_group)
}

/// Whether a position is finite and within [`LARGEST`].
pub(crate) fn is_placed(position: DVec3) -> bool {
    // False for NaN too.
    position.abs().max_element() <= LARGEST && position.is_finite()
}

/// The error of a vertex with an invalid position, with the face that uses it.
pub(crate) fn not_placed(place: MeshLocation, position: DVec3, face: Option<u64>) -> MeshError {
    let axis = (0..3).find(|&axis| !is_placed(DVec3::splat(position[axis]))).unwrap_or(0);
    let user = face.map_or_else(String::new, |face| format!(", and face {face} uses it"));
    let why = format!(
        "the vertex has {} = {}{user}; coordinates are finite and at most 1e30",
        ["x", "y", "z"][axis],
        position[axis]
    );
    MeshError::at(place, why)
}

/// The number of triangles with an area, and the bounds of these.
fn solid(data: &MeshData) -> (usize, Aabb) {
    let some = |triangles: &[[u32; 3]]| {
        let (mut count, mut bounds) = (0, Aabb::EMPTY);
        for (now, &triangle) in triangles.iter().enumerate() {
            fetch_ahead(&data.positions, triangles, now);
            let corners = corners(data, triangle);
            if has_area(corners) {
                count += 1;
                bounds = bounds.union(Aabb::around(corners));
            }
        }
        (count, bounds)
    };
    data.triangles.par_chunks(FEW).map(some).reduce(|| (0, Aabb::EMPTY), |(n, a), (m, b)| (n + m, a.union(b)))
}

#[inline(always)]
fn corners(data: &MeshData, [a, b, c]: [u32; 3]) -> [DVec3; 3] {
    let position = |vertex: u32| data.positions[vertex as usize];
    [position(a), position(b), position(c)]
}

/// A triangle has an area if the sine of its angle is above `SINE` and its doubled area at least `DOUBLED`.
const SINE: f64 = 4.0 * f64::EPSILON;
const DOUBLED: f64 = 2.0 * f32::MIN_POSITIVE as f64;

/// Whether a triangle encloses an area: its corners differ and are not collinear to within rounding. Its area must be
/// at least the smallest normal f32, because nothing can be computed about smaller ones.
pub(crate) fn has_area([a, b, c]: [DVec3; 3]) -> bool {
    let (u, v) = (b - a, c - a);
    let [square, of_sides] = [u.cross(v).length_squared(), u.length_squared() * v.length_squared()];
    // A square above twice its bound decides without roots, despite rounding. Squares in this range are normal
    // numbers.
    if square > 2.0 * SINE * SINE * of_sides && square > 2.0 * DOUBLED * DOUBLED {
        return true;
    }
    let doubled = square.sqrt();
    let sine = doubled / (u.length() * v.length());
    // False for 0/0 too.
    sine > SINE && doubled >= DOUBLED
}

fn drop_triangles(data: &mut MeshData, keep: &[bool]) {
    retain(&mut data.triangles, keep);
    retain(&mut data.slots, keep);
    if let Some(normals) = &mut data.normals {
        normals.retain(keep);
    }
    if let Some(uvs) = &mut data.uvs {
        uvs.retain(keep);
    }
    data.arrays.iter_mut().for_each(|array| array.retain_triangles(keep));
}

/// The normal scaled to length 1, or zero if it has no direction. In f64, where squares of f32 neither underflow nor
/// overflow.
fn unit(normal: Vec3) -> Vec3 {
    normal.as_dvec3().normalize_or_zero().as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    /// The test by squares decides like the test by lengths, at every scale and at the limits.
    #[test]
    fn squares_decide_about_areas_like_lengths() {
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
