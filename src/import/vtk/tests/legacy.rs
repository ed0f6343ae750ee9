//! Legacy files.

use super::*;
use crate::geometry::mesh::ArrayKey;

#[test]
fn legacy_polygons_are_read_as_text_and_binary() {
    let parts = good(&legacy(false, &polygons()));
    assert_eq!(good(&legacy(true, &polygons())), parts);
    assert_eq!(parts.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 3]]);
    assert_eq!(values(&parts, "zone", Centering::Cells), [8.0, 8.0, 9.0], "vertices come before polygons");
    assert_eq!(values(&parts, "heat", Centering::Points), [0.25, 0.5, 0.75, 1.0]);
    assert_eq!(parts.normals.as_ref().map(|normals| normals.values()[3]), Some(glam::Vec3::Z));
    let mesh = TriangleMesh::new(parts).expect("a mesh");
    let key = ArrayKey::whole("flow speed".to_owned());
    assert_eq!(mesh.array(&key).map(|array| array.value(0, key.component)), Some(5.0));
}

/// VTK writes `vtkIdType` as 4 bytes and `vtktypeint64` as 8.
#[test]
fn binary_indices_have_the_size_of_their_type() {
    for (name, size) in [("vtkIdType", 4), ("vtktypeint64", 8), ("int", 4), ("long", 8)] {
        let number = |value: i64| value.to_be_bytes()[8 - size..].to_vec();
        let mut file = legacy(true, &polygons()[..2]);
        file.extend(format!("POLYGONS 3 6\nOFFSETS {name}\n").bytes());
        file.extend([0, 3, 6].into_iter().flat_map(number));
        file.extend(format!("\nCONNECTIVITY {name}\n").bytes());
        file.extend([0, 1, 2, 0, 2, 3].into_iter().flat_map(number));
        file.extend(format!("\nCELL_DATA 2\nSCALARS id {name}\nLOOKUP_TABLE default\n").bytes());
        file.extend([70_000, -2].into_iter().flat_map(number));
        let parts = good(&file);
        assert_eq!(parts.triangles, [[0, 1, 2], [0, 2, 3]], "{name}");
        assert_eq!(values(&parts, "id", Centering::Cells), [70_000.0, -2.0], "{name}");
    }
}

#[test]
fn texts_are_skipped_and_edge_flags_read() {
    let head = "POLYGONS 1 5\n";
    let mut text = legacy(false, &polygons()[..2]);
    text.extend(
        format!("{head}4 0 1 2 3\nCELL_DATA 1\nFIELD FieldData 2\nname 1 2 string\nhello\nyou%20there\n")
            .bytes(),
    );
    text.extend(b"METADATA\nINFORMATION 0\n\nheat 1 1 float\n7\nPOINT_DATA 4\nEDGE_FLAGS e int\n0 1 0 1\n");
    let mut binary = legacy(true, &polygons()[..2]);
    binary.extend(head.bytes());
    binary.extend([4, 0, 1, 2, 3].into_iter().flat_map(i32::to_be_bytes));
    binary.extend(b"\nCELL_DATA 1\nFIELD FieldData 2\nname 1 4 string\n");
    // Lengths of one, two, four and eight bytes.
    binary.extend(b"\xc5hello\x80\x03you\x40\x00\x00\x02at\x00\x00\x00\x00\x00\x00\x00\x01!");
    binary.extend(b"\nheat 1 1 float\n");
    binary.extend(7_f32.to_be_bytes());
    binary.extend(b"\nPOINT_DATA 4\nEDGE_FLAGS e int\n");
    binary.extend([0, 1, 0, 1].into_iter().flat_map(i32::to_be_bytes));
    for file in [text, binary] {
        let parts = good(&file);
        assert_eq!(values(&parts, "heat", Centering::Cells), [7.0, 7.0]);
        assert_eq!(values(&parts, "e", Centering::Points), [0.0, 1.0, 0.0, 1.0]);
    }
}
