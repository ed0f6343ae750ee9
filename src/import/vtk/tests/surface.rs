//! The surface of cells.

use super::*;
use crate::base::math::DVec3;

#[test]
fn volumes_show_their_outer_faces() {
    let file = format!("# vtk DataFile Version 2.0\n\nASCII\n{BODY}");
    let parts = good(file.as_bytes());
    // Of the hexahedron, one square is shared with the pyramid and one with the wedge.
    assert_eq!(parts.triangles.len(), 4 * 2 + 4 + (2 + 2 * 2) + 4);
    assert_eq!(parts.positions.len(), 13, "points that no face has are left out");
    assert!(
        (volume(&parts) / 6.0 - (1.0 + 1.0 / 3.0 + 0.5 + 1.0 / 6.0)).abs() < 1e-15,
        "{}",
        volume(&parts) / 6.0
    );
    let mut zones = values(&parts, "part", Centering::Cells);
    zones.dedup();
    assert_eq!(zones, [1.0, 2.0, 3.0, 4.0]);
    for (position, height) in parts.positions.iter().zip(values(&parts, "height", Centering::Points)) {
        assert_eq!(position.z, height);
    }
}

/// Each kind of cell alone is closed, and seen from outside.
#[test]
fn faces_of_cells_are_turned_outwards() {
    let cube = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    let voxel = [0, 1, 3, 2, 4, 5, 7, 6].map(|k: usize| cube[k]);
    for (kind, corners, six_volumes) in [
        (10, &[cube[0], cube[1], cube[3], cube[4]][..], 1.0),
        (11, &voxel[..], 6.0),
        (12, &cube[..], 6.0),
        // The normal of a wedge's first triangle points outwards.
        (13, &[cube[0], cube[3], cube[1], cube[4], cube[7], cube[5]][..], 3.0),
        (14, &[cube[0], cube[1], cube[2], cube[3], cube[4]][..], 2.0),
    ] {
        let count = corners.len();
        let points: String = corners.iter().map(|[x, y, z]| format!("{x} {y} {z}\n")).collect();
        let indices: String = (0..count).map(|k| format!(" {k}")).collect();
        let file = format!(
            "# vtk DataFile Version 5.1\n\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {count} float\n{points}\
             CELLS 2 {count}\nOFFSETS vtktypeint64\n0 {count}\nCONNECTIVITY vtktypeint64\n{indices}\n\
             CELL_TYPES 1\n{kind}\n"
        );
        let parts = good(file.as_bytes());
        assert_eq!(volume(&parts).abs(), six_volumes, "type {kind}");
        let centre = corners.iter().map(|&c| DVec3::from(c.map(f64::from))).sum::<DVec3>() / count as f64;
        for triangle in &parts.triangles {
            let [a, b, c] = triangle.map(|vertex| parts.positions[vertex as usize]);
            assert!((b - a).cross(c - a).dot(a - centre) > 0.0, "type {kind}: {triangle:?}");
        }
    }
}

#[test]
fn structured_grids_are_faces_or_volumes() {
    let grid = |[x, y, z]: [usize; 3]| {
        let mut file = format!(
            "# vtk DataFile Version 3.0\n\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS {x} {y} {z}\nPOINTS {} float\n",
            x * y * z
        );
        for index in 0..x * y * z {
            file.push_str(&format!("{} {} {}\n", index % x, index / x % y, index / (x * y)));
        }
        file
    };
    let flat = good(grid([3, 1, 4]).as_bytes());
    assert_eq!((flat.positions.len(), flat.triangles.len()), (12, 12));
    let solid = good(grid([3, 4, 5]).as_bytes());
    assert_eq!(volume(&solid) / 6.0, 24.0);
    assert_eq!(solid.triangles.len(), 2 * 2 * (2 * 3 + 3 * 4 + 4 * 2));
    assert!(fault(grid([3, 1, 1])).ends_with("a grid of 3 x 1 x 1 points has no faces"));
}

/// A legacy file of quadrilaterals and other cells over a grid of 3 x 2 points.
fn cells(cells: &str, types: &str, rest: &str) -> String {
    let count = types.split_whitespace().count();
    let size = cells.split_whitespace().count();
    format!(
        "# vtk DataFile Version 2.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 6 float\n0 0 0 1 0 0 2 0 0\n0 1 0 1 1 0 2 1 0\n\
         CELLS {count} {size}\n{cells}\nCELL_TYPES {count}\n{types}\n{rest}"
    )
}

