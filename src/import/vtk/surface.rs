//! The surface of cells: faces, and the outer faces of volumes.

use super::ghosts::{DUPLICATE, Ghosts, HIDDEN};
use super::grid::{Cells, Grid};
use crate::base::machine;
use crate::geometry::mesh::{Centering, Corners, DataArray, MeshData, MeshError, first_equal};
use crate::import::polygon::{cut, fan};
use rayon::prelude::*;

pub const POLYLINE: u8 = 4;
pub const STRIP: u8 = 6;
pub const POLYGON: u8 = 7;
pub const QUAD: u8 = 9;
pub const HEXAHEDRON: u8 = 12;
pub const VERTICES: u8 = 2;

/// Cells of one type in polygonal data.
pub struct PolygonalKind {
    /// Their section in legacy files, and their element in XML files.
    pub section: &'static str,
    pub element: &'static str,
    pub cell_type: u8,
}

/// The cells of polygonal data. Data of cells follow this order, whatever the order in the file.
pub const POLYGONAL_KINDS: [PolygonalKind; 4] = [
    PolygonalKind { section: "VERTICES", element: "Verts", cell_type: VERTICES },
    PolygonalKind { section: "LINES", element: "Lines", cell_type: POLYLINE },
    PolygonalKind { section: "POLYGONS", element: "Polys", cell_type: POLYGON },
    PolygonalKind { section: "TRIANGLE_STRIPS", element: "Strips", cell_type: STRIP },
];

/// What a cell contributes to the surface.
#[derive(Clone, Copy)]
enum Surface {
    /// Points and lines have none.
    Nothing,
    /// A polygon of this many corners. Further points are on curved edges.
    Corners(usize),
    /// A polygon of all points.
    Polygon,
    /// A polygon of the first half of the points. The others are in the middle of its edges.
    QuadraticPolygon,
    /// The corners in this order.
    Ordered(&'static [u8]),
    Strip,
    /// The faces of a volume, counter-clockwise as seen from outside.
    Volume(&'static [&'static [u8]]),
}

const TETRAHEDRON: &[&[u8]] = &[&[0, 1, 3], &[1, 2, 3], &[2, 0, 3], &[0, 2, 1]];
const HEXAHEDRON_FACES: &[&[u8]] =
    &[&[0, 4, 7, 3], &[1, 2, 6, 5], &[0, 1, 5, 4], &[3, 7, 6, 2], &[0, 3, 2, 1], &[4, 5, 6, 7]];
/// A hexahedron whose corners follow x, then y, then z.
const VOXEL: &[&[u8]] =
    &[&[0, 4, 6, 2], &[1, 3, 7, 5], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 2, 3, 1], &[4, 5, 7, 6]];
const WEDGE: &[&[u8]] = &[&[0, 1, 2], &[3, 5, 4], &[0, 3, 4, 1], &[1, 4, 5, 2], &[2, 5, 3, 0]];
const PYRAMID: &[&[u8]] = &[&[0, 3, 2, 1], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]];

/// The surface of a cell of this type; none for types that are not read. Curved cells begin with their corners, and
/// these are shown.
fn surface(kind: u8) -> Option<Surface> {
    Some(match kind {
        0..=4 | 21 | 35 | 68 | 75 => Surface::Nothing,
        5 | 22 | 34 | 69 | 76 => Surface::Corners(3),
        STRIP => Surface::Strip,
        POLYGON => Surface::Polygon,
        36 => Surface::QuadraticPolygon,
        8 => Surface::Ordered(&[0, 1, 3, 2]),
        QUAD | 23 | 28 | 30 | 70 | 77 => Surface::Corners(4),
        10 | 24 | 71 | 78 => Surface::Volume(TETRAHEDRON),
        11 => Surface::Volume(VOXEL),
        HEXAHEDRON | 25 | 29 | 33 | 72 | 79 => Surface::Volume(HEXAHEDRON_FACES),
        13 | 26 | 31 | 32 | 73 | 80 => Surface::Volume(WEDGE),
        14 | 27 | 37 | 74 | 81 => Surface::Volume(PYRAMID),
        _ => return None,
    })
}

