//! Triangle meshes as shapes, searched by a tree of their own.

mod bundle;
mod encounters;
mod geometric;
mod handle;
mod search;
mod surface;
#[cfg(test)]
mod tests;

pub use handle::{Mesh, MeshStep};
