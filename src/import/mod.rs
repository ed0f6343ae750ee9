//! Readers of files that other programs write: meshes and their materials.
//!
//! In: OBJ, MTL, PLY, STL and VTK files.
//! Out: meshes of `geometry`.
//! May use: `base`, `geometry`, `appearance`.

mod lines;
mod load;
mod progress;
pub mod mtl;
pub mod obj;
pub mod ply;
pub mod stl;
pub mod vtk;

pub use load::{known_format, load};
pub use progress::LoadProgress;
