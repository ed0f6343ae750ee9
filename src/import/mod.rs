//! Readers of files that other programs write: meshes and their materials, tables of numbers.
//!
//! In: OBJ, MTL, PLY, STL and VTK files, and lists of them; CSV and JSON Lines files.
//! Out: meshes of `geometry` and series of them, tables.
//! May use: `base`, `track`, `geometry`, `appearance`.

pub mod gltf;
mod lines;
mod load;
mod polygon;
mod progress;
pub mod mtl;
pub mod obj;
pub mod ply;
pub mod series;
pub mod stl;
pub mod table;
pub mod vtk;
mod vtk_files;
mod xml_list;

pub use load::{known_format, load, load_data, load_parts, load_prepared};
pub use progress::LoadProgress;
