//! Valid and invalid PLY files.

use super::header::Header;
use super::read::memory;
use super::*;
use crate::base::color::{Rgb, srgb_to_linear};
use crate::base::math::{DVec2, DVec3};
use crate::geometry::mesh::{
    ArrayKey, ArrayValues, Centering, Component, Corners, MeshData, MeshError, TriangleMesh, generate,
};
use crate::import::lines::Lines;
use crate::import::obj;
use crate::testing::Random;
use glam::Vec3;

fn good(bytes: &[u8]) -> MeshData {
    read(bytes).unwrap_or_else(|error| panic!("{error}"))
}

fn fault(bytes: &[u8]) -> String {
    read(bytes).expect_err("a fault").to_string()
}

/// A header with all properties that are read, and some in between that are not.
fn header(format: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment made by hand\nobj_info 1\nelement vertex 4\nproperty float x\n\
         property float y\nproperty double z\nproperty uchar alpha\nproperty uchar red\nproperty uchar green\n\
         property uchar blue\nproperty float nx\nproperty float ny\nproperty float nz\nproperty float s\n\
         property float t\nproperty list short int16 bones\nelement edge 1\nproperty int a\n\
         property list uchar float weights\nelement face 2\nproperty ushort flags\n\
         property list uchar int vertex_indices\nend_header\n"
    )
}

const VERTICES: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.1], [0.0, 1.0]];

fn text_file() -> String {
    let mut text = header("ascii");
    for [x, y] in VERTICES {
        text += &format!("{x} {y} 0.1 9 255 0 128 0 0 1 {x} {y} 2 7 8\n");
    }
    text + "5 2 0.5 0.5\n1 4 0 1 2 3\n\n1 3 0 1 2\n"
}

fn binary_file(big: bool) -> Vec<u8> {
    let mut bytes = header(if big { "binary_big_endian" } else { "binary_little_endian" }).into_bytes();
    let mut push = |value: &[u8]| match big {
        true => bytes.extend(value.iter().rev()),
        false => bytes.extend(value),
    };
    for [x, y] in VERTICES.map(|xy| xy.map(|v| v as f32)) {
        [x, y].iter().for_each(|v| push(&v.to_le_bytes()));
        push(&0.1_f64.to_le_bytes());
        [9, 255, 0, 128].iter().for_each(|v: &u8| push(&v.to_le_bytes()));
        [0.0, 0.0, 1.0, x, y].iter().for_each(|v| push(&v.to_le_bytes()));
        [2_i16, 7, 8].iter().for_each(|v| push(&v.to_le_bytes()));
    }
    push(&5_i32.to_le_bytes());
    push(&[2]);
    [0.5_f32; 2].iter().for_each(|v| push(&v.to_le_bytes()));
    for corners in [&[0_i32, 1, 2, 3][..], &[0, 1, 2]] {
        push(&1_u16.to_le_bytes());
        push(&[corners.len() as u8]);
        corners.iter().for_each(|v| push(&v.to_le_bytes()));
    }
    bytes
}

#[test]
fn all_formats_give_the_same_mesh() {
    let parts = good(text_file().as_bytes());
    assert_eq!(parts.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
    let float = |v: f64| f64::from(v as f32);
    assert_eq!(parts.positions[2], DVec3::new(1.0, float(0.1), 0.1));
    assert_eq!(parts.normals, Some(Corners::per_vertex(vec![Vec3::Z; 4])));
    let uvs = VERTICES.map(|xy| DVec2::from_array(xy.map(float))).to_vec();
    assert_eq!(parts.uvs, Some(Corners::per_vertex(uvs)));
    let half = srgb_to_linear(128.0 / 255.0) as f32;
    assert_eq!(parts.colors, [Rgb::new(1.0, 0.0, half); 4]);
    assert_eq!(good(&binary_file(false)), parts);
    assert_eq!(good(&binary_file(true)), parts);
    assert_eq!(good(text_file().replace('\n', "\r\n").as_bytes()), parts);
    assert_eq!(good(text_file().trim_end().as_bytes()), parts);
}

fn small(vertices: &str, faces: &str) -> String {
    let count = |lines: &str| lines.lines().count();
    format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_index\nend_header\n{vertices}\n{faces}",
        count(vertices),
        count(faces)
    )
}

