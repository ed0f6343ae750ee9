//! Readers of files that other programs write: meshes and their materials, tables of numbers.
//!
//! In: OBJ, MTL, PLY, STL and VTK files; CSV and JSON Lines files.
//! Out: meshes of `geometry`, tables.
//! May use: `base`, `geometry`, `appearance`.

mod lines;
mod load;
mod polygon;
mod progress;
pub mod mtl;
pub mod obj;
pub mod ply;
pub mod stl;
pub mod table;
pub mod vtk;

pub use load::{known_format, load, load_data, load_prepared};
pub use progress::LoadProgress;
