//! Normals of a surface that is smooth except at creases: edges where triangles meet at more than an angle.

use super::corners::Corners;
use super::smooth::{angle, first_equal};
use crate::base::math::{Angle, DVec3};
use glam::Vec3;
use rustc_hash::FxHashMap;

/// One normal per corner. The triangles around a vertex form fans: neighbours across an edge are in the same fan if
/// their normals differ by at most `crease`. All corners of a fan share their normal, weighted as in
/// [`super::smooth::normals`]. Equal positions count as one vertex.
pub fn normals(positions: &[DVec3], triangles: &[[u32; 3]], crease: Angle) -> Corners<Vec3> {
    let within = |triangle: &[u32; 3]| triangle.iter().all(|&vertex| (vertex as usize) < positions.len());
    if !triangles.iter().all(within) {
        // Faulty indices are reported when the mesh is built.
        return Corners::per_vertex(Vec::new());
    }
    let shared = first_equal(positions);
    let vertex = |corner: u32| shared[triangles[corner as usize / 3][corner as usize % 3] as usize];
    let corners = |triangle: &[u32; 3]| triangle.map(|vertex| positions[vertex as usize]);
    let flat: Vec<DVec3> = triangles
        .iter()
        .map(|triangle| {
            let [a, b, c] = corners(triangle);
            (b - a).cross(c - a).normalize_or_zero()
        })
        .collect();
    let mut fans = Fans::new(3 * triangles.len());
    let least = crease.cos_sin().x;
    for [p, q] in neighbours(triangles.len(), vertex) {
        if flat[p as usize / 3].dot(flat[q as usize / 3]) < least {
            continue;
        }
        // The edges begin at p and q. Corners at equal vertices join.
        for (p, q) in [(p, q), (p, next(q)), (next(p), q), (next(p), next(q))] {
            if vertex(p) == vertex(q) {
                fans.join(p, q);
            }
        }
    }
    let mut sums = vec![DVec3::ZERO; 3 * triangles.len()];
    for (part, triangle) in triangles.iter().enumerate() {
        let [a, b, c] = corners(triangle);
        for (k, corner) in [(a, b, c), (b, c, a), (c, a, b)].into_iter().enumerate() {
            let fan = fans.of(3 * part as u32 + k as u32);
            sums[fan as usize] += flat[part] * angle(corner);
        }
    }
    packed(&mut fans, &sums, triangles)
}

/// The normals of the fans, and the index of each corner's one.
fn packed(fans: &mut Fans, sums: &[DVec3], triangles: &[[u32; 3]]) -> Corners<Vec3> {
    let mut values = Vec::new();
    let mut index_of = vec![u32::MAX; sums.len()];
    let mut index = |corner: u32| {
        let fan = fans.of(corner) as usize;
        if index_of[fan] == u32::MAX {
            index_of[fan] = values.len() as u32;
            values.push(sums[fan].normalize_or_zero().as_vec3());
        }
        index_of[fan]
    };
    let indices = (0..triangles.len() as u32).map(|part| [0, 1, 2].map(|k| index(3 * part + k))).collect();
    Corners::indexed(values, indices, triangles)
}

/// The next corner of the same triangle.
fn next(corner: u32) -> u32 {
    if corner % 3 == 2 { corner - 2 } else { corner + 1 }
}

/// Pairs of edges of different triangles between the same two vertices, each given by the corner where it begins. If
/// more than two triangles meet at an edge, each is paired with the one before it in the mesh.
fn neighbours(triangles: usize, vertex: impl Fn(u32) -> u32) -> Vec<[u32; 2]> {
    let mut last: FxHashMap<[u32; 2], u32> = FxHashMap::default();
    last.reserve(3 * triangles / 2);
    let mut pairs = Vec::with_capacity(3 * triangles / 2);
    for edge in 0..3 * triangles as u32 {
        let (a, b) = (vertex(edge), vertex(next(edge)));
        if let Some(other) = last.insert([a.min(b), a.max(b)], edge) {
            pairs.push([other, edge]);
        }
    }
    pairs
}

/// Disjoint sets of corners.
struct Fans(Vec<u32>);

impl Fans {
    fn new(corners: usize) -> Self {
        Self((0..corners as u32).collect())
    }

    /// The first corner of a corner's fan. Halves the way to it (Tarjan, van Leeuwen 1984).
    fn of(&mut self, mut corner: u32) -> u32 {
        while self.0[corner as usize] != corner {
            let parent = self.0[corner as usize];
            self.0[corner as usize] = self.0[parent as usize];
            corner = parent;
        }
        corner
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.of(a), self.of(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::{MeshData, generate, smooth};

    /// The unit cube of 12 triangles that share 8 vertices.
    fn cube() -> MeshData {
        let positions =
            (0..8).map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2))).collect();
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        MeshData { positions, triangles, ..MeshData::default() }
    }

    fn at(data: &MeshData, crease: f64) -> Vec<[Vec3; 3]> {
        let normals = normals(&data.positions, &data.triangles, Angle(crease));
        (0..data.triangles.len() as u32)
            .map(|part| normals.at(part, &data.triangles).expect("normals"))
            .collect()
    }

    #[test]
    fn a_cube_is_sharp_below_a_right_angle_and_smooth_above() {
        let cube = cube();
        for (part, corners) in at(&cube, 89.0).into_iter().enumerate() {
            let [a, b, c] = cube.triangles[part].map(|vertex| cube.positions[vertex as usize]);
            assert_eq!(corners, [(b - a).cross(c - a).normalize().as_vec3(); 3]);
        }
        let smooth = smooth::normals(&cube.positions, &cube.triangles);
        for (corners, triangle) in at(&cube, 91.0).into_iter().zip(&cube.triangles) {
            for (normal, vertex) in corners.into_iter().zip(triangle) {
                assert!((normal - smooth[*vertex as usize]).length() < 1e-6);
            }
        }
    }

    #[test]
    fn shared_and_separate_vertices_give_the_same_normals() {
        let ball = generate::icosphere(2);
        let positions = ball.triangles.as_flattened().iter().map(|&v| ball.positions[v as usize]).collect();
        let triangles =
            (0..ball.triangles.len() as u32).map(|part| [3 * part, 3 * part + 1, 3 * part + 2]).collect();
        let soup = MeshData { positions, triangles, ..MeshData::default() };
        assert_eq!(at(&ball, 30.0), at(&soup, 30.0));
        let radial = |v: u32| ball.positions[v as usize].as_vec3();
        for (corners, triangle) in at(&ball, 30.0).into_iter().zip(&ball.triangles) {
            for (normal, vertex) in corners.into_iter().zip(triangle) {
                assert!(normal.dot(radial(*vertex)) > 0.999);
            }
        }
    }

    #[test]
    fn triangles_that_face_opposite_ways_are_not_smoothed() {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 0.0)];
        let data = MeshData { positions, triangles: vec![[0, 1, 2], [1, 2, 3]], ..MeshData::default() };
        assert_eq!(at(&data, 40.0), [[Vec3::Z; 3], [Vec3::NEG_Z; 3]]);
    }
}