const CORNERS: &str = "0 0 0\n1 0 0\n0 1 0";

#[test]
fn faults_name_their_place() {
    for (text, expected) in [
        (small(CORNERS, "3 0 1 3"), "line 13: there is no vertex 3; the file has 3, numbered from 0"),
        (small(CORNERS, "3 0 1 -1"), "line 13: there is no vertex -1; the file has 3, numbered from 0"),
        (small(CORNERS, "2 0 1"), "line 13: expected a face of 3 corners or more, found 2"),
        (small(CORNERS, "3 0 1"), "line 13: the line ends too early: `3 0 1`"),
        (small(CORNERS, "3 0 1 2 5"), "line 13: the line should end before `5`"),
        (small(CORNERS, "3 0 1 2.5"), "line 13: expected a whole number, found `2.5`"),
        (small("0 0 0\n1 0 x\n0 1 0", "3 0 1 2"), "line 11: expected a number, found `x`"),
        (small("0 0 0\n1 0", "3 0 1 1"), "line 11: the line ends too early: `1 0`"),
        (
            small("0 0 0\n1 nan 0\n0 1 0", "3 0 1 2"),
            "line 11: the vertex has y = NaN, and face 0 uses it; coordinates are finite and at most 1e30",
        ),
        (small(CORNERS, "3 0 1 2").replace("face 1", "face 2"), "the file ends in face 1 of 2"),
        ("OFF\n".to_owned(), "it is not a PLY file: its first line is not `ply`"),
        (String::new(), "it is not a PLY file: its first line is not `ply`"),
        ("ply\nformat ascii 1.0\n".to_owned(), "the header has no line `end_header`"),
        (
            "ply\nformat base64 1.0\n".to_owned(),
            "line 2: expected `format ascii`, `format binary_little_endian` or \
          `format binary_big_endian`, found `format base64 1.0`",
        ),
        (
            "ply\nelement vertex\n".to_owned(),
            "line 2: expected `element`, a name and a count, found `element vertex`",
        ),
        (
            "ply\nproperty float x\n".to_owned(),
            "line 2: expected `element` before its properties, found `property float x`",
        ),
        (
            "ply\nend_header\n".to_owned(),
            "line 2: the header has no line `format`, such as `format ascii 1.0`",
        ),
        ("ply\nformat ascii 1.0\nend_header\n".to_owned(), "it has no `element vertex`"),
        (
            small(CORNERS, "3 0 1 2").replace("vertex 3", "vertex 999999999999"),
            "it has 999,999,999,999 vertices; the maximum is 4,294,967,294",
        ),
        (
            small(CORNERS, "3 0 1 2").replace("float y", "float w"),
            "its vertex lacks x, y and z; it has `x`, `w`, `z`",
        ),
        (
            small(CORNERS, "3 0 1 2").replace("_index", "s"),
            "its face lacks the list `vertex_indices`; it has `vertexs`",
        ),
        (
            small(CORNERS, "3 0 1 2").replace("face", "tristrips"),
            "it has no `element face`; other faces, such as strips, are not read",
        ),
    ] {
        assert_eq!(fault(text.as_bytes()), expected, "{text}");
    }
}

