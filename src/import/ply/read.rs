//! Reads PLY files to parts of meshes.

use super::header::{Element, Header, PlyFormat, ScalarType};
use super::records::{BlockReader, RecordReader, RecordSource};
use super::scalars::{AsciiScalars, Scalars, skip_list};
use super::vertices::{EXTRA_SIZE, Vertices, arrays};
use crate::base::machine;
use crate::base::units::count;
use crate::geometry::mesh::{Centering, Corners, MeshData, MeshError, MeshLocation};
use crate::import::lines::Lines;
use std::io::BufRead;
use std::ops::Range;

/// Reads a PLY file. Polygons are split into fans of triangles around their first corner. Unknown properties of vertices
/// and faces become data arrays; unknown elements and lists are skipped.
pub fn read(input: impl BufRead + Send) -> Result<MeshData, MeshError> {
    read_sized(input, u64::MAX)
}

/// [`read`] for a file of at most `size` bytes.
pub fn read_sized(input: impl BufRead + Send, size: u64) -> Result<MeshData, MeshError> {
    let mut lines = Lines::new(input, false);
    let header = Header::read(&mut lines)?;
    check_vertex_count(&header)?;
    let least = header.least_size();
    if least > size.into() {
        let least = count(u64::try_from(least).unwrap_or(u64::MAX));
        let why = format!(
            "the file is too short: it has {} bytes, but its header requires at least {least}",
            count(size)
        );
        return Err(MeshError::new(why));
    }
    if size < u64::MAX {
        // The counts are at most the bytes of the file.
        machine::check_memory(memory(&header)?)?;
    }
    match header.format {
        PlyFormat::Ascii => elements(&header, &mut AsciiScalars::new(lines)),
        format => elements(&header, &mut BlockReader::new(lines.into_rest(), format)),
    }
}

/// The memory of the vertices and faces in bytes, if every face is a triangle.
pub(super) fn memory(header: &Header) -> Result<u64, MeshError> {
    let size = |element: &Element| match element.name.as_str() {
        "vertex" => Vertices::size_of_one(element),
        "face" => {
            let extras = element.properties.iter().filter(|property| property.list.is_none()).count();
            Ok(size_of::<[u32; 3]>() + extras * EXTRA_SIZE)
        }
        _ => Ok(0),
    };
    let filled = header.elements.iter().filter(|element| element.count > 0);
    filled.map(|element| Ok(element.count.saturating_mul(size(element)? as u64))).sum()
}

/// The maximum number of vertices of a mesh.
const MAX_VERTICES: u64 = u32::MAX as u64 - 1;

fn check_vertex_count(header: &Header) -> Result<(), MeshError> {
    let too_many = |element: &&Element| element.name == "vertex" && element.count > MAX_VERTICES;
    match header.elements.iter().find(too_many) {
        None => Ok(()),
        Some(Element { count: vertices, .. }) => {
            let (vertices, most) = (count(*vertices), count(MAX_VERTICES));
            Err(MeshError::new(format!("it has {vertices} vertices; the maximum is {most}")))
        }
    }
}

fn elements(header: &Header, records: &mut impl RecordSource) -> Result<MeshData, MeshError> {
    let counts = |name: &str| header.elements.iter().find(|e| e.name == name).map(|e| e.count);
    let Some(vertex_count) = counts("vertex") else {
        return Err(MeshError::new("it has no `element vertex`"));
    };
    if counts("face").is_none() {
        return Err(MeshError::new("it has no `element face`; other faces, such as strips, are not read"));
    }
    let (mut vertices, mut faces) = (Vertices::default(), Faces::default());
    let (mut of_points, mut of_cells) = (Vec::new(), Vec::new());
    for element in header.elements.iter().filter(|element| element.count > 0) {
        if element.properties.is_empty() {
            return Err(MeshError::new(format!("its `element {}` has no properties", element.name)));
        }
        match element.name.as_str() {
            "vertex" => {
                vertices = Vertices::read(element, records)?;
                of_points = vertices.arrays(element)?;
            }
            "face" => {
                faces = Faces::read(element, records, vertex_count, &vertices)?;
                let names = element.properties.iter().filter(|p| p.list.is_none()).map(|p| p.name.as_str());
                of_cells = arrays(names.collect(), Centering::Cells, std::mem::take(&mut faces.extras));
            }
            _ => records.read(element, &Skipper(element))?,
        }
    }
    if let Some(error) = vertices.invalid_vertex_error(None) {
        return Err(error);
    }
    let Vertices { positions, normals, colors, uvs, .. } = vertices;
    let normals = (!normals.is_empty()).then(|| Corners::per_vertex(normals));
    let uvs = (!uvs.is_empty()).then(|| Corners::per_vertex(uvs));
    let (triangles, arrays) = (faces.triangles, [of_points, of_cells].concat());
    Ok(MeshData { positions, triangles, normals, uvs, colors, arrays, ..MeshData::default() })
}

