//! STL files (3D Systems 1988): triangles that share no vertices, as text or little-endian binary.

mod text;

use super::lines::{Lines, without_mark};
use crate::base::machine;
use crate::base::math::DVec3;
use crate::geometry::mesh::{MeshData, MeshError, MeshLocation};
use rustc_hash::FxHashMap;
use std::io::{BufRead, Cursor, Read};

/// Bytes before the first triangle of a binary file: a header of any content, and the number of triangles.
const HEAD: usize = 84;
/// Bytes of a triangle: a normal, three corners, and an attribute.
const RECORD: usize = 50;

/// Reads a file of `size` bytes.
///
/// Text begins with `solid`. Some binary files do so, too, but the number of their triangles holds a byte that text does
/// not have. Corners with equal coordinates become one vertex. Stated normals are ignored, because many programs write
/// zeros; the order of the corners decides.
pub fn read(mut input: impl BufRead, size: u64) -> Result<MeshData, MeshError> {
    let mut head = Vec::with_capacity(HEAD);
    input.by_ref().take(HEAD as u64).read_to_end(&mut head)?;
    let mut welder = Welder::default();
    match count(&head) {
        _ if is_text(&head) => {
            let head = Cursor::new(without_mark(&head));
            text::read(Lines::new(head.chain(input), false), &mut welder)?;
        }
        // Some programs append bytes of their own.
        Some(count) if size >= binary_size(count) => read_binary(input, count, &mut welder)?,
        Some(count) => {
            let not = if begins_like_text(&head) {
                ""
            } else {
                "it is no STL file: text begins with `solid`, and "
            };
            let why = format!(
                "{not}a binary file of {count} triangles has {} bytes, not {size}",
                binary_size(count)
            );
            return Err(MeshError::new(why));
        }
        None => {
            let why = format!(
                "it is no STL file: text begins with `solid`, and a binary file has {HEAD} bytes or more"
            );
            return Err(MeshError::new(why));
        }
    }
    Ok(welder.parts)
}

/// The number of triangles that a binary file states.
fn count(head: &[u8]) -> Option<u32> {
    head.get(HEAD - 4..).and_then(<[u8]>::first_chunk).map(|bytes| u32::from_le_bytes(*bytes))
}

fn binary_size(count: u32) -> u64 {
    HEAD as u64 + RECORD as u64 * u64::from(count)
}

fn begins_like_text(head: &[u8]) -> bool {
    let head = without_mark(head).trim_ascii_start();
    head.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
}

/// Whether the head is text: its characters, and blanks. Any number of fewer than 150 million triangles has a byte of a
/// value below 9, which is neither.
fn is_text(head: &[u8]) -> bool {
    begins_like_text(head) && head.iter().all(|byte| !byte.is_ascii_control() || byte.is_ascii_whitespace())
}

fn read_binary(mut input: impl Read, count: u32, welder: &mut Welder) -> Result<(), MeshError> {
    let mut record = [0; RECORD];
    for triangle in 0..count {
        input.read_exact(&mut record)?;
        let numbers = record[12..48].as_chunks::<4>().0;
        let number = |at: usize| f32::from_le_bytes(numbers[at]);
        let corners = [0, 3, 6].map(|at| [number(at), number(at + 1), number(at + 2)]);
        welder.push(corners, MeshLocation::Face(triangle.into()))?;
    }
    Ok(())
}

/// Triangles whose corners become shared vertices where all bits of their coordinates are equal.
#[derive(Default)]
struct Welder {
    parts: MeshData,
    vertices: FxHashMap<[u32; 3], u32>,
}

impl Welder {
    /// Checks that memory is free before the tables grow to twice their size, and exist twice meanwhile. How many
    /// vertices there are depends on the corners that are shared.
    fn check_growth(&mut self) -> Result<(), MeshError> {
        let full = self.vertices.len() + 3;
        if full > self.vertices.capacity() {
            let each = size_of::<([u32; 3], u32)>() + size_of::<DVec3>();
            machine::check_memory((2 * full * each) as u64)?;
            self.vertices.reserve(full);
        }
        Ok(())
    }

