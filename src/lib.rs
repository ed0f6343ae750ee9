//! Kinora renders keyframed animation sequences from one text file.
//!
//! ```text
//! sequence.ron ──load──▶ Sequence ──spawn──▶ World ──plan──▶ Plan        (once)
//!                                              │
//!           per frame:  Animate ▶ Extract ▶ Accelerate ▶ Trace ▶ Encode
//!                       World(t)   Scene       Bvh        Film    files
//! ```
//!
//! The modules below stand in the order of that flow, nouns first. Whatever stands lower in the list may use
//! what stands higher, never the reverse.

// Nouns: what there is.
pub mod digest;
pub mod time;
pub mod lanes;
pub mod math;
pub mod sampling;
pub mod optics;
pub mod color;
pub mod track;
pub mod counters;
pub mod humane;
pub mod escape;
pub mod machine;
pub mod clock;
pub mod process;
pub mod files;
pub mod filter;
pub mod film;
pub mod metrics;
pub mod glow;
pub mod frame_set;
pub mod stop;
pub mod camera;
pub mod camera_path;
pub mod tree;
pub mod mesh;
pub mod shape;
pub mod transform;
pub mod texture;
pub mod material;
pub mod light;
pub mod environment;
pub mod fog;
pub mod layers;
pub mod quality;

// Film → files, and file → Sequence.
pub mod encode;
pub mod plot;
pub mod sequence;

// Sequence → World → World at t → Scene → Bvh → Film.
pub mod world;
pub mod animate;
pub mod scene;
pub mod bvh;
pub mod trace;

// The only place that knows the systems' order, and the front door.
pub mod schedule;
pub mod plan;
pub mod memory;
pub mod render;
pub mod filmstrip;
pub mod assemble;
pub mod accuracy;
pub mod farm;
pub mod cli;

#[cfg(test)]
mod testing;
