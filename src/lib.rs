#![forbid(unsafe_code)]
pub mod camera;
pub mod camera_path;
pub mod cli;
pub mod color;
pub mod counters;
pub mod encode;
pub mod film;
pub mod frame_set;
pub mod light;
pub mod material;
pub mod math;
pub mod render;
pub mod sequence;
pub mod shape;
pub mod time;
pub mod track;
pub mod transform;
