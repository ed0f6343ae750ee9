//! Geometry: shapes and meshes, bounding volume hierarchies over them, and transforms over time.
//!
//! In: parameters of shapes and vertices of meshes. Out: ray hits, surfaces, and points sampled on surfaces.
//!
//! Uses `base`, `sampling`, `track`.

pub mod bvh;
pub mod carrier;
pub mod clip;
pub mod deformation;
pub mod mesh;
pub mod motion;
pub mod prepared_transform;
pub mod ray_kinds;
pub mod shape;
pub mod table_rows;
pub mod transform;
