//! Valid and invalid VTK files.

mod encoding;
mod faults;
mod legacy;
mod surface;
mod xml;

use super::{PartReader, read};
use crate::geometry::mesh::{Centering, MeshData, TriangleMesh};
use crate::testing::Random;
use encoding::{Encoding, TEXT, xml};

fn good(bytes: &[u8]) -> MeshData {
    read(bytes).unwrap_or_else(|error| panic!("{error}"))
}

fn fault(bytes: impl AsRef<[u8]>) -> String {
    read(bytes.as_ref()).and_then(TriangleMesh::new).expect_err("a fault").to_string()
}

fn values(parts: &MeshData, name: &str, centering: Centering) -> Vec<f64> {
    let array = parts.arrays.iter().find(|array| array.name == name && array.centering == centering);
    let array = array.unwrap_or_else(|| panic!("no data {name}"));
    (0..array.values.len()).map(|index| array.values.get(index)).collect()
}

/// Six times the volume inside of a closed mesh; positive if all triangles are seen from outside.
fn volume(parts: &MeshData) -> f64 {
    let of = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|vertex| parts.positions[vertex as usize]);
        a.dot(b.cross(c))
    };
    parts.triangles.iter().map(of).sum()
}

/// A legacy file, as text or binary: parts of text, and numbers of 4 bytes as floats or integers.
enum Part {
    Text(&'static str),
    Floats(&'static [f32]),
    Integers(&'static [i32]),
}

fn legacy(binary: bool, parts: &[Part]) -> Vec<u8> {
    let encoding = if binary { "BINARY" } else { "ASCII" };
    let mut file = format!("# vtk DataFile Version 3.0\nof a test\n{encoding}\n").into_bytes();
    for part in parts {
        match (part, binary) {
            (Part::Text(text), _) => file.extend(text.bytes()),
            (Part::Floats(list), true) => list.iter().for_each(|x| file.extend(x.to_be_bytes())),
            (Part::Integers(list), true) => list.iter().for_each(|x| file.extend(x.to_be_bytes())),
            (Part::Floats(list), false) => list.iter().for_each(|x| file.extend(format!("{x} ").bytes())),
            (Part::Integers(list), false) => list.iter().for_each(|x| file.extend(format!("{x}\n").bytes())),
        }
        file.push(b'\n');
    }
    file
}

const SQUARE: &[f32] = &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];

fn polygons() -> Vec<Part> {
    vec![
        Part::Text("DATASET POLYDATA\nPOINTS 4 float"),
        Part::Floats(SQUARE),
        Part::Text("METADATA\nINFORMATION 0\n\nPOLYGONS 2 9"),
        Part::Integers(&[4, 0, 1, 2, 3, 3, 0, 1, 3]),
        Part::Text("VERTICES 1 2"),
        Part::Integers(&[1, 3]),
        Part::Text("CELL_DATA 3\nSCALARS zone int\nLOOKUP_TABLE default"),
        Part::Integers(&[7, 8, 9]),
        Part::Text("POINT_DATA 4\nVECTORS flow%20speed float"),
        Part::Floats(&[3.0, 4.0, 0.0, 0.0, 0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.5]),
        Part::Text("NORMALS n float"),
        Part::Floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]),
        Part::Text("FIELD FieldData 1\nheat 1 4 float"),
        Part::Floats(&[0.25, 0.5, 0.75, 1.0]),
    ]
}

/// The file of a body of cells of all kinds in one: a hexahedron, a wedge and a pyramid on it, and two tetrahedra.
const BODY: &str = "DATASET UNSTRUCTURED_GRID\nPOINTS 15 double
0 0 0 1 0 0 1 1 0 0 1 0  0 0 1 1 0 1 1 1 1 0 1 1
0.5 0.5 2  2 0 0 2 0 1  9 9 9  0 -1 0  -1 0 0  0.25 0.25 0.25
CELLS 5 29\n8 0 1 2 3 4 5 6 7\n5 4 5 6 7 8\n6 1 2 9 5 6 10\n4 0 13 12 4\n1 14
CELL_TYPES 5\n12 14 13 10 1
CELL_DATA 5\nSCALARS part double 1\nLOOKUP_TABLE default\n1 2 3 4 5
POINT_DATA 15\nSCALARS height float\nLOOKUP_TABLE default\n0 0 0 0 1 1 1 1 2 0 1 9 0 0 0\n";

#[test]
fn damaged_files_do_not_panic() {
    let mut random = Random(6);
    let mut files = vec![legacy(false, &polygons()), legacy(true, &polygons()), xml(TEXT)];
    files.push(format!("# vtk DataFile Version 2.0\n\nASCII\n{BODY}").into_bytes());
    for compressor in ["", "vtkZLibDataCompressor", "vtkLZ4DataCompressor"] {
        for (format, base64) in [("binary", true), ("appended", false)] {
            files.push(xml(Encoding { format, base64, compressor, ..TEXT }));
        }
    }
    for file in files {
        for _ in 0..1000 {
            let mut bytes = file.clone();
            for _ in 0..3 {
                let at = (random.unit() * bytes.len() as f64) as usize;
                bytes[at] = (random.unit() * 256.0) as u8;
            }
            bytes.truncate((random.unit() * 2.0 * bytes.len() as f64) as usize);
            let _ = read(&bytes).and_then(TriangleMesh::new);
        }
    }
}
