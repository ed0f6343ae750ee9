//! Valid and invalid VTK files.

use super::read;
use crate::base::math::DVec3;
use crate::geometry::mesh::{ArrayKey, Centering, Component, MeshData, TriangleMesh};
use crate::testing::Random;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::io::Write;

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

#[test]
fn legacy_polygons_are_read_as_text_and_binary() {
    let parts = good(&legacy(false, &polygons()));
    assert_eq!(good(&legacy(true, &polygons())), parts);
    assert_eq!(parts.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 3]]);
    assert_eq!(values(&parts, "zone", Centering::Cells), [8.0, 8.0, 9.0], "vertices come before polygons");
    assert_eq!(values(&parts, "heat", Centering::Points), [0.25, 0.5, 0.75, 1.0]);
    assert_eq!(parts.normals.as_ref().map(|normals| normals.values()[3]), Some(glam::Vec3::Z));
    let mesh = TriangleMesh::new(parts).expect("a mesh");
    let name = "flow speed".to_owned();
    let key = ArrayKey { name, centering: None, component: Component::Whole };
    assert_eq!(mesh.array(&key).map(|array| array.value(0, key.component)), Some(5.0));
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

/// The encodings of arrays in XML files.
#[derive(Clone, Copy, Debug)]
struct Encoding {
    format: &'static str,
    base64: bool,
    compressor: &'static str,
    wide: bool,
    big: bool,
    /// Whether the header is encoded apart from the data.
    apart: bool,
}

impl Encoding {
    fn number(&self, value: u64) -> Vec<u8> {
        let mut bytes =
            if self.wide { value.to_le_bytes().to_vec() } else { (value as u32).to_le_bytes().to_vec() };
        if self.big {
            bytes.reverse();
        }
        bytes
    }

    /// An array with its header, not encoded yet: the header, and the data.
    fn payload(&self, data: &[u8]) -> [Vec<u8>; 2] {
        const BLOCK: usize = 16;
        if self.compressor.is_empty() {
            return [self.number(data.len() as u64), data.to_vec()];
        }
        let blocks: Vec<Vec<u8>> = data.chunks(BLOCK).map(|block| self.compressed(block)).collect();
        let numbers =
            [blocks.len(), BLOCK, data.len() % BLOCK].into_iter().chain(blocks.iter().map(Vec::len));
        [numbers.flat_map(|number| self.number(number as u64)).collect(), blocks.concat()]
    }

    fn compressed(&self, block: &[u8]) -> Vec<u8> {
        if self.compressor == "vtkLZ4DataCompressor" {
            return lz4_flex::block::compress(block);
        }
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
        encoder.write_all(block).expect("memory");
        encoder.finish().expect("memory")
    }

    fn bytes(&self, data: &[u8]) -> Vec<u8> {
        let [header, data] = self.payload(data);
        match (self.base64, self.apart) {
            (false, _) => [header, data].concat(),
            (true, true) => (STANDARD.encode(header) + &STANDARD.encode(data)).into_bytes(),
            (true, false) => STANDARD.encode([header, data].concat()).into_bytes(),
        }
    }
}

/// A tetrahedron of one cell in a `.vtu` file, with data.
fn xml(encoding: Encoding) -> Vec<u8> {
    let points: [f64; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.1];
    let heat: [f64; 4] = [0.5, 1.5, 2.5, -3.5];
    let mut appended = Vec::new();
    let mut array = |name: &str, kind: &str, components: usize, values: &[f64]| {
        let element =
            format!("<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\"");
        let mut data = Vec::new();
        for value in values {
            let mut bytes = match kind {
                "Float64" => value.to_le_bytes().to_vec(),
                "Float32" => (*value as f32).to_le_bytes().to_vec(),
                "Int64" => (*value as i64).to_le_bytes().to_vec(),
                _ => vec![*value as u8],
            };
            if encoding.big {
                bytes.reverse();
            }
            data.extend(bytes);
        }
        let content = match encoding.format {
            "ascii" => values.iter().map(|value| format!("{value} ")).collect(),
            "binary" => String::from_utf8(encoding.bytes(&data)).expect("base64"),
            _ => {
                let element = format!("{element} format=\"appended\" offset=\"{}\"/>", appended.len());
                appended.extend(encoding.bytes(&data));
                return element;
            }
        };
        format!("{element} format=\"{}\">\n{content}\n</DataArray>", encoding.format)
    };
    let body = [
        "<PointData Scalars=\"heat &amp; more\">".to_owned(),
        array("heat &amp; more", "Float32", 1, &heat),
        "</PointData><CellData>".to_owned(),
        array("v", "Float64", 3, &[1.0, 2.0, 2.0]),
        "</CellData><Points>".to_owned(),
        array("Points", "Float64", 3, &points),
        "</Points><Cells>".to_owned(),
        array("connectivity", "Int64", 1, &[0.0, 1.0, 2.0, 3.0]),
        array("offsets", "Int64", 1, &[4.0]),
        array("types", "UInt8", 1, &[10.0]),
        "</Cells>".to_owned(),
    ]
    .join("\n");
    let mut file = format!(
        "<?xml version=\"1.0\"?>\n<!-- of a test -->\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" \
         byte_order=\"{}Endian\" header_type=\"UInt{}\" compressor=\"{}\">\n<UnstructuredGrid>\n\
         <FieldData><DataArray type=\"String\" Name=\"s\" format=\"ascii\">1</DataArray></FieldData>\n\
         <Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">\n{body}\n</Piece>\n</UnstructuredGrid>\n",
        if encoding.big { "Big" } else { "Little" },
        if encoding.wide { 64 } else { 32 },
        encoding.compressor,
    )
    .into_bytes();
    if encoding.format == "appended" {
        let kind = if encoding.base64 { "base64" } else { "raw" };
        file.extend(format!("<AppendedData encoding=\"{kind}\">\n  _").bytes());
        file.extend(appended);
        file.extend(b"\n</AppendedData>\n");
    }
    file.extend(b"</VTKFile>\n");
    file
}

