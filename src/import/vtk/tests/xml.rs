//! Pieces of XML files.

use super::*;

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

/// A piece of a square with data of its points, and one without points.
#[test]
fn empty_pieces_change_nothing() {
    let array = |kind: &str, name: &str, components: usize, values: &str| {
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\">{values}</DataArray>"
        )
    };
    let cells = |lists: [&str; 3]| {
        let [corners, ends, types] = lists;
        array("Int32", "connectivity", 1, corners)
            + &array("Int32", "offsets", 1, ends)
            + &array("UInt8", "types", 1, types)
    };
    let square = format!(
        "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><PointData Normals=\"n\">{}{}</PointData><Points>{}</Points>\
         <Cells>{}</Cells></Piece>",
        array("Float32", "p", 1, "0 1 2 3"),
        array("Float32", "n", 3, "0 0 1 0 0 1 0 0 1 0 0 1"),
        array("Float32", "Points", 3, "0 0 0 1 0 0 1 1 0 0 1 0"),
        cells(["0 1 2 3", "4", "9"]),
    );
    let none = cells(["", "", ""]);
    let points = array("Float32", "Points", 3, "");
    let empty = [
        format!(
            "<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"><Points></Points><Cells>{none}</Cells></Piece>"
        ),
        format!(
            "<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"><Points>{points}</Points><Cells>{none}</Cells></Piece>"
        ),
        format!("<Piece><Points>{points}</Points><Cells>{none}</Cells></Piece>"),
    ];
    let file = |pieces: &str| {
        format!("<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid>{pieces}</UnstructuredGrid></VTKFile>")
    };
    let alone = good(file(&square).as_bytes());
    assert!(alone.normals.is_some());
    assert_eq!(values(&alone, "p", Centering::Points), [0.0, 1.0, 2.0, 3.0]);
    for empty in empty {
        for pieces in
            [format!("{square}{empty}"), format!("{empty}{square}"), format!("{square}{empty}{empty}")]
        {
            assert_eq!(good(file(&pieces).as_bytes()), alone, "{pieces}");
        }
    }
}

#[test]
fn a_byte_order_mark_is_skipped() {
    let file = xml(TEXT);
    assert_eq!(good(&[b"\xef\xbb\xbf", &file[..]].concat()), good(&file));
}