    fn push(&mut self, corners: [[f32; 3]; 3], place: MeshLocation) -> Result<(), MeshError> {
        if !corners.as_flattened().iter().all(|number| number.is_finite()) {
            return Err(MeshError::at(place, format!("expected finite coordinates, found {corners:?}")));
        }
        self.check_growth()?;
        let triangle = corners.map(|corner| {
            let MeshData { positions, .. } = &mut self.parts;
            // 0 and -0 are one coordinate.
            let key = corner.map(|number| (number + 0.0).to_bits());
            *self.vertices.entry(key).or_insert_with(|| {
                positions.push(DVec3::from(corner.map(f64::from)));
                positions.len() as u32 - 1
            })
        });
        self.parts.triangles.push(triangle);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::TriangleMesh;

    /// A tetrahedron's corners, and its faces seen from outside counter-clockwise.
    const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.5, 0.0, 0.0], [0.0, 2.25, 0.0], [0.0, 0.0, 0.1]];
    const FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

    fn binary(header: &str) -> Vec<u8> {
        let mut file = vec![b' '; 80];
        file[..header.len()].copy_from_slice(header.as_bytes());
        file.extend(4u32.to_le_bytes());
        for face in FACES {
            file.extend([0; 12]);
            face.into_iter().flat_map(|corner| CORNERS[corner]).for_each(|x| file.extend(x.to_le_bytes()));
            file.extend([0; 2]);
        }
        file
    }

    fn text() -> String {
        let facet = |face: [usize; 3]| {
            let vertex = |at: usize| {
                let [x, y, z] = CORNERS[at];
                format!("      vertex {x:e} {y} {z}\n")
            };
            format!(
                "  facet normal 0 0 0\n    outer loop\n{}    endloop\n  endfacet\n",
                face.map(vertex).concat()
            )
        };
        format!("solid a part\n{}endsolid a part\n", FACES.map(facet).concat())
    }

    fn read_all(file: &[u8]) -> Result<MeshData, MeshError> {
        read(file, file.len() as u64)
    }

    fn fault(file: &[u8]) -> String {
        read_all(file).expect_err("a fault").to_string()
    }

    #[test]
    fn text_and_binary_give_the_same_mesh() {
        let parts = read_all(&binary("made by hand")).expect("a mesh");
        assert_eq!(parts.positions.len(), 4);
        assert_eq!(parts.positions[1], DVec3::new(0.0, 2.25, 0.0));
        assert_eq!(read_all(text().as_bytes()).expect("a mesh"), parts);
        assert_eq!(read_all(text().to_uppercase().as_bytes()).expect("a mesh"), parts);
        assert_eq!(TriangleMesh::new(parts).expect("a mesh").triangles().len(), 4);
    }

    #[test]
    fn a_binary_file_may_begin_like_text() {
        let file = binary("solid part");
        assert_eq!(read_all(&file).expect("a mesh").triangles.len(), 4);
        assert_eq!(fault(&file[..file.len() - 1]), "a binary file of 4 triangles has 284 bytes, not 283");
    }

    #[test]
    fn bytes_after_the_last_triangle_are_skipped() {
        for header in ["solid part", "made by hand"] {
            let file = [binary(header), b"\0more".to_vec()].concat();
            assert_eq!(read_all(&file).expect("a mesh").triangles.len(), 4);
        }
    }

    #[test]
    fn a_byte_order_mark_is_skipped() {
        let file = "\u{feff}".to_owned() + &text();
        assert_eq!(read_all(file.as_bytes()).expect("a mesh").triangles.len(), 4);
    }

    /// Microsoft's libraries print numbers that are none like this.
    #[test]
    fn normals_may_be_anything() {
        for normal in ["-nan(ind) -nan(ind) -nan(ind)", "-1.#IND 1.#QNAN x", "nan inf -inf"] {
            let file = text().replace("normal 0 0 0", &format!("normal {normal}"));
            assert_eq!(read_all(file.as_bytes()).expect("a mesh").triangles.len(), 4, "{normal}");
        }
    }

    #[test]
    fn several_solids_are_one_mesh() {
        let twice = text().repeat(2);
        assert_eq!(read_all(twice.as_bytes()).expect("a mesh").triangles.len(), 8);
    }

    #[test]
    fn the_signs_of_zeros_do_not_split_vertices() {
        let mut welder = Welder::default();
        for zero in [0.0, -0.0] {
            welder
                .push([[zero, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], MeshLocation::Face(0))
                .expect("finite");
        }
        assert_eq!(welder.parts.positions.len(), 3);
    }

    #[test]
    fn faults_name_their_place() {
        assert_eq!(
            fault(b"ply"),
            "it is no STL file: text begins with `solid`, and a binary file has 84 bytes or more"
        );
        let mut cut = binary("");
        cut.pop();
        assert_eq!(
            fault(&cut),
            "it is no STL file: text begins with `solid`, and a binary file of 4 triangles has 284 bytes, not 283"
        );
        let mut infinite = binary("");
        infinite[84 + 50 + 12..][..4].copy_from_slice(&f32::INFINITY.to_le_bytes());
        assert!(fault(&infinite).starts_with("face 1: expected finite coordinates, found"));
        let broken = text().replacen("vertex 1.5e0 0 0", "vertex 1.5e0 zero 0", 1);
        assert_eq!(fault(broken.as_bytes()), "line 6: expected a number, found `zero`");
        let broken = text().replacen("outer loop", "outer", 1);
        assert_eq!(fault(broken.as_bytes()), "line 4: expected `loop`, found `vertex`");
        assert_eq!(fault(b"solid\nfacet normal 0 0 1\n\n"), "line 3: the file ends before `endsolid`");
        assert_eq!(fault(b"solid\nfacets"), "line 2: expected `facet` or `endsolid`, found `facets`");
    }
}
