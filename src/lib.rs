//! Kinora renders keyframed animation sequences from one text file.
//!
//! ```text
//! sequence.ron ──load──▶ Sequence ──spawn──▶ World ──plan──▶ Plan        (once)
//!                                              │
//!           per frame:  Animate ▶ Extract ▶ Accelerate ▶ Trace ▶ Encode
//!                       World(t)   Scene       Bvh        Film    files
//! ```
//!
//! In: the text of a sequence. Out: pictures and animations.
//! The modules below are rooms in the order of that flow. A room may use the rooms above it, never those below.

// Foundations.
pub mod base;
pub mod sampling;
pub mod film;
pub mod track;

// The parts of a scene.
pub mod camera;
pub mod geometry;
pub mod appearance;
pub mod import;

// Film → files, and file → Sequence.
pub mod encode;
pub mod sequence;

// Sequence → World → World at time t → Scene → Film.
pub mod world;
pub mod scene;
pub mod trace;

// The order of the systems, and everything built on it.
pub mod pipeline;
#[cfg(feature = "accuracy")]
pub mod accuracy;
#[cfg(feature = "cli")]
pub mod farm;
#[cfg(feature = "cli")]
pub mod cli;

#[cfg(test)]
mod testing;
