//! Normals of a surface that is smooth except at creases: edges where triangles meet at more than an angle.

use super::build::has_area;
use super::corners::Corners;
use super::smooth::{angle, first_equal};
use crate::base::math::{Angle, DVec3};
use glam::Vec3;
use rayon::prelude::*;
use std::cmp::Ordering;

/// One normal per corner. The triangles around a vertex form fans: neighbours across an edge are in the same fan if
/// their normals differ by at most `crease`. All corners of a fan share their normal, weighted as in
/// [`super::smooth::normals`]. Equal positions count as one vertex. Triangles without an area have no neighbours.
pub fn normals(positions: &[DVec3], triangles: &[[u32; 3]], crease: Angle) -> Corners<Vec3> {
    let within = |triangle: &[u32; 3]| triangle.iter().all(|&vertex| (vertex as usize) < positions.len());
    if !triangles.iter().all(within) {
        // Faulty indices are reported when the mesh is built.
        return Corners::per_vertex(Vec::new());
    }
    let shared = first_equal(positions);
    let vertex = |corner: u32| shared[triangles[corner as usize / 3][corner as usize % 3] as usize];
    let corners = |triangle: &[u32; 3]| triangle.map(|vertex| positions[vertex as usize]);
    // Zero without an area.
    let normal = |triangle: &[u32; 3]| {
        let [a, b, c] = corners(triangle);
        if has_area([a, b, c]) { (b - a).cross(c - a).normalize_or_zero() } else { DVec3::ZERO }
    };
    let flat: Vec<DVec3> = triangles.iter().map(normal).collect();
    let least = crease.cos_sin().x;
    let mut fans = Fans::new(3 * triangles.len());
    let mut join = |p: u32, q: u32| {
        if flat[p as usize / 3].dot(flat[q as usize / 3]) < least {
            return;
        }
        // The edges begin at p and q. Corners at equal vertices join.
        for (p, q) in [(p, q), (p, next(q)), (next(p), q), (next(p), next(q))] {
            if vertex(p) == vertex(q) {
                fans.join(p, q);
            }
        }
    };
    let mut edges = edges(&flat, vertex);
    for same in edges.chunk_by_mut(|a, b| a.0 == b.0) {
        if let [([from, to], _), _, _, ..] = *same {
            sort_around(positions[to as usize] - positions[from as usize], same, &flat);
            // Around the edge, the first one follows the last one.
            join(same[0].1, same[same.len() - 1].1);
        }
        same.array_windows().for_each(|[(_, p), (_, q)]| join(*p, *q));
    }
    let mut sums = vec![DVec3::ZERO; 3 * triangles.len()];
    for (part, triangle) in triangles.iter().enumerate() {
        let [a, b, c] = corners(triangle);
        for (k, (at, p, q)) in [(a, b, c), (b, c, a), (c, a, b)].into_iter().enumerate() {
            let fan = fans.of(3 * part as u32 + k as u32);
            sums[fan as usize] += flat[part] * angle::<f64>(at.into(), p.into(), q.into());
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

/// An edge by its two vertices, and the corner of a triangle where it begins.
type Edge = ([u32; 2], u32);

/// The edges of all triangles with a normal. Those between the same two vertices are consecutive.
fn edges(flat: &[DVec3], vertex: impl Fn(u32) -> u32) -> Vec<Edge> {
    let solid = (0..3 * flat.len() as u32).filter(|edge| flat[*edge as usize / 3] != DVec3::ZERO);
    let ends = |edge: u32| [vertex(edge), vertex(next(edge))];
    let mut edges: Vec<Edge> = Vec::with_capacity(3 * flat.len());
    edges.extend(solid.map(|edge| {
        let [a, b] = ends(edge);
        ([a.min(b), a.max(b)], edge)
    }));
    edges.par_sort_unstable();
    edges
}

/// Sorts the triangles at an edge by their normals around it. All normals are perpendicular to the edge, so any two
/// that differ by at most an angle are connected by steps of at most this angle between neighbours in this order.
fn sort_around(along: DVec3, edges: &mut [Edge], flat: &[DVec3]) {
    let (x, y) = along.normalize_or_zero().any_orthonormal_pair();
    let key = |edge: &Edge| {
        let normal = flat[edge.1 as usize / 3];
        // The coordinates decide between equal angles, never the order in the mesh.
        [libm::atan2(normal.dot(y), normal.dot(x)), normal.x, normal.y, normal.z]
    };
    let ordered =
        |a: &[f64; 4], b: &[f64; 4]| a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne());
    edges.sort_by(|a, b| ordered(&key(a), &key(b)).unwrap_or(Ordering::Equal));
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

    /// A bent strip, whose middle edge also belongs to triangles without an area: two corners at one place, or three on
    /// a line.
    #[test]
    fn triangles_without_an_area_make_no_edges() {
        let mut positions =
            vec![DVec3::ZERO, DVec3::X, DVec3::new(0.5, 1.0, 0.0), DVec3::new(0.5, -1.0, 0.1)];
        let strip = MeshData {
            positions: positions.clone(),
            triangles: vec![[0, 1, 2], [1, 0, 3]],
            ..MeshData::default()
        };
        let expected = at(&strip, 30.0);
        assert_ne!(expected[0][2], expected[0][0], "the fold is smooth");
        positions.push(DVec3::new(0.25, 0.0, 0.0));
        for flat in [[0, 1, 1], [1, 0, 0], [0, 1, 4], [1, 4, 0]] {
            for place in 0..3 {
                let mut triangles = strip.triangles.clone();
                triangles.insert(place, flat);
                let mut found =
                    at(&MeshData { positions: positions.clone(), triangles, ..MeshData::default() }, 30.0);
                found.remove(place);
                assert_eq!(found, expected, "{flat:?} at {place}");
            }
        }
    }

    /// Triangles like the pages of a book at one edge, in every order: the groups are those of angles up to the crease.
    #[test]
    fn the_order_of_triangles_at_an_edge_does_not_matter() {
        let angles = [0.0, 30.0, 62.0, 120.0, 145.0, 350.0];
        let mut positions = vec![DVec3::ZERO, DVec3::Z];
        positions
            .extend(angles.map(|angle| Angle(angle).cos_sin()).map(|turn| DVec3::new(turn.x, turn.y, 0.5)));
        let page = |index: usize| [0, 1, 2 + index as u32];
        let fans = |order: &[usize]| {
            let triangles = order.iter().map(|&index| page(index)).collect();
            let corners =
                at(&MeshData { positions: positions.clone(), triangles, ..MeshData::default() }, 31.0);
            let mut fans = [0; 6];
            for (place, &index) in order.iter().enumerate() {
                // The first page of the same fan.
                let same = order
                    .iter()
                    .enumerate()
                    .filter(|(other, _)| (corners[*other][0] - corners[place][0]).length() < 1e-6);
                fans[index] = same.map(|(_, index)| *index).min().expect("itself");
            }
            fans
        };
        // Pages 3 and 4 differ by 25 degrees, and pages 5, 0 and 1 by 10 and 30.
        let expected = [0, 0, 2, 3, 3, 0];
        let mut random = crate::testing::Random(3);
        let mut order: Vec<usize> = (0..6).collect();
        for _ in 0..100 {
            for last in (1..6).rev() {
                order.swap(last, (random.unit() * (last + 1) as f64) as usize);
            }
            assert_eq!(fans(&order), expected, "{order:?}");
        }
    }
}