/// The second half of the points of a quadratic polygon is in the middle of its edges.
#[test]
fn quadratic_polygons_are_their_corners() {
    let parts = good(cells("8 0 2 5 3 1 5 4 3", "36", "").as_bytes());
    assert_eq!((parts.positions.len(), parts.triangles.len()), (4, 2));
    let quad = good(cells("4 0 2 5 3", "9", "").as_bytes());
    assert_eq!(parts, quad);
    assert_eq!(
        fault(cells("5 0 1 2 3 4", "36", "")),
        "line 8: in `CELLS`, cell 0 of type 36 has 5 points; it needs 6"
    );
}

/// VTK hides cells by the bit 32, and marks those that another piece shows by the bit 1.
#[test]
fn ghost_cells_are_not_shown() {
    let flags = |flags: &str| {
        let data = format!(
            "CELL_DATA 2\nSCALARS p float\nLOOKUP_TABLE default\n1 1000\nFIELD f 1\nvtkGhostType 1 2 unsigned_char\n{flags}\n"
        );
        let parts = good(cells("4 0 1 4 3 4 1 2 5 4", "9 9", &data).as_bytes());
        (parts.positions.len(), values(&parts, "p", Centering::Cells))
    };
    assert_eq!(flags("0 0"), (6, vec![1.0, 1.0, 1000.0, 1000.0]));
    for flag in ["0 1", "0 32", "0 33", "2 97"] {
        assert_eq!(flags(flag), (4, vec![1.0, 1.0]), "{flag}");
    }
}

/// Two hexahedra that share a face: a duplicate covers it, and a hidden one shows it.
#[test]
fn duplicates_cover_faces_and_hidden_cells_do_not() {
    let points: String = (0..12).map(|i| format!("{} {} {}\n", i / 4, i % 2, i / 2 % 2)).collect();
    let faces = |flag: u8| {
        let file = format!(
            "# vtk DataFile Version 2.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 12 float\n{points}CELLS 2 18\n\
             8 0 4 5 1 2 6 7 3\n8 4 8 9 5 6 10 11 7\nCELL_TYPES 2\n12 12\nCELL_DATA 2\n\
             SCALARS vtkGhostType unsigned_char\nLOOKUP_TABLE default\n0 {flag}\n"
        );
        good(file.as_bytes()).triangles.len() / 2
    };
    assert_eq!([0, 1, 32].map(faces), [10, 5, 6]);
}

/// An angle of six corners, filled from a corner that does not see all of it.
#[test]
fn concave_polygons_are_filled() {
    let file = "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 6 float\n2 0 0 2 1 0 1 1 0 1 2 0 0 2 0 0 0 0\n\
                POLYGONS 1 7\n6 0 1 2 3 4 5\n";
    let parts = good(file.as_bytes());
    let area = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|vertex| parts.positions[vertex as usize]);
        (b - a).cross(c - a).z
    };
    let areas: Vec<f64> = parts.triangles.iter().map(area).collect();
    assert!(areas.iter().all(|area| *area > 0.0), "{areas:?}");
    assert_eq!(areas.iter().sum::<f64>(), 2.0 * 3.0);
}

/// A file with a cube whose least corner is at `x` on the first axis; a ghost of another part's cell, if there are flags.
fn cube(x: u32, flag: Option<u8>) -> String {
    let points: String = (0..8).map(|k| format!("{} {} {}\n", x + (k & 1), k >> 1 & 1, k >> 2)).collect();
    let flag = flag.map_or_else(String::new, |flag| {
        format!("CELL_DATA 1\nSCALARS vtkGhostType unsigned_char 1\nLOOKUP_TABLE default\n{flag}\n")
    });
    format!(
        "# vtk DataFile Version 3.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 float\n{points}\
         CELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n11\n{flag}"
    )
}

#[test]
fn parts_have_no_faces_where_they_touch() {
    let joined = |files: &[String]| {
        let mut parts = PartReader::default();
        files.iter().for_each(|file| parts.add(file.as_bytes()).expect("a part"));
        let mesh = parts.finish().expect("a mesh");
        (mesh.triangles.len(), volume(&mesh))
    };
    assert_eq!(joined(&[cube(0, None)]), (12, 6.0));
    assert_eq!(joined(&[cube(0, None), cube(1, None)]), (20, 12.0));
    assert_eq!(joined(&[cube(0, None), cube(2, None)]), (24, 12.0));
    // Two parts have the cell in the middle, and say so or not.
    assert_eq!(joined(&[cube(0, None), cube(1, None), cube(1, None), cube(2, None)]), (28, 18.0));
    assert_eq!(joined(&[cube(0, Some(0)), cube(1, Some(1)), cube(1, Some(0)), cube(2, Some(0))]), (28, 18.0));
}
