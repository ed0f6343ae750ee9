//! VTK's XML files: elements that announce arrays, which are text, base64 or appended bytes.

mod document;
mod payload;
mod piece;

use super::grid::Grid;
use crate::geometry::mesh::{MeshError, MeshLocation};
use document::Document;

/// Adds the pieces of a file to a grid.
pub fn read(bytes: &[u8], grid: &mut Grid) -> Result<(), MeshError> {
    let document = Document::read(bytes)?;
    document.pieces.iter().try_for_each(|piece| piece::add(&document, piece, grid))
}

/// An error at a byte of a file, by its line.
fn fault(bytes: &[u8], at: usize, why: impl Into<String>) -> MeshError {
    let before = &bytes[..at.min(bytes.len())];
    let line = before.iter().filter(|&&byte| byte == b'\n').count() + 1;
    MeshError::at(MeshLocation::Line(line as u64), why)
}
