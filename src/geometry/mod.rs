//! Where things are: shapes and meshes, the trees of boxes over them, and their placement over time.
//!
//! In: numbers of the sequence, vertices of meshes. Out: hits of rays and the surfaces there. Uses `base`, `sampling`,
//! `track`.

pub mod bvh;
pub mod mesh;
pub mod shape;
pub mod transform;
