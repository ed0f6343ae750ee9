//! How things look: optics, textures, materials, lights, the environment and fog.
//!
//! In: descriptions of the sequence and images. Out: values at a point and a time. Uses `geometry` and the rooms below.

pub mod optics;
pub mod texture;
pub mod material;
pub mod light;
pub mod environment;
pub mod fog;
pub mod light_groups;
