//! Wavefront OBJ files: polygons and their materials.

mod faces;
mod usage;
#[cfg(test)]
mod tests;

use super::lines::{Lines, numbers, split_word, unexpected, words};
use crate::base::color::Rgb;
use crate::base::math::{DVec2, DVec3};
use crate::geometry::mesh::build::{is_placed, not_placed};
use crate::geometry::mesh::{Corners, MeshData, MeshError, MeshLocation};
use faces::Faces;
use glam::Vec3;
use std::io::{self, BufRead, Write};
use usage::MaterialUsage;

pub use usage::OpenLibrary;

/// Reads an OBJ file. Polygons are split into fans of triangles around their first corner. Unknown lines are skipped.
/// `open` returns the bytes of material libraries.
pub fn read(input: impl BufRead, open: &OpenLibrary<'_>) -> Result<MeshData, MeshError> {
    let mut lines = Lines::new(input, true);
    let mut reader = ObjReader::default();
    while let Some((number, line)) = lines.next()? {
        reader.line(number, line, open)?;
    }
    reader.finish()
}

#[derive(Default)]
struct ObjReader {
    positions: Vec<DVec3>,
    /// Empty until a vertex has a colour.
    colors: Vec<Rgb>,
    uvs: Vec<DVec2>,
    normals: Vec<Vec3>,
    faces: Faces,
    usage: MaterialUsage,
    /// The index and line of the first vertex with invalid coordinates.
    invalid: Option<(u32, u64)>,
}

impl ObjReader {
    fn line(&mut self, number: u64, line: &[u8], open: &OpenLibrary<'_>) -> Result<(), MeshError> {
        let (word, rest) = split_word(line);
        let read = match word {
            b"v" => self.vertex(number, rest),
            b"vt" => self.uv(rest),
            b"vn" => self.normal(rest),
            b"f" => return self.face(number, line, rest),
            b"usemtl" => return self.usage.use_material(number, line, rest),
            b"mtllib" => return self.usage.read_libraries(number, line, rest, open),
            _ => Ok(()),
        };
        read.map_err(|what| unexpected(number, line, what))
    }

    /// `v x y z` with an optional weight, which only curves use, or an optional colour.
    fn vertex(&mut self, number: u64, rest: &[u8]) -> Result<(), &'static str> {
        let values = numbers::<6>(words(rest));
        let Some(([x, y, z, r, g, b], count @ 3..)) = values else {
            return Err("three numbers after `v`");
        };
        let position = DVec3::new(x, y, z);
        if self.invalid.is_none() && !is_placed(position) {
            self.invalid = Some((self.positions.len() as u32, number));
        }
        if count == 6 {
            let color = Rgb::new(r as f32, g as f32, b as f32);
            if !color.is_finite() || color.min_element() < 0.0 {
                return Err("colours of 0 or more after the coordinates");
            }
            self.colors.resize(self.positions.len(), Rgb::ONE);
            self.colors.push(color);
        }
        self.positions.push(position);
        Ok(())
    }

    fn uv(&mut self, rest: &[u8]) -> Result<(), &'static str> {
        let uv = numbers::<2>(words(rest)).filter(|(_, count)| *count > 0);
        let uv = uv.map(|(uv, _)| DVec2::from_array(uv)).filter(|uv| uv.is_finite());
        self.uvs.push(uv.ok_or("two finite numbers after `vt`")?);
        Ok(())
    }

    fn normal(&mut self, rest: &[u8]) -> Result<(), &'static str> {
        let Some((normal, 3)) = numbers::<3>(words(rest)) else { return Err("three numbers after `vn`") };
        self.normals.push(DVec3::from_array(normal).as_vec3());
        Ok(())
    }

    fn face(&mut self, number: u64, line: &[u8], rest: &[u8]) -> Result<(), MeshError> {
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
        let triangles = self.faces.read(number, line, rest, counts)?;
        self.usage.assign(triangles);
        let Some((vertex, _)) = self.invalid else { return Ok(()) };
        let of_face = self.faces.triangles.iter().rev().take(triangles);
        if of_face.flatten().any(|&used| used == vertex) { Err(self.invalid_vertex_error()) } else { Ok(()) }
    }

    /// The error of the invalid vertex. It names the last face if this uses the vertex.
    fn invalid_vertex_error(&self) -> MeshError {
        let (vertex, line) = self.invalid.unwrap_or_default();
        let position = self.positions.get(vertex as usize).copied().unwrap_or(DVec3::NAN);
        let used = self.faces.triangles.iter().rev().take(1).flatten().any(|&used| used == vertex);
        not_placed(MeshLocation::Line(line), position, used.then(|| self.faces.count.saturating_sub(1)))
    }

    fn finish(mut self) -> Result<MeshData, MeshError> {
        if self.invalid.is_some() {
            return Err(self.invalid_vertex_error());
        }
        self.faces.check([self.positions.len(), self.uvs.len(), self.normals.len()])?;
        if !self.colors.is_empty() {
            self.colors.resize(self.positions.len(), Rgb::ONE);
        }
        let (slots, materials) = self.usage.resolved()?;
        let Faces { triangles, uvs, normals, .. } = self.faces;
        let uvs = (!uvs.is_empty()).then(|| Corners::indexed(self.uvs, uvs, &triangles));
        let normals = (!normals.is_empty()).then(|| Corners::indexed(self.normals, normals, &triangles));
        let (positions, colors) = (self.positions, self.colors);
        Ok(MeshData { positions, triangles, normals, uvs, colors, slots, materials, arrays: Vec::new() })
    }
}

/// Writes a mesh as an OBJ file, without its materials. Reading it returns the same numbers.
pub fn write(mut out: impl Write, parts: &MeshData) -> io::Result<()> {
    let mut colors = parts.colors.iter();
    for p in &parts.positions {
        write!(out, "v {} {} {}", p.x, p.y, p.z)?;
        if let Some(c) = colors.next() {
            write!(out, " {} {} {}", c.x, c.y, c.z)?;
        }
        writeln!(out)?;
    }
    for uv in parts.uvs.iter().flat_map(Corners::values) {
        writeln!(out, "vt {} {}", uv.x, uv.y)?;
    }
    for n in parts.normals.iter().flat_map(Corners::values) {
        writeln!(out, "vn {} {} {}", n.x, n.y, n.z)?;
    }
    for (part, triangle) in (0..).zip(&parts.triangles) {
        let uvs = parts.uvs.as_ref().map(|uvs| uvs.indices(part, &parts.triangles));
        let normals = parts.normals.as_ref().map(|normals| normals.indices(part, &parts.triangles));
        write!(out, "f")?;
        for corner in 0..3 {
            // Indices count from 1. A corner without a value leaves its place empty.
            let place = |indices: Option<[u32; 3]>| {
                indices
                    .and_then(|indices| indices[corner].checked_add(1))
                    .map_or(String::new(), |i| i.to_string())
            };
            let (v, uv, normal) = (place(Some(*triangle)), place(uvs), place(normals));
            match (uv.is_empty(), normal.is_empty()) {
                (true, true) => write!(out, " {v}")?,
                (false, true) => write!(out, " {v}/{uv}")?,
                _ => write!(out, " {v}/{uv}/{normal}")?,
            }
        }
        writeln!(out)?;
    }
    out.flush()
}
