//! The faces of an OBJ file: polygons of indices, split into triangles.

use crate::geometry::mesh::corners::NOWHERE;
use crate::geometry::mesh::{MeshError, MeshLocation};
use crate::import::lines::{parsed, quoted, words};

/// The indices of a corner: position, texture coordinates, normal.
type Corner = [u32; 3];

const WHAT: [&str; 3] = ["vertex", "texture coordinate (vt)", "normal (vn)"];

/// Triangles of indices into the three lists.
#[derive(Default)]
pub struct Faces {
    pub triangles: Vec<[u32; 3]>,
    /// Indices of texture coordinates; empty until a face has some, then as many as triangles.
    pub uvs: Vec<[u32; 3]>,
    /// Indices of normals, likewise.
    pub normals: Vec<[u32; 3]>,
    /// Faces read so far.
    pub count: u64,
    /// The highest index into each list and its line. Entries may follow the faces that use them.
    highest: [(u32, u64); 3],
}

impl Faces {
    /// Reads a face, `a/b/c` for each corner, and returns the number of its triangles. `counts` are the current
    /// lengths of the lists, from which negative indices count backwards.
    pub fn read(
        &mut self,
        number: u64,
        line: &[u8],
        rest: &[u8],
        counts: [usize; 3],
    ) -> Result<usize, MeshError> {
        let at = |why: String| MeshError::at(MeshLocation::Line(number), why);
        let mut corners = words(rest).map(|word| {
            let corner =
                parse_corner(word, counts).map_err(|why| at(format!("{why} in {}", quoted(line))))?;
            self.note(corner, number);
            Ok::<_, MeshError>(corner)
        });
        let few = || at(format!("expected a face of 3 corners or more, found {}", quoted(line)));
        let first = corners.next().ok_or_else(few)??;
        let mut last = corners.next().ok_or_else(few)??;
        let mut added = Vec::new();
        for next in corners {
            let next = next?;
            added.push([first, last, next]);
            last = next;
        }
        if added.is_empty() {
            return Err(few());
        }
        let count = added.len();
        added.into_iter().for_each(|triangle| self.push(triangle));
        self.count += 1;
        Ok(count)
    }

    fn note(&mut self, corner: Corner, line: u64) {
        for (highest, index) in self.highest.iter_mut().zip(corner) {
            if index != NOWHERE && index >= highest.0 {
                *highest = (index, line);
            }
        }
    }

    fn push(&mut self, corners: [Corner; 3]) {
        let [triangle, uvs, normals] = [0, 1, 2].map(|list| corners.map(|corner| corner[list]));
        for (list, indices) in [(&mut self.uvs, uvs), (&mut self.normals, normals)] {
            if !list.is_empty() || indices != [NOWHERE; 3] {
                list.resize(self.triangles.len(), [NOWHERE; 3]);
                list.push(indices);
            }
        }
        self.triangles.push(triangle);
    }

    /// Checks all indices against the lengths of the lists.
    pub fn check(&self, counts: [usize; 3]) -> Result<(), MeshError> {
        let lists = self.highest.iter().zip(counts).zip(WHAT);
        for ((&(index, line), count), what) in lists {
            // Line 0 means that no face uses this list.
            if line > 0 && index as usize >= count {
                let why = format!("there is no {what} {}; the file has {count}", u64::from(index) + 1);
                return Err(MeshError::at(MeshLocation::Line(line), why));
            }
        }
        Ok(())
    }
}

/// Reads `a`, `a/b`, `a//c` or `a/b/c`, which count from 1.
fn parse_corner(word: &[u8], counts: [usize; 3]) -> Result<Corner, String> {
    let mut corner = [NOWHERE; 3];
    for (list, index) in word.split(|byte| *byte == b'/').enumerate() {
        match corner.get_mut(list) {
            Some(_) if index.is_empty() && list > 0 => {}
            Some(place) => *place = resolve(index, counts[list], WHAT[list])?,
            None => return Err(format!("{} is not a corner; write v, v/vt, v//vn or v/vt/vn", quoted(word))),
        }
    }
    Ok(corner)
}

/// Resolves an index that counts from 1, or backwards from the last entry so far, which is -1.
fn resolve(word: &[u8], count: usize, what: &str) -> Result<u32, String> {
    let index = match parsed::<i64>(word) {
        Some(0) => return Err(format!("0 is not a {what}; indices count from 1")),
        Some(index @ 1..) => index - 1,
        Some(index) => count as i64 + index,
        None => return Err(format!("expected the number of a {what}, found {}", quoted(word))),
    };
    if index < 0 {
        return Err(format!("there is no {what} {} yet; the lines above define {count}", quoted(word)));
    }
    let index = u32::try_from(index).ok().filter(|index| *index != NOWHERE);
    index.ok_or_else(|| format!("there is no {what} {}", quoted(word)))
}
