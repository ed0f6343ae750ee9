//! Areas of a plane → solids with two equal faces.

use super::data::MeshData;
use crate::base::math::DVec3;
use i_triangle::i_overlay::i_float::int::point::IntPoint;
use i_triangle::int::triangulatable::IntTriangulatable;
use rustc_hash::FxHashSet;

/// A solid around z = 0 whose faces are the area within polygons (nonzero winding, whatever crosses or overlaps), in
/// units of a length. Without depth, it is a flat area that looks to the side of z. Triangles are counter-clockwise
/// seen from outside, and share the vertices at their edges, so a solid is closed.
pub fn extruded(polygons: &[Vec<[i32; 2]>], unit: f64, depth: f64) -> MeshData {
    let shape: Vec<Vec<IntPoint<i32>>> =
        polygons.iter().map(|polygon| polygon.iter().map(|[x, y]| IntPoint::new(*x, *y)).collect()).collect();
    // Exact in whole numbers; where outlines cross, it adds points that are rounded to whole units.
    let area = shape.triangulate();
    let (points, indices) = (area.points(), area.triangle_indices::<u32>());
    let triangles: Vec<[u32; 3]> = indices.as_chunks::<3>().0.iter().map(|t| upwards(*t, points)).collect();
    let half = 0.5 * depth;
    let at = |z: f64| points.iter().map(move |p| DVec3::new(f64::from(p.x) * unit, f64::from(p.y) * unit, z));
    if depth == 0.0 {
        return MeshData { positions: at(0.0).collect(), triangles, ..MeshData::default() };
    }
    let back = points.len() as u32;
    let edges = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]];
    let all: FxHashSet<[u32; 2]> = triangles.iter().flat_map(|triangle| edges(*triangle)).collect();
    // Edges of one triangle only; the area lies to their left.
    let outline = triangles.iter().flat_map(|triangle| edges(*triangle));
    let outline = outline.filter(|[a, b]| !all.contains(&[*b, *a]));
    let walls = outline.flat_map(|[a, b]| [[a + back, b + back, b], [a + back, b, a]]);
    let behind = triangles.iter().map(|[a, b, c]| [a + back, c + back, b + back]);
    MeshData {
        positions: at(half).chain(at(-half)).collect(),
        triangles: triangles.iter().copied().chain(behind).chain(walls).collect(),
        ..MeshData::default()
    }
}

/// The corners of a triangle in counter-clockwise order.
fn upwards([a, b, c]: [u32; 3], points: &[IntPoint<i32>]) -> [u32; 3] {
    let at = |index: u32| {
        let point = points[index as usize];
        [point.x, point.y].map(i128::from)
    };
    let ([ax, ay], [bx, by], [cx, cy]) = (at(a), at(b), at(c));
    if (bx - ax) * (cy - ay) < (by - ay) * (cx - ax) { [a, c, b] } else { [a, b, c] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::{Align, Font, text_outlines};
    use std::collections::HashMap;

    /// Six times the volume within triangles (the divergence theorem): exact for coordinates that are multiples of a
    /// power of two, as here, where every product and sum fits into f64.
    fn six_volumes(mesh: &MeshData) -> f64 {
        let corner = |index: u32| mesh.positions[index as usize];
        mesh.triangles.iter().map(|[a, b, c]| corner(*a).dot(corner(*b).cross(corner(*c)))).sum()
    }

    fn check_closed(mesh: &MeshData) {
        let mut edges: HashMap<[u32; 2], i32> = HashMap::new();
        for [a, b, c] in &mesh.triangles {
            for [from, to] in [[*a, *b], [*b, *c], [*c, *a]] {
                *edges.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
            }
        }
        assert!(edges.values().all(|balance| *balance == 0), "each edge has a triangle on both sides");
    }

    #[test]
    fn areas_become_closed_solids() {
        let square = |from: i32, to: i32| vec![[from, from], [to, from], [to, to], [from, to]];
        let hole = |from, to| square(from, to).into_iter().rev().collect::<Vec<_>>();
        for (polygons, area) in [
            (vec![square(0, 10)], 100.0),
            (vec![square(0, 10), hole(2, 4)], 96.0),
            // Overlapping areas count once.
            (vec![square(0, 10), square(5, 15)], 175.0),
            // A polygon that crosses itself, with windings of 1 and -1.
            (vec![vec![[0, 0], [10, 10], [10, 0], [0, 10]]], 50.0),
            (vec![square(0, 4), square(4, 8)], 32.0),
        ] {
            let solid = extruded(&polygons, 0.5, 3.0);
            assert_eq!(six_volumes(&solid), 6.0 * (area * 0.25 * 3.0), "{polygons:?}");
            check_closed(&solid);
            let flat = extruded(&polygons, 0.5, 0.0);
            assert!(flat.positions.iter().all(|point| point.z == 0.0));
        }
        assert!(extruded(&[], 1.0, 1.0).triangles.is_empty());
        assert!(extruded(&[vec![[0, 0], [5, 5], [9, 9]]], 1.0, 1.0).triangles.is_empty());
    }

    #[test]
    fn letters_are_closed() {
        let outlines = text_outlines(&Font::default(), "Q&g%8@ß\nΩЖ", Align::Center);
        let unit = 1.0 / 1024.0;
        let solid = extruded(&outlines, unit, 4.0);
        check_closed(&solid);
        let flat = extruded(&outlines, unit, 0.0);
        let corner = |index: u32| flat.positions[index as usize];
        let two_areas = |[a, b, c]: &[u32; 3]| (corner(*b) - corner(*a)).cross(corner(*c) - corner(*a)).z;
        let whole: f64 = flat.triangles.iter().map(two_areas).sum();
        assert_eq!(six_volumes(&solid), 3.0 * whole * 4.0);
        assert!(flat.triangles.iter().all(|triangle| two_areas(triangle) >= 0.0));
    }
}
