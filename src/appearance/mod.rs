//! In: materials, textures, lights, skies and fog over time, and the bytes of image files.
//! Out: their values at a moment, and formulas that give reflected and emitted light at a point.
//! May use: `base`, `sampling`, `film`, `track`, `camera`, `geometry`.

pub mod optics;
pub mod texture;
pub mod material;
pub mod light;
pub mod environment;
pub mod fog;
pub mod light_groups;
