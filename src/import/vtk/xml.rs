//! VTK's XML files: elements that announce arrays, which are text, base64 or appended bytes.

mod document;
mod payload;
mod piece;

use super::grid::Grid;
use super::surface;
use crate::geometry::mesh::{MeshData, MeshError, MeshLocation};
use document::Document;

/// Reads the bytes of a file.
pub fn read(bytes: &[u8]) -> Result<MeshData, MeshError> {
    let document = Document::read(bytes)?;
    let mut grid = Grid::default();
    for piece in &document.pieces {
        piece::add(&document, piece, &mut grid)?;
    }
    surface::mesh(grid)
}

/// An error at a byte of a file, by its line.
fn fault(bytes: &[u8], at: usize, why: impl Into<String>) -> MeshError {
    let before = &bytes[..at.min(bytes.len())];
    let line = before.iter().filter(|&&byte| byte == b'\n').count() + 1;
    MeshError::at(MeshLocation::Line(line as u64), why)
}
