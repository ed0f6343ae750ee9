//! Whether a mesh encloses a volume.

use super::{TriangleMesh, first_equal};
use rustc_hash::{FxHashMap, FxHashSet};

impl TriangleMesh {
    /// Whether every edge has as many triangles on one side as on the other, and no triangle is the back of another.
    /// Vertices at the same place count as one.
    pub fn is_closed(&self) -> bool {
        *self.closed.get_or_init(|| {
            let place = first_equal(self.positions());
            let triangles =
                || self.triangles().iter().map(|corners| corners.map(|corner| place[corner as usize]));
            is_balanced(triangles()) && !has_sheets(triangles())
        })
    }
}

/// Whether as many triangles run along each edge in one direction as in the other.
fn is_balanced(triangles: impl Iterator<Item = [u32; 3]>) -> bool {
    // The number of triangles that run from the smaller to the larger vertex, less those that run back.
    let mut edges: FxHashMap<(u32, u32), i32> = FxHashMap::default();
    for [a, b, c] in triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *edges.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { -1 };
        }
    }
    edges.values().all(|sum| *sum == 0)
}

/// Whether two triangles are the two sides of a sheet.
fn has_sheets(triangles: impl Iterator<Item = [u32; 3]> + Clone) -> bool {
    // Begins with the smallest corner, which keeps the direction.
    let turned = |[a, b, c]: [u32; 3]| match a.min(b).min(c) {
        least if least == a => [a, b, c],
        least if least == b => [b, c, a],
        _ => [c, a, b],
    };
    let all: FxHashSet<[u32; 3]> = triangles.clone().map(turned).collect();
    let is_flat = |[a, b, c]: [u32; 3]| a == b || b == c || c == a;
    let mut sheets = triangles.filter(|corners| !is_flat(*corners)).map(|[a, b, c]| turned([a, c, b]));
    sheets.any(|back| all.contains(&back))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::DVec3;
    use crate::geometry::mesh::MeshData;

    fn mesh(triangles: &[[u32; 3]]) -> TriangleMesh {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, DVec3::ZERO];
        let data = MeshData { positions, triangles: triangles.to_vec(), ..MeshData::default() };
        TriangleMesh::new(data).expect("a mesh")
    }

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [4, 3, 2], [1, 2, 3]];

    #[test]
    fn meshes_without_open_edges_and_sheets_are_closed() {
        assert!(mesh(&TETRAHEDRON).is_closed());
        assert!(mesh(&TETRAHEDRON.map(|[a, b, c]| [a, c, b])).is_closed());
        assert!(!mesh(&TETRAHEDRON[1..]).is_closed());
        let mut turned = TETRAHEDRON;
        turned[0].reverse();
        assert!(!mesh(&turned).is_closed());
        assert!(!mesh(&[[0, 1, 2], [1, 0, 2]]).is_closed());
        assert!(!mesh(&[&TETRAHEDRON[..], &[[3, 2, 1]]].concat()).is_closed());
    }
}
