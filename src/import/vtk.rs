//! VTK files: legacy (`.vtk`) and XML (`.vtp`, `.vtu`) polygons and cells with their data (Kitware, "VTK File Formats").

mod ghosts;
mod grid;
mod legacy;
mod number;
mod surface;
#[cfg(test)]
mod tests;
mod xml;

use super::lines::without_mark;
use crate::geometry::mesh::{MeshData, MeshError};

/// Reads the bytes of a legacy or an XML file. Volumes become their outer faces.
pub fn read(bytes: &[u8]) -> Result<MeshData, MeshError> {
    let bytes = without_mark(bytes);
    match bytes.trim_ascii_start().starts_with(b"<") {
        true => xml::read(bytes),
        false => legacy::read(bytes),
    }
}
