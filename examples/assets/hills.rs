//! A sphere with hills: an icosahedron whose faces are cut into small triangles, which are moved to the sphere and then
//! in and out by waves. Numbers are rounded to six decimals, so that the file can be compared with those that other
//! programs make by the same rules.

use kinora::base::math::DVec3;
use kinora::geometry::mesh::generate::icosphere;
use kinora::geometry::mesh::{Corners, MeshData};
use std::collections::BTreeMap;

/// Small triangles along an edge of the icosahedron: 20 · 209² triangles in all.
const PIECES: u32 = 209;

/// Waves on top of each other, each shorter and lower than the one before.
const WAVES: u32 = 6;

/// About 873,000 triangles with normals.
pub fn parts() -> MeshData {
    hills(PIECES)
}

fn hills(pieces: u32) -> MeshData {
    let mut parts = cut(pieces);
    for position in &mut parts.positions {
        let point = position.normalize();
        *position = rounded(point * (1.0 + height(point)));
    }
    parts.normals = Some(Corners::per_vertex(normals(&parts)));
    for position in &mut parts.positions {
        // As f32 numbers, which is what the file holds.
        *position = position.as_vec3().as_dvec3();
    }
    parts
}

/// The icosahedron with each face cut into `pieces`² triangles. Positions ascend by x, then y, then z.
fn cut(pieces: u32) -> MeshData {
    let MeshData { positions: corners, triangles: faces, .. } = icosphere(0);
    let mut points = Vec::new();
    for face in &faces {
        let [a, b, c] = face.map(|corner| corners[corner as usize]);
        for i in 0..=pieces {
            for j in 0..=pieces - i {
                let share = |count: u32| f64::from(count) / f64::from(pieces);
                points.push(a * share(pieces - i - j) + b * share(i) + c * share(j));
            }
        }
    }
    // Faces share the points on their edges, up to rounding.
    let key = |point: &DVec3| point.to_array().map(|x| (x * 1e7).round_ties_even() as i64);
    let mut indices = BTreeMap::new();
    for point in &points {
        indices.entry(key(point)).or_insert((0, *point));
    }
    for (next, (index, _)) in (0..).zip(indices.values_mut()) {
        *index = next;
    }
    let vertices: Vec<u32> = points.iter().map(|point| indices[&key(point)].0).collect();

    let mut parts = MeshData::default();
    parts.positions.extend(indices.values().map(|(_, point)| *point));
    for face in vertices.chunks_exact(vertices.len() / faces.len()) {
        // The rows of points become shorter by one each.
        let mut row = 0;
        for length in (1..=pieces as usize).rev() {
            let next = row + length + 1;
            for j in 0..length {
                parts.triangles.push([face[row + j], face[next + j], face[row + j + 1]]);
                if j + 1 < length {
                    parts.triangles.push([face[next + j], face[next + j + 1], face[row + j + 1]]);
                }
            }
            row = next;
        }
    }
    parts
}

fn height(mut point: DVec3) -> f64 {
    let (mut sum, mut amplitude, mut frequency) = (0.0, 0.06, 3.0);
    for wave in 0..WAVES {
        let wave = f64::from(wave);
        let DVec3 { x, y, z } = point;
        sum += amplitude
            * libm::sin(frequency * x + 1.3 * wave)
            * libm::sin(frequency * y + 2.1 * wave + 0.7)
            * libm::sin(frequency * z + 0.9 * wave + 1.9);
        // Turned, so that the waves do not line up.
        let (x, y, z) = (0.8 * x + 0.6 * y, -0.6 * x + 0.8 * y, z + 0.1 * x);
        point = DVec3::new(x, 0.8 * y + 0.6 * z, -0.6 * y + 0.8 * z);
        amplitude *= 0.55;
        frequency *= 2.03;
    }
    sum
}

/// Triangles count by their area.
fn normals(parts: &MeshData) -> Vec<glam::Vec3> {
    let mut sums = vec![DVec3::ZERO; parts.positions.len()];
    for triangle in &parts.triangles {
        let [a, b, c] = triangle.map(|vertex| parts.positions[vertex as usize]);
        let normal = (b - a).cross(c - a);
        for vertex in triangle {
            sums[*vertex as usize] += normal;
        }
    }
    sums.into_iter().map(|sum| rounded(sum.normalize()).as_vec3()).collect()
}

fn rounded(v: DVec3) -> DVec3 {
    v.map(|x| (x * 1e6).round_ties_even() / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn the_surface_is_closed() {
        let parts = hills(7);
        assert_eq!((parts.positions.len(), parts.triangles.len()), (10 * 7 * 7 + 2, 20 * 7 * 7));
        let edges = |[a, b, c]: &[u32; 3]| [(*a, *b), (*b, *c), (*c, *a)];
        let all: HashSet<_> = parts.triangles.iter().flat_map(edges).collect();
        assert_eq!(all.len(), 3 * parts.triangles.len());
        assert!(all.iter().all(|&(a, b)| all.contains(&(b, a))));
    }
}