/// The number of points that a cell needs at least.
fn least_points(surface: &Surface) -> usize {
    let of = |face: &[u8]| face.iter().map(|&corner| usize::from(corner) + 1).max().unwrap_or(0);
    match surface {
        Surface::Nothing => 0,
        Surface::Corners(count) => *count,
        Surface::Polygon => 3,
        Surface::QuadraticPolygon => 6,
        Surface::Ordered(face) => of(face),
        Surface::Strip => 3,
        Surface::Volume(faces) => faces.iter().map(|face| of(face)).max().unwrap_or(0),
    }
}

/// Checks that cells of this type are read, and have this many points.
pub fn check_cell(cell: usize, kind: u8, points: usize) -> Result<(), String> {
    let Some(surface) = surface(kind) else {
        return Err(format!(
            "cell {cell} has the type {kind}, which is not read; VTK's linear and quadratic cells are"
        ));
    };
    let least = least_points(&surface);
    if points < least {
        return Err(format!("cell {cell} of type {kind} has {points} points; it needs {least}"));
    }
    Ok(())
}

/// The mesh of a grid's surface.
pub fn mesh(grid: Grid) -> Result<MeshData, MeshError> {
    let ghosts = Ghosts::of(&grid.arrays);
    // Parts name their points by themselves. Where these are equal, the parts touch.
    let names = grid.is_joined.then(|| first_equal(&grid.positions));
    let hidden = if grid.is_joined { HIDDEN | DUPLICATE } else { HIDDEN };
    let outer = outer_faces(&grid.cells, &ghosts, hidden, names.as_deref())?;
    let (mut triangles, mut cell_of) = (Vec::new(), Vec::new());
    let mut outer = outer.into_iter();
    for cell in (0..grid.cells.len()).filter(|&cell| !ghosts.has(cell, hidden)) {
        let shown = !ghosts.has(cell, DUPLICATE);
        each_face(&grid.cells, cell, |corners, inside| {
            if (!inside || outer.next().unwrap_or(true)) && shown {
                let add = |triangle| triangles.push(triangle);
                match inside {
                    true => fan(corners, add),
                    false => cut(corners, &grid.positions, add),
                }
            }
        });
        cell_of.resize(triangles.len(), cell as u32);
    }
    let Grid { mut positions, mut normals, mut arrays, .. } = grid;
    for array in arrays.iter_mut().filter(|array| array.centering == Centering::Cells) {
        *array = picked(array, &cell_of);
    }
    if let Some(kept) = used(positions.len(), &mut triangles) {
        positions = kept.iter().map(|&point| positions[point as usize]).collect();
        normals =
            if normals.is_empty() { normals } else { kept.iter().map(|&p| normals[p as usize]).collect() };
        for array in arrays.iter_mut().filter(|array| array.centering == Centering::Points) {
            *array = picked(array, &kept);
        }
    }
    let normals = (!normals.is_empty()).then(|| Corners::per_vertex(normals));
    Ok(MeshData { positions, triangles, normals, arrays, ..MeshData::default() })
}

