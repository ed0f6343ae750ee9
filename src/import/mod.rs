//! Readers of files that other programs write: meshes and their materials.
//!
//! In: OBJ, MTL and PLY files. Out: meshes of `geometry`. Uses `geometry` and the rooms below.

mod lines;
mod load;
mod meter;
pub mod mtl;
pub mod obj;
pub mod ply;

pub use load::{known_format, load};
pub use meter::LoadMeter;
