//! Writes parts of meshes to binary PLY files.

use crate::geometry::mesh::{Corners, MeshData};
use std::io::{self, Error, Write};

/// Writes a mesh as a little-endian binary PLY file. Positions and texture coordinates are f32 if that is exact for
/// all of them, otherwise f64. So reading the file returns the same numbers. Materials and data
/// arrays are lost.
///
/// # Errors
/// If normals or texture coordinates are not per vertex, which the format cannot store; if writing fails.
pub fn write(mut out: impl Write, parts: &MeshData) -> io::Result<()> {
    let positions = Wide(parts.positions.iter().any(|p| p.as_vec3().as_dvec3() != *p));
    let (normals, uvs) = (parts.normals.as_ref(), parts.uvs.as_ref());
    let wide_uvs = Wide(uvs.iter().any(|uvs| uvs.values().iter().any(|uv| uv.as_vec2().as_dvec2() != *uv)));
    let count = parts.positions.len();
    let fits = |len: Option<usize>| len.is_none_or(|len| len == count);
    let shared = normals.is_none_or(Corners::is_per_vertex) && uvs.is_none_or(Corners::is_per_vertex);
    if !shared || !fits(normals.map(|n| n.values().len())) || !fits(uvs.map(|uvs| uvs.values().len())) {
        return Err(Error::other("PLY files store normals and texture coordinates per vertex only"));
    }
    write!(out, "ply\nformat binary_little_endian 1.0\nelement vertex {count}\n")?;
    let mut properties = |names: &[&str], wide: Wide| {
        names.iter().try_for_each(|name| writeln!(out, "property {} {name}", wide.name()))
    };
    properties(&["x", "y", "z"], positions)?;
    properties(if normals.is_some() { &["nx", "ny", "nz"] } else { &[] }, Wide(false))?;
    properties(if parts.colors.is_empty() { &[] } else { &["red", "green", "blue"] }, Wide(false))?;
    properties(if uvs.is_some() { &["u", "v"] } else { &[] }, wide_uvs)?;
    let faces = parts.triangles.len();
    write!(out, "element face {faces}\nproperty list uchar uint vertex_indices\nend_header\n")?;
    for vertex in 0..count {
        positions.write(&mut out, &parts.positions[vertex].to_array())?;
        if let Some(normals) = normals {
            Wide(false).write(&mut out, &normals.values()[vertex].as_dvec3().to_array())?;
        }
        if let Some(color) = parts.colors.get(vertex) {
            Wide(false).write(&mut out, &color.as_dvec3().to_array())?;
        }
        if let Some(uvs) = uvs {
            wide_uvs.write(&mut out, &uvs.values()[vertex].to_array())?;
        }
    }
    for triangle in &parts.triangles {
        out.write_all(&[3])?;
        triangle.iter().try_for_each(|vertex| out.write_all(&vertex.to_le_bytes()))?;
    }
    out.flush()
}

/// Whether numbers are written as f64 or as f32.
#[derive(Clone, Copy)]
struct Wide(bool);

impl Wide {
    fn name(self) -> &'static str {
        if self.0 { "double" } else { "float" }
    }

    fn write(self, out: &mut impl Write, values: &[f64]) -> io::Result<()> {
        values.iter().try_for_each(|value| match self.0 {
            true => out.write_all(&value.to_le_bytes()),
            false => out.write_all(&(*value as f32).to_le_bytes()),
        })
    }
}