const TEXT: Encoding =
    Encoding { format: "ascii", base64: false, compressor: "", wide: false, big: false, apart: false };

#[test]
fn xml_files_are_read_in_every_encoding() {
    let expected = good(&xml(TEXT));
    assert_eq!((expected.triangles.len(), volume(&expected)), (4, 0.1));
    assert_eq!(values(&expected, "heat & more", Centering::Points), [0.5, 1.5, 2.5, -3.5]);
    assert_eq!(values(&expected, "v", Centering::Cells), [[1.0, 2.0, 2.0]; 4].concat());
    for (format, base64) in [("binary", true), ("appended", true), ("appended", false)] {
        for compressor in ["", "vtkZLibDataCompressor", "vtkLZ4DataCompressor"] {
            for bits in 0..8 {
                let (wide, big, apart) = (bits & 1 > 0, bits & 2 > 0, bits & 4 > 0);
                let encoding = Encoding { format, base64, compressor, wide, big, apart };
                assert_eq!(good(&xml(encoding)), expected, "{encoding:?}");
            }
        }
    }
}

#[test]
fn polygons_of_several_pieces_are_one_mesh() {
    let piece = |x: i32| {
        format!(
            "<Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\" NumberOfVerts=\"1\"><PointData Normals=\"n\">\
             <DataArray type=\"Float32\" Name=\"n\" NumberOfComponents=\"3\">0 0 1 0 0 1 0 0 1</DataArray>\
             <DataArray type=\"Int32\" Name=\"x\">{x} {x} {x}</DataArray></PointData>\
             <CellData><DataArray type=\"Int32\" Name=\"id\">5 {x}</DataArray></CellData>\
             <Points><DataArray type=\"Float32\" NumberOfComponents=\"3\">{x} 0 0 {x} 1 0 {x} 0 1</DataArray></Points>\
             <Verts><DataArray type=\"Int32\" Name=\"connectivity\">0</DataArray>\
             <DataArray type=\"Int32\" Name=\"offsets\">1</DataArray></Verts>\
             <Polys><DataArray type=\"Int32\" Name=\"connectivity\">0 1 2</DataArray>\
             <DataArray type=\"Int32\" Name=\"offsets\">3</DataArray></Polys></Piece>"
        )
    };
    let file = format!("<VTKFile type=\"PolyData\"><PolyData>{}{}</PolyData></VTKFile>", piece(1), piece(2));
    let parts = good(file.as_bytes());
    assert_eq!(parts.triangles, [[0, 1, 2], [3, 4, 5]]);
    assert_eq!(values(&parts, "id", Centering::Cells), [1.0, 2.0]);
    assert_eq!(values(&parts, "x", Centering::Points), [1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
    assert!(parts.normals.is_some());
}

#[test]
fn faults_name_their_place() {
    let text = |from: &str, to: &str| {
        let file = String::from_utf8(legacy(false, &polygons())).expect("text");
        assert!(file.contains(from), "{from}");
        fault(file.replacen(from, to, 1))
    };
    assert_eq!(
        fault("solid"),
        "line 1: it is no legacy VTK file: its first line is not like `# vtk DataFile Version 3.0`"
    );
    assert_eq!(text("ASCII", "TEXT"), "line 3: expected `ASCII` or `BINARY`, found `TEXT`");
    assert_eq!(
        text("POLYDATA", "STRUCTURED_POINTS"),
        "line 4: expected `DATASET POLYDATA`, `UNSTRUCTURED_GRID` or `STRUCTURED_GRID`, found `DATASET STRUCTURED_POINTS`"
    );
    assert_eq!(text("4 float", "4 real"), "line 5: expected a type such as `float`, found `real`");
    assert_eq!(text("0 0 0 1", "0 zero 0 1"), "line 6: expected number 2 of 12 of `POINTS`, found `zero`");
    assert!(
        text("POINTS 4", "POINTS 4000000000000")
            .contains("line 5: 12,000,000,000,000 numbers of `POINTS` do not fit")
    );
    assert_eq!(
        text("4\n0\n1\n2\n3", "4\n0\n1\n2\n4"),
        "line 19: in `POLYGONS`, cell 0 has the point 4; the file has 4, numbered from 0"
    );
    assert!(text("CELL_DATA 3", "CELL_DATA 2").contains("expected"));
    assert_eq!(
        text("heat 1 4", "heat 1 3"),
        "line 39: expected data such as `SCALARS`, `VECTORS` or `FIELD`, found `0.25 0.5 0.75 1`"
    );
    let binary = legacy(true, &polygons());
    assert!(
        fault(&binary[..90]).starts_with("byte 61: 12 numbers of `POINTS` do not fit"),
        "{}",
        fault(&binary[..90])
    );
}

#[test]
fn faults_of_xml_name_their_line() {
    let file = String::from_utf8(xml(TEXT)).expect("text");
    let text = |from: &str, to: &str| {
        assert!(file.contains(from), "{from}");
        fault(file.replacen(from, to, 1))
    };
    assert_eq!(
        text("UnstructuredGrid\" v", "ImageData\" v"),
        "line 3: expected `type=\"PolyData\"` or `\"UnstructuredGrid\"`, found `ImageData`"
    );
    assert_eq!(
        text("LittleEndian", "Little"),
        "line 3: expected `byte_order=\"LittleEndian\"` or `\"BigEndian\"`, found `Little`"
    );
    assert_eq!(
        text("compressor=\"\"", "compressor=\"vtkLZMADataCompressor\""),
        "line 3: expected the compressor `vtkZLibDataCompressor` or `vtkLZ4DataCompressor`, found `vtkLZMADataCompressor`"
    );
    assert_eq!(text("0.5 1.5", "0.5 ?"), "line 9: expected a number of the array `heat & more`, found `?`");
    assert_eq!(text("0.5 1.5", "0.5"), "line 8: the array `heat & more` has 3 numbers; it needs 4 times 1");
    assert_eq!(
        text("NumberOfPoints=\"4\"", "NumberOfPoints=\"5\""),
        "line 16: `NumberOfPoints` is 5, but the array `Points` has 12 numbers, 3 each"
    );
    assert_eq!(
        text("0 1 2 3 ", "0 1 2 9 "),
        "line 20: in `Cells`, cell 0 has the point 9; the file has 4, numbered from 0"
    );
    assert_eq!(
        text("\n10 ", "\n66 "),
        "cell 0 has the type 66, which is not read; VTK's linear and quadratic cells are"
    );
    assert_eq!(text("\n10 ", "\n12 "), "cell 0 of type 12 has 4 points; it needs 8");
    assert!(
        text("</PointData>", "</Points>").starts_with("line 11: it is no valid XML"),
        "{}",
        text("</PointData>", "</Points>")
    );
    assert_eq!(fault("<html></html>"), "line 1: expected the element `VTKFile`, found `html`");
    assert_eq!(
        fault(&file[..file.find("</CellData>").expect("it")]),
        "line 15: the file ends in the element `CellData`"
    );
}

/// What a header states is checked before memory is taken.
#[test]
fn stated_sizes_are_bounded_by_the_file() {
    for (compressor, expected) in [
        ("", "its header states 18,446,744,073,709,551,615 bytes"),
        ("vtkZLibDataCompressor", "cannot hold the stated"),
        ("vtkLZ4DataCompressor", "cannot hold the stated"),
    ] {
        let encoding =
            Encoding { format: "appended", base64: false, compressor, wide: true, big: false, apart: false };
        let mut file = xml(encoding);
        let begin = file.windows(2).rposition(|pair| pair == b" _").expect("data") + 2;
        // The size of the array, or that of its blocks.
        let at = if compressor.is_empty() { begin } else { begin + 8 };
        file[at..at + 8].copy_from_slice(&[0xff; 8]);
        let found = fault(&file);
        assert!(
            found.contains(expected) && found.starts_with(&format!("byte {begin}: in the array")),
            "{found}"
        );
    }
}

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
