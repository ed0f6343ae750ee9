//! Readers of files that other programs write: meshes and their materials.
//!
//! In: OBJ, MTL, PLY and STL files.
//! Out: meshes of `geometry`.
//! May use: `base`, `geometry`, `appearance`.

mod lines;
mod load;
mod progress;
pub mod mtl;
pub mod obj;
pub mod ply;
pub mod stl;

pub use load::{known_format, load};
pub use progress::LoadProgress;
