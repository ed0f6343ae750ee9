//! Sequences as files for other programs.
//!
//! In: a [`Sequence`](crate::sequence::Sequence).
//! Out: the bytes of a glTF file, and a list of what it cannot hold.
//! May use: `sequence` and the rooms above it.

mod gltf;
mod tessellate;

pub use gltf::{Container, ExportError, Exported, Options, exported};
pub use tessellate::{Tessellation, tessellated};