/// The triangles of all faces.
#[derive(Default)]
struct Faces {
    triangles: Vec<[u32; 3]>,
    /// The numbers that become data arrays, all those of a triangle together.
    extras: Vec<f64>,
}

impl Faces {
    fn read(
        element: &Element,
        records: &mut impl RecordSource,
        vertex_count: u64,
        vertices: &Vertices,
    ) -> Result<Self, MeshError> {
        let named = |name: &str| name == "vertex_indices" || name == "vertex_index";
        let corners = element.properties.iter().position(|p| p.list.is_some() && named(&p.name));
        let corners = corners.ok_or_else(|| element.lacks("the list `vertex_indices`"))?;
        let only_list = element.properties[corners].list.filter(|_| element.properties.len() == 1);
        records.read(element, &FaceReader { element, corners, only_list, vertex_count, vertices })
    }
}

struct FaceReader<'a> {
    element: &'a Element,
    /// The index of the property that lists the corners.
    corners: usize,
    /// The type of its count, if it is the only property.
    only_list: Option<ScalarType>,
    vertex_count: u64,
    vertices: &'a Vertices,
}

impl RecordReader for FaceReader<'_> {
    type Output = Faces;

    fn read(
        &self,
        records: Range<u64>,
        values: &mut impl Scalars,
        faces: &mut Faces,
    ) -> Result<(), MeshError> {
        let item = self.element.properties[self.corners].item;
        for face in records {
            let first = faces.triangles.len();
            match self.only_list.and_then(|count| values.triangle(count, item, self.vertex_count)) {
                Some(triangle) => faces.triangles.push(triangle),
                None => {
                    self.face(face, values, faces).map_err(|error| self.element.in_record(error, face))?
                }
            }
            if let Some((invalid, _)) = self.vertices.invalid
                && faces.triangles[first..].iter().flatten().any(|&vertex| vertex == invalid)
            {
                let fault = self.vertices.invalid_vertex_error(Some(face));
                return Err(fault.unwrap_or_else(|| MeshError::new("its vertex does not exist")));
            }
        }
        Ok(())
    }

    fn append(whole: &mut Self::Output, part: &mut Self::Output) {
        whole.triangles.append(&mut part.triangles);
        whole.extras.append(&mut part.extras);
    }
}

impl FaceReader<'_> {
    /// Reads a face. All its triangles have its numbers.
    fn face(&self, face: u64, values: &mut impl Scalars, into: &mut Faces) -> Result<(), MeshError> {
        let Faces { triangles, extras } = into;
        let (first, numbers) = (triangles.len(), extras.len());
        values.begin()?;
        for (index, property) in self.element.properties.iter().enumerate() {
            match property.list {
                Some(_) if index == self.corners => self.polygon(face, values, triangles)?,
                Some(count) => skip_list(property, count, values)?,
                None => extras.push(values.next(property.item)?),
            }
        }
        let own = numbers..extras.len();
        (first + 1..triangles.len()).for_each(|_| extras.extend_from_within(own.clone()));
        values.end()
    }

    /// Reads a list of corners and splits the polygon into triangles around the first.
    fn polygon(
        &self,
        face: u64,
        values: &mut impl Scalars,
        triangles: &mut Vec<[u32; 3]>,
    ) -> Result<(), MeshError> {
        let property = &self.element.properties[self.corners];
        let count = values.next(property.list.unwrap_or(property.item))?;
        if count < 3.0 {
            let why = format!("expected a face of 3 corners or more, found {count}");
            return Err(MeshError::at(place(face, values), why));
        }
        let mut corner = || {
            let index = values.next(property.item)?;
            let vertex = index as u32;
            if f64::from(vertex) == index && u64::from(vertex) < self.vertex_count {
                return Ok(vertex);
            }
            let why =
                format!("there is no vertex {index}; the file has {}, numbered from 0", self.vertex_count);
            Err(MeshError::at(place(face, values), why))
        };
        let (first, mut last) = (corner()?, corner()?);
        for _ in 2..count as u64 {
            let next = corner()?;
            triangles.push([first, last, next]);
            last = next;
        }
        Ok(())
    }
}

fn place(face: u64, values: &impl Scalars) -> MeshLocation {
    values.line().map_or(MeshLocation::Face(face), MeshLocation::Line)
}

/// Skips the records of an element.
struct Skipper<'a>(&'a Element);

impl RecordReader for Skipper<'_> {
    type Output = ();

    fn read(&self, mut records: Range<u64>, values: &mut impl Scalars, _: &mut ()) -> Result<(), MeshError> {
        let mut record = || {
            values.begin()?;
            for property in &self.0.properties {
                match property.list {
                    Some(count) => skip_list(property, count, values)?,
                    None => values.next(property.item).map(|_| ())?,
                }
            }
            values.end()
        };
        records.try_for_each(|index| record().map_err(|error| self.0.in_record(error, index)))
    }

    fn append(_: &mut (), _: &mut ()) {}
}
