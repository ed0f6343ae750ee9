//! Readers of files that other programs write: meshes and their materials.
//!
//! In: OBJ, MTL and PLY files.
//! Out: meshes of `geometry`.
//! May use: `base`, `geometry`, `appearance`.

mod lines;
mod load;
mod progress;
pub mod mtl;
pub mod obj;
pub mod ply;

pub use load::{known_format, load};
pub use progress::LoadProgress;
