//! Kinora renders keyframed animation sequences from one text file.
//!
//! ```text
//! sequence.ron ──load──▶ Sequence ──spawn──▶ World ──plan──▶ Plan        (once)
//!                                              │
//!           per frame:  Animate ▶ Extract ▶ Accelerate ▶ Trace ▶ Encode
//!                       World(t)   Scene       Bvh        Film    files
//! ```
//!
//! The modules below are rooms that stand in the order of that flow. A room may use those above it, never those below.

// Ground.
pub mod base;
pub mod sampling;
pub mod film;
pub mod track;

// What a scene consists of.
pub mod camera;
pub mod geometry;
pub mod appearance;
pub mod import;

// Film → files, and file → Sequence.
pub mod encode;
pub mod sequence;

// Sequence → World → World at t → Scene → Film.
pub mod world;
pub mod scene;
pub mod trace;

// The only place that knows the systems' order, and what is built on it.
pub mod pipeline;
pub mod accuracy;
pub mod farm;
pub mod cli;

#[cfg(test)]
mod testing;