/// Calls `visit` with the corners of each face of a cell, and whether it may be inside of a body.
fn each_face(cells: &Cells, cell: usize, mut visit: impl FnMut(&[u32], bool)) {
    let corners = cells.corners(cell);
    let mut face: [u32; 4] = [0; 4];
    let mut ordered = |order: &[u8], inside: bool, visit: &mut dyn FnMut(&[u32], bool)| {
        face.iter_mut().zip(order).for_each(|(to, &from)| *to = corners[usize::from(from)]);
        visit(&face[..order.len()], inside);
    };
    // All cells have been checked, so there is a surface and it has its points.
    match surface(cells.types[cell]).unwrap_or(Surface::Nothing) {
        Surface::Nothing => {}
        Surface::Corners(count) => visit(&corners[..count], false),
        Surface::Polygon => visit(corners, false),
        Surface::QuadraticPolygon => visit(&corners[..corners.len() / 2], false),
        Surface::Ordered(order) => ordered(order, false, &mut visit),
        Surface::Strip => {
            for (index, &[a, b, c]) in corners.array_windows().enumerate() {
                visit(&if index % 2 == 0 { [a, b, c] } else { [b, a, c] }, false);
            }
        }
        Surface::Volume(faces) => faces.iter().for_each(|face| ordered(face, true, &mut visit)),
    }
}

/// For each face of a volume without these flags, in order, whether it is the only one with its corners.
///
/// Points with equal `names` are the same point. Then parts may share cells: the first of equal faces that are turned to the
/// same side is an outer face too.
fn outer_faces(
    cells: &Cells,
    ghosts: &Ghosts,
    hidden: u8,
    names: Option<&[u32]>,
) -> Result<Vec<bool>, MeshError> {
    let not_hidden = || (0..cells.len()).filter(|&cell| !ghosts.has(cell, hidden));
    let name = |&point: &u32| names.map_or(point, |names| names[point as usize]);
    let mut count = 0_u64;
    for cell in not_hidden() {
        each_face(cells, cell, |_, inside| count += u64::from(inside));
    }
    if count > u32::MAX.into() {
        return Err(MeshError::new("it has more than 4 294 967 295 faces of volumes"));
    }
    machine::check_memory(count * size_of::<([u32; 4], u32, bool)>() as u64)?;
    let mut faces: Vec<([u32; 4], u32, bool)> = Vec::with_capacity(count as usize);
    for cell in not_hidden() {
        each_face(cells, cell, |corners, inside| {
            if inside {
                let mut key = [u32::MAX; 4];
                key.iter_mut().zip(corners).for_each(|(key, corner)| *key = name(corner));
                let turn = turn(&key[..corners.len()]);
                key.sort_unstable();
                faces.push((key, faces.len() as u32, turn));
            }
        });
    }
    faces.par_sort_unstable();
    let mut outer = vec![false; faces.len()];
    for same in faces.chunk_by(|a, b| a.0 == b.0) {
        let (_, face, turn) = same[0];
        outer[face as usize] =
            same.len() == 1 || names.is_some() && same.iter().all(|(_, _, other)| *other == turn);
    }
    Ok(outer)
}

/// Which way round a face goes through its corners. The face seen from its other side goes the other way.
fn turn(corners: &[u32]) -> bool {
    let count = corners.len();
    let least = (0..count).min_by_key(|&at| corners[at]).unwrap_or(0);
    corners[(least + 1) % count] < corners[(least + count - 1) % count]
}

/// The entries of an array with these indices.
fn picked(array: &DataArray, entries: &[u32]) -> DataArray {
    let of = |entry: &u32| {
        let first = *entry as usize * array.components;
        (first..first + array.components).map(|index| array.values.get(index))
    };
    let values = entries.iter().flat_map(of).collect::<Vec<f64>>().into();
    DataArray { name: array.name.clone(), values, ..*array }
}

/// The points that triangles use, if some are left out. Triangles are numbered by these then.
fn used(points: usize, triangles: &mut [[u32; 3]]) -> Option<Vec<u32>> {
    let mut places = vec![u32::MAX; points];
    triangles.iter().flatten().for_each(|&point| places[point as usize] = 0);
    let kept: Vec<u32> = (0..points as u32).filter(|&point| places[point as usize] == 0).collect();
    if kept.len() == points {
        return None;
    }
    for (place, &point) in kept.iter().enumerate() {
        places[point as usize] = place as u32;
    }
    triangles.iter_mut().flatten().for_each(|point| *point = places[*point as usize]);
    Some(kept)
}
