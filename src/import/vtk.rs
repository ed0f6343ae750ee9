//! VTK files: legacy (`.vtk`) and XML (`.vtp`, `.vtu`) polygons and cells with their data, and lists of the parts that
//! parallel programs write (`.pvtp`, `.pvtu`; Kitware, "VTK File Formats").

mod ghosts;
mod grid;
mod legacy;
mod number;
mod parallel;
mod surface;
#[cfg(test)]
mod tests;
mod xml;

use super::lines::without_mark;
use crate::geometry::mesh::{MeshData, MeshError};
use grid::Grid;
pub use parallel::pieces;

/// Reads the bytes of a legacy or an XML file. Volumes become their outer faces.
pub fn read(bytes: &[u8]) -> Result<MeshData, MeshError> {
    let mut parts = PartReader::default();
    parts.add(bytes)?;
    parts.finish()
}

/// Reads files that are parts of one data set. Data that a part lacks is left out. Parts touch where their points are
/// equal: there they have no faces.
#[derive(Default)]
pub struct PartReader(Grid);

impl PartReader {
    /// Adds the bytes of a legacy or an XML file.
    pub fn add(&mut self, bytes: &[u8]) -> Result<(), MeshError> {
        let bytes = without_mark(bytes);
        match bytes.trim_ascii_start().starts_with(b"<") {
            true => xml::read(bytes, &mut self.0),
            false => self.0.append(legacy::read(bytes)?),
        }
    }

    /// The surface of all parts.
    pub fn finish(self) -> Result<MeshData, MeshError> {
        surface::mesh(self.0)
    }
}