#[test]
fn binary_files_name_elements() {
    let bytes = binary_file(false);
    let len = bytes.len();
    assert_eq!(fault(&bytes[..len - 1]), "the file ends in face 1 of 2");
    assert_eq!(fault(&bytes[..header("binary_little_endian").len() + 3]), "the file ends in vertex 0 of 4");
    let mut wrong = bytes;
    wrong[len - 4..].copy_from_slice(&4_i32.to_le_bytes());
    assert_eq!(fault(&wrong), "face 1: there is no vertex 4; the file has 4, numbered from 0");
    let mut invalid = binary_file(false);
    let first = header("binary_little_endian").len();
    invalid[first..first + 4].copy_from_slice(&f32::INFINITY.to_le_bytes());
    let why = "the vertex has x = inf, and face 0 uses it; coordinates are finite and at most 1e30";
    assert_eq!(fault(&invalid), format!("vertex 0: {why}"));
}

#[test]
fn files_that_are_too_short_for_their_header_are_refused() {
    for format in ["ascii", "binary_little_endian"] {
        let text = small(CORNERS, "3 0 1 2").replace("ascii", format).replace("face 1", "face 4000000000");
        let least = if format == "ascii" { "8,000,000,017" } else { "4,000,000,036" };
        let fault = read_sized(text.as_bytes(), text.len() as u64).expect_err("too short").to_string();
        let has = text.len();
        assert_eq!(
            fault,
            format!("the file is too short: it has {has} bytes, but its header requires at least {least}")
        );
    }
    for file in [text_file().trim_end().as_bytes(), &binary_file(false)] {
        assert!(read_sized(file, file.len() as u64).is_ok());
    }
    let tight = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2";
    let header =
        Header::read(&mut Lines::new(small(CORNERS, "3 0 1 2").as_bytes(), false)).expect("a header");
    assert!(header.least_size() <= tight.len() as u128);
}

#[test]
fn absurd_counts_end_with_the_file() {
    let text = small(CORNERS, "3 0 1 2")
        .replace("vertex 3", "vertex 4000000000")
        .replace("ascii", "binary_little_endian");
    assert!(fault(text.as_bytes()).starts_with("the file ends in vertex "));
    let text = "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
                property float z\nelement empty 18446744073709551615\nelement face 1\n\
                property list uchar int vertex_index\nend_header\n";
    assert_eq!(fault(&[text.as_bytes(), &[0; 36]].concat()), "its `element empty` has no properties");
}

/// Records that fill several blocks of a file. Some have lists, and one is larger than a block. Returns the vertices
/// as bytes and as text, and the corners of the faces.
fn many_records() -> (Vec<u8>, String, Vec<Vec<u32>>) {
    const VERTICES: u32 = 60_000;
    let (mut bytes, mut text) = (Vec::new(), String::new());
    for vertex in 0..VERTICES {
        let [x, y, z] = [vertex % 251, vertex % 13, vertex / 7].map(|v| v as f32 * 0.5);
        let bones = &[1_u8, 2, 3][..vertex as usize % 4 % 3];
        [x, y].iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        bytes.extend([&[bones.len() as u8], bones].concat());
        bytes.extend(z.to_le_bytes());
        text += &format!("{x} {y} {}", bones.len());
        bones.iter().for_each(|bone| text += &format!(" {bone}"));
        text += &format!(" {z}\n");
    }
    let corners = |face: u32| match face {
        70_000 => 500_000,
        _ => 3 + face % 3,
    };
    let faces = (0..90_000)
        .map(|face| (0..corners(face)).map(|i| face.wrapping_add(i.wrapping_mul(i)) % VERTICES).collect());
    (bytes, text, faces.collect())
}

fn many_header(format: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\nelement vertex 60000\nproperty float x\nproperty float y\n\
         property list uchar uchar bones\nproperty float z\nelement face 90000\n\
         property list int int vertex_indices\nend_header\n"
    )
}

