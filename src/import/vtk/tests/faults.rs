//! Messages about invalid files.

use super::*;

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
    assert_eq!(
        text("heat 1 4 float\n0.25 ", "heat 1 3 float\n"),
        "line 38: the data `heat` has 3 entries; it needs 4"
    );
    let normals =
        text("POINT_DATA 4\n", "POINT_DATA 5\nNORMALS m float\n1 2 3 4 5 6 7 8 9 10 11 12 13 14 15\n");
    assert_eq!(normals, "line 33: the normals `m` have 5 entries for 4 points");
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
        "line 20: in `Cells`, cell 0 has the type 66, which is not read; VTK's linear and quadratic cells are"
    );
    assert_eq!(text("\n10 ", "\n12 "), "line 20: in `Cells`, cell 0 of type 12 has 4 points; it needs 8");
    assert_eq!(
        text("NumberOfPoints=\"4\"", "NumberOfPoints=\"four\""),
        "line 6: expected a count in `NumberOfPoints`, found `four`"
    );
    assert_eq!(
        text("\"Points\" NumberOfComponents=\"3\"", "\"Points\" NumberOfComponents=\"2\""),
        "line 16: expected points of 3 components, found 2"
    );
    let unstated = file.replace("NumberOfPoints=\"4\" ", "").replace("0.1 ", "0.1 7 ");
    assert_eq!(fault(unstated), "line 16: the array `Points` has 13 numbers, not 3 for each point");
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
