//! Valid and invalid OBJ files.

use super::*;
use crate::geometry::mesh::NO_MATERIAL;

const MTL: &[u8] = b"newmtl red\nKd 1 0 0\nnewmtl blue sky\nKd 0 0 1\n";

fn open(name: &str) -> io::Result<Vec<u8>> {
    match name {
        "a.mtl" | "my scene.mtl" => Ok(MTL.to_vec()),
        "broken.mtl" => Ok(b"newmtl a\nKd red\n".to_vec()),
        _ => Err(io::ErrorKind::NotFound.into()),
    }
}

fn good(text: &str) -> MeshData {
    read(text.as_bytes(), &open).unwrap_or_else(|error| panic!("{error}"))
}

fn fault(text: &str) -> String {
    read(text.as_bytes(), &open).expect_err(text).to_string()
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn polygons_are_split_into_fans() {
    let parts = good(&format!("{SQUARE}f 1 2 3 4\nf 1 2 3"));
    assert_eq!(parts.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
    assert_eq!(parts.positions[2], DVec3::new(1.0, 1.0, 0.0));
    assert!(
        parts.normals.is_none() && parts.uvs.is_none() && parts.colors.is_empty() && parts.slots.is_empty()
    );
}

#[test]
fn files_of_all_styles_are_read() {
    let text = "# a comment\r\no thing\r\ng one two\r\ns off\r\nv 0.1 1e-3 -2 # first\r\n\tv 1 0 0 1.0\r\n\
                v 0 \\\r\n 1 0\r\n\r\nl 1 2\r\np 1\r\nvp 0.5\r\nf  -3\t-2 -1";
    let parts = good(text);
    assert_eq!(parts.positions, [DVec3::new(0.1, 1e-3, -2.0), DVec3::X, DVec3::Y]);
    assert_eq!(parts.triangles, [[0, 1, 2]]);
}

#[test]
fn every_stream_has_its_own_indices() {
    let text = format!(
        "{SQUARE}vt 0 0\nvt 1 0 0\nvt 0.5\nvn 0 0 1\nf 1/3/1 2/2/1 3/1/1\nf 1//1 2//1 3//1\nf 1/1 2/2 3/3\n\
         f -4/-3/-1 -3/-2/-1 -2/-1/-1"
    );
    let parts = good(&text);
    let (uvs, normals) = (parts.uvs.expect("uvs"), parts.normals.expect("normals"));
    let at = |part| uvs.at(part, &parts.triangles);
    assert_eq!(at(0), Some([DVec2::new(0.5, 0.0), DVec2::X, DVec2::ZERO]));
    assert_eq!(at(1), None);
    assert_eq!((at(2), at(3)), (Some([DVec2::ZERO, DVec2::X, DVec2::new(0.5, 0.0)]), at(2)));
    let with = [0, 1, 2, 3].map(|part| normals.at(part, &parts.triangles).is_some());
    assert_eq!(with, [true, true, false, true]);
}

#[test]
fn equal_indices_are_kept_once() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1\n";
    let parts = good(text);
    assert!(parts.uvs.expect("uvs").is_per_vertex() && !parts.normals.expect("normals").is_per_vertex());
}

#[test]
fn entries_may_follow_the_faces() {
    assert_eq!(good("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0").triangles, [[0, 1, 2]]);
}

#[test]
fn vertices_have_colours() {
    let parts = good("v 0 0 0\nv 1 0 0 1 0.5 0\nv 0 1 0\nf 1 2 3");
    assert_eq!(parts.colors, [Rgb::ONE, Rgb::new(1.0, 0.5, 0.0), Rgb::ONE]);
}

#[test]
fn materials_have_slots() {
    let text = format!(
        "mtllib a.mtl\n{SQUARE}f 1 2 3\nusemtl blue sky\nf 1 2 3 4\nusemtl red\nf 1 2 3\nusemtl blue sky\nf 1 2 3"
    );
    let parts = good(&text);
    assert_eq!(parts.slots, [NO_MATERIAL, 0, 0, 1, 0]);
    let named: Vec<_> = parts.materials.iter().map(|m| (m.name.as_str(), m.diffuse)).collect();
    assert_eq!(named, [("blue sky", Some(Rgb::Z)), ("red", Some(Rgb::X))]);
    let without = good(&format!("{SQUARE}usemtl any\nf 1 2 3"));
    assert_eq!((without.slots, without.materials[0].name.as_str()), (vec![0], "any"));
    assert_eq!(good(&format!("mtllib my scene.mtl\n{SQUARE}usemtl red\nf 1 2 3")).materials.len(), 1);
}

#[test]
fn the_first_material_of_a_name_wins() {
    let open = |name: &str| match name {
        "twice.mtl" => Ok(b"newmtl a\nKd 1 0 0\nnewmtl a\nKd 0 1 0\n".to_vec()),
        "later.mtl" => Ok(b"newmtl a\nKd 0 0 1\n".to_vec()),
        // The error of a disk for several names that are taken for one.
        _ => Err(io::ErrorKind::InvalidFilename.into()),
    };
    let text = format!("mtllib twice.mtl later.mtl\n{SQUARE}usemtl a\nf 1 2 3");
    let parts = read(text.as_bytes(), &open).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(parts.materials[0].diffuse, Some(Rgb::X));
}

#[test]
fn materials_name_missing_libraries() {
    for (library, uses, expected) in [
        ("\nmtllib none.mtl", "", ""),
        ("\nmtllib none.mtl", "usemtl any", "any"),
        ("mtllib a.mtl\nmtllib a.mtl none.mtl", "usemtl red", "red"),
    ] {
        let [material] = &good(&format!("{library}\n{SQUARE}{uses}\nf 1 2 3")).materials[..] else {
            panic!("one material")
        };
        assert_eq!(material.name, expected);
        assert_eq!(
            material.missing.as_deref(),
            Some("line 2: there is no file `none.mtl` for the materials"),
            "{library}"
        );
    }
}

#[test]
fn faults_name_the_line() {
    for (text, expected) in [
        ("v 0 0", "line 1: expected three numbers after `v`, found `v 0 0`"),
        ("v 0 0 zero", "line 1: expected three numbers after `v`, found `v 0 0 zero`"),
        (
            "v 0 0 0 -1 0 0",
            "line 1: expected colours of 0 or more after the coordinates, found `v 0 0 0 -1 0 0`",
        ),
        ("vt nan 0", "line 1: expected two finite numbers after `vt`, found `vt nan 0`"),
        ("vn 0 1", "line 1: expected three numbers after `vn`, found `vn 0 1`"),
        ("\nf 1 2", "line 2: expected a face of 3 corners or more, found `f 1 2`"),
        ("f", "line 1: expected a face of 3 corners or more, found `f`"),
        ("f 1 2 x", "line 1: expected the number of a vertex, found `x` in `f 1 2 x`"),
        ("f 0 1 2", "line 1: 0 is not a vertex; indices count from 1 in `f 0 1 2`"),
        (
            "f 1/2/3/4 2 3",
            "line 1: `1/2/3/4` is not a corner; write v, v/vt, v//vn or v/vt/vn in `f 1/2/3/4 2 3`",
        ),
        (
            "v 0 0 0\nf -1 -2 -1",
            "line 2: there is no vertex `-2` yet; the lines above define 1 in `f -1 -2 -1`",
        ),
        ("v 0 0 0\nf 1 1 1\nf 1 2 9", "line 3: there is no vertex 9; the file has 1"),
        ("v 0 0 0\nf 1/1 1/1 1/1", "line 2: there is no texture coordinate (vt) 1; the file has 0"),
        ("v 0 0 0\nf 1//2 1//2 1//2", "line 2: there is no normal (vn) 2; the file has 0"),
        ("f 1 2 99999999999", "line 1: there is no vertex `99999999999` in `f 1 2 99999999999`"),
        (
            "mtllib broken.mtl",
            "broken.mtl, line 2: expected three finite numbers, red, green and blue, found `Kd red`",
        ),
        ("mtllib a.mtl\nusemtl green", "line 2: no material library defines `green`"),
        ("usemtl", "line 1: expected a name after `usemtl`, found `usemtl`"),
    ] {
        assert_eq!(fault(text), expected);
    }
}

/// INT-15 (d).
#[test]
fn int_15_vertices_with_invalid_coordinates_are_refused_with_their_face() {
    let why = "coordinates are finite and at most 1e30";
    assert_eq!(
        fault("v 0 0 0\nv 1 nan 0\nv 0 1 0\nv 0 1 0\nf 1 3 4\nf 1 2 3\n"),
        format!("line 2: the vertex has y = NaN, and face 1 uses it; {why}")
    );
    assert_eq!(fault("v inf 0 0"), format!("line 1: the vertex has x = inf; {why}"));
    assert_eq!(fault("v 0 0 1e31"), format!("line 1: the vertex has z = {}; {why}", 1e31));
}

#[test]
fn damaged_files_do_not_panic() {
    let mut random = crate::testing::Random(11);
    let text =
        format!("{SQUARE}vt 0 0\nvn 0 0 1\nmtllib a.mtl\nusemtl red\nf 1/1/1 2/1/1 3/1/1\nf -1 -2 -3\n");
    for _ in 0..2000 {
        let mut bytes = text.clone().into_bytes();
        for _ in 0..3 {
            let at = (random.unit() * bytes.len() as f64) as usize;
            bytes[at] = (random.unit() * 256.0) as u8;
        }
        if let Ok(parts) = read(&bytes[..], &open) {
            let _ = crate::geometry::mesh::TriangleMesh::new(parts);
        }
    }
    assert_eq!(good("").triangles.len(), 0);
}