#[test]
fn blocks_do_not_show() {
    let (vertices, lines, faces) = many_records();
    let mut text = many_header("ascii") + &lines;
    for face in &faces {
        let corners: String = face.iter().map(|corner| format!(" {corner}")).collect();
        text += &format!("{}{corners}\n", face.len());
    }
    let binary = |faces: &[Vec<u32>]| {
        let mut bytes = [many_header("binary_little_endian").as_bytes(), &vertices].concat();
        for face in faces {
            bytes.extend((face.len() as u32).to_le_bytes());
            face.iter().for_each(|corner| bytes.extend(corner.to_le_bytes()));
        }
        bytes
    };
    let whole = binary(&faces);
    assert_eq!(good(&whole), good(text.as_bytes()));

    // The first of several errors is reported, wherever the others are, and also if the file is truncated after it.
    let mut wrong = faces;
    for face in [89_999, 40_000, 30_000] {
        wrong[face][1] = 60_000 + face as u32;
        let why =
            format!("face {face}: there is no vertex {}; the file has 60000, numbered from 0", 60_000 + face);
        assert_eq!(fault(&binary(&wrong)), why);
    }
    let last = binary(&wrong[..30_001]);
    assert_eq!(fault(&last[..last.len() - 4]), fault(&last));
    assert_eq!(fault(&whole[..whole.len() - 1]), "the file ends in face 89999 of 90000");
    assert_eq!(fault(&whole[..whole.len() - 1_000_000]), "the file ends in face 70000 of 90000");
    let begin = many_header("binary_little_endian").len();
    assert_eq!(fault(&whole[..begin + vertices.len() - 1]), "the file ends in vertex 59999 of 60000");
    let mut invalid = whole;
    let at = begin + vertices.len() - 4;
    invalid[at..at + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    assert!(fault(&invalid).starts_with("vertex 59999: the vertex has z = NaN, and face "));
}

/// Vertices of floats, and faces of one list. Little-endian records are read at once, big-endian ones number by
/// number.
fn plain_file(big: bool, [count, item]: [&str; 2], faces: &[Vec<i64>]) -> Vec<u8> {
    let (endian, vertices) = (if big { "big" } else { "little" }, 5);
    let mut bytes = format!(
        "ply\nformat binary_{endian}_endian 1.0\nelement vertex {vertices}\nproperty float z\nproperty float x\n\
         property float y\nproperty float t\nproperty float s\nelement face {}\n\
         property list {count} {item} vertex_indices\nend_header\n",
        faces.len()
    )
    .into_bytes();
    let mut push = |value: &[u8]| match big {
        true => bytes.extend(value.iter().rev()),
        false => bytes.extend(value),
    };
    (0..5 * vertices).for_each(|k| push(&(0.1 * k as f32).to_le_bytes()));
    for face in faces {
        push(&[face.len() as u8]);
        face.iter().for_each(|corner| push(&(*corner as u32).to_le_bytes()));
    }
    bytes
}

#[test]
fn records_read_at_once_equal_those_read_by_number() {
    let right = vec![vec![0, 1, 2], vec![4, 3, 2, 1], vec![2, 3, 4]];
    let parts = good(&plain_file(false, ["uchar", "uint"], &right));
    assert_eq!(parts.triangles, [[0, 1, 2], [4, 3, 2], [4, 2, 1], [2, 3, 4]]);
    let [z, x, y, t, s] = [5.0_f32, 6.0, 7.0, 8.0, 9.0].map(|k| f64::from(0.1 * k));
    assert_eq!(parts.positions[1], DVec3::new(x, y, z));
    assert_eq!(parts.uvs.map(|uvs| uvs.values()[1]), Some(DVec2::new(s, t)));
    for types in [["uchar", "uint"], ["uchar", "int"], ["char", "int"]] {
        for (face, corner, wrong) in [(0, 0, 0), (2, 2, 5), (0, 1, -1), (2, 0, 1 << 31), (1, 3, 1 << 20)] {
            let mut faces = right.clone();
            faces[face][corner] = wrong;
            let [little, big] = [false, true].map(|big| plain_file(big, types, &faces));
            for cut in 0..45 {
                let [little, big] = [&little, &big].map(|bytes| read(&bytes[..bytes.len() - cut]));
                let message = |read: Result<MeshData, MeshError>| read.map_err(|error| error.to_string());
                assert_eq!(
                    message(little),
                    message(big),
                    "{types:?}, {wrong} in face {face}, {cut} bytes less"
                );
            }
        }
    }
}

#[test]
fn damaged_files_do_not_panic() {
    let mut random = Random(5);
    for file in [binary_file(false), binary_file(true), text_file().into_bytes()] {
        for _ in 0..2000 {
            let mut bytes = file.clone();
            for _ in 0..3 {
                let at = (random.unit() * bytes.len() as f64) as usize;
                bytes[at] = (random.unit() * 256.0) as u8;
            }
            bytes.truncate((random.unit() * 2.0 * bytes.len() as f64) as usize);
            if let Ok(parts) = read(&bytes[..]) {
                let _ = TriangleMesh::new(parts);
            }
        }
    }
}

/// Reading a file returns the numbers that were written, in both formats.
#[test]
fn meshes_survive_both_formats() {
    let mut exact = generate::displaced_sphere(2, 1);
    let count = exact.positions.len();
    exact.normals = Some(Corners::per_vertex(exact.positions.iter().map(|p| p.as_vec3()).collect()));
    exact.uvs = Some(Corners::per_vertex((0..count).map(|i| DVec2::new(i as f64 / 3.0, 0.5)).collect()));
    let mut fine = exact.clone();
    fine.positions.iter_mut().for_each(|p| *p *= 1.0 / 3.0);
    for parts in [exact, fine, generate::icosphere(1)] {
        let (mut as_ply, mut as_obj) = (Vec::new(), Vec::new());
        write(&mut as_ply, &parts).expect("memory");
        obj::write(&mut as_obj, &parts).expect("memory");
        assert_eq!(good(&as_ply), parts);
        assert_eq!(obj::read(&as_obj[..], &|_| Ok(Vec::new())).expect("a mesh"), parts);
    }
}

#[test]
fn values_per_corner_are_not_written() {
    let mut parts = generate::icosphere(0);
    let indices = vec![[0; 3]; parts.triangles.len()];
    parts.normals = Some(Corners::indexed(vec![Vec3::Y], indices, &parts.triangles));
    assert!(write(&mut Vec::new(), &parts).is_err());
}

/// Properties that are not read otherwise are data of the vertices and of the faces, in every format.
#[test]
fn other_properties_are_data() {
    let header = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex 4\nproperty float x\nproperty double heat\nproperty float y\n\
             property float z\nproperty uchar red\nproperty float nx\nelement face 2\nproperty short zone\n\
             property list uchar int vertex_indices\nproperty list uchar float weights\nproperty float load\nend_header\n"
        )
    };
    let vertices: [[f64; 6]; 4] = [
        [0.0, 0.1, 0.0, 0.0, 7.0, 0.5],
        [1.0, 0.2, 0.0, 0.0, 8.0, 0.25],
        [1.0, 0.3, 1.0, 0.0, 9.0, 0.0],
        [0.0, 0.4, 1.0, 0.0, 10.0, -1.0],
    ];
    let faces: [(i16, &[i32], &[f32], f32); 2] =
        [(-3, &[0, 1, 2, 3], &[1.0], 0.5), (4, &[0, 1, 2], &[], 2.5)];
    let mut text = header("ascii");
    let mut bytes = header("binary_little_endian").into_bytes();
    for [x, heat, y, z, red, nx] in vertices {
        text.push_str(&format!("{x} {heat} {y} {z} {red} {nx}\n"));
        bytes.extend((x as f32).to_le_bytes());
        bytes.extend(heat.to_le_bytes());
        [y, z].into_iter().for_each(|v| bytes.extend((v as f32).to_le_bytes()));
        bytes.push(red as u8);
        bytes.extend((nx as f32).to_le_bytes());
    }
    for (zone, corners, weights, load) in faces {
        let words = |numbers: Vec<String>| format!("{} {}", numbers.len(), numbers.join(" "));
        let corner_words = words(corners.iter().map(ToString::to_string).collect());
        let weight_words = words(weights.iter().map(ToString::to_string).collect());
        text.push_str(&format!("{zone} {corner_words} {weight_words} {load}\n"));
        bytes.extend(zone.to_le_bytes());
        bytes.push(corners.len() as u8);
        corners.iter().for_each(|corner| bytes.extend(corner.to_le_bytes()));
        bytes.push(weights.len() as u8);
        weights.iter().for_each(|weight| bytes.extend(weight.to_le_bytes()));
        bytes.extend(load.to_le_bytes());
    }
    let parts = good(text.as_bytes());
    assert_eq!(good(&bytes), parts);
    assert_eq!(parts.normals, None, "`nx` alone is no normal");
    let array = |name: &str, centering| {
        let array = parts.arrays.iter().find(|array| array.name == name && array.centering == centering);
        let array = array.unwrap_or_else(|| panic!("no data {name}"));
        (0..array.entries()).map(|entry| array.value(entry, Component::Whole)).collect::<Vec<_>>()
    };
    let names: Vec<_> = parts.arrays.iter().map(|array| array.name.as_str()).collect();
    assert_eq!(names, ["heat", "red", "nx", "zone", "load"]);
    assert_eq!(array("heat", Centering::Points), [0.1, 0.2, 0.3, 0.4]);
    assert_eq!(array("red", Centering::Points), [7.0, 8.0, 9.0, 10.0]);
    assert_eq!(array("nx", Centering::Points), [0.5, 0.25, 0.0, -1.0]);
    assert_eq!(array("zone", Centering::Cells), [-3.0, -3.0, 4.0], "a quadrilateral is two triangles");
    assert_eq!(array("load", Centering::Cells), [0.5, 0.5, 2.5]);
    assert!(matches!(parts.arrays[0].values, ArrayValues::F64(_)), "0.1 as a double");
    assert!(matches!(parts.arrays[2].values, ArrayValues::F32(_)));
}

/// A record of floats is read at once, with and without data.
#[test]
fn floats_that_are_data_are_read_at_once() {
    let mut bytes =
        b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float a\n\
        property float y\nproperty float z\nproperty float b\nelement face 1\n\
        property list uchar int vertex_indices\nend_header\n"
            .to_vec();
    (0..15).for_each(|k| bytes.extend((k as f32).to_le_bytes()));
    bytes.push(3);
    (0..3).for_each(|k: i32| bytes.extend(k.to_le_bytes()));
    let parts = good(&bytes);
    assert_eq!(parts.positions[1], DVec3::new(5.0, 7.0, 8.0));
    let values = [0, 1].map(|array| parts.arrays[array].value(2, Component::Whole));
    assert_eq!(values, [11.0, 14.0]);
}

/// Data of a triangle without an area leaves with it.
#[test]
fn data_of_removed_triangles_is_removed() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        element face 3\nproperty list uchar int vertex_indices\nproperty float load\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2 1\n3 0 1 1 2\n3 0 1 3 3\n";
    let mesh = TriangleMesh::new(good(text.as_bytes())).expect("a mesh");
    let key = ArrayKey::whole("load".to_owned());
    let values = [0, 1].map(|part| mesh.array_at(&key, part, DVec2::ZERO));
    assert_eq!((mesh.skipped, values), (1, [Some(1.0), Some(3.0)]));
}

/// Data arrays take more memory than their bytes in the file: twelve bytes per number.
#[test]
fn data_is_part_of_the_memory_that_is_checked() {
    let data: String = (0..60).map(|index| format!("property uchar d{index}\n")).collect();
    let text = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex 1000\nproperty float x\nproperty float y\n\
         property float z\n{data}element face 500\nproperty list uchar int vertex_indices\nproperty uchar zone\nend_header\n"
    );
    let header = Header::read(&mut Lines::new(text.as_bytes(), false)).expect("a header");
    assert_eq!(memory(&header).expect("a size"), 1000 * (24 + 60 * 12) + 500 * (12 + 12));
}
