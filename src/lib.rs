//! Kinora renders keyframed animation sequences from one text file.
//!
//! ```text
//! sequence.ron ──load──▶ Sequence ──spawn──▶ World ──plan──▶ Plan        (once)
//!                                              │
//!           per frame:  Animate ▶ Extract ▶ Accelerate ▶ Trace ▶ Encode
//!                       World(t)   Scene       Bvh        Film    files
//! ```
//!
//! In: the text of a sequence. Out: pictures and animations. The file format is described in `sequences/README.md`.
//!
//! ```
//! use kinora::{Output, Request, parse, render};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let text = r#"(
//!     timeline: (frames: 12, fps: 24, keys: Frames),
//!     output: (size: (64, 36)),
//!     camera: (position: (0, 0, 5)),
//!     lights: { "lamp": Point(position: (3, 4, 5), on: [(0, true), (6, false)]) },
//!     objects: { "ball": (shape: Sphere(radius: 1)) },
//! )"#;
//! let sequence = parse("ball.ron", text)?;
//!
//! let folder = tempfile::tempdir()?;
//! let animation = folder.path().join("ball.gif");
//! let request = Request::new(&sequence, vec![Output::parse(animation)?]);
//! let summary = render(&sequence, &request, &Default::default())?;
//! assert_eq!((summary.frames, summary.reused), (12, 11)); // Switching a lamp traces nothing.
//! # Ok(())
//! # }
//! ```
//!
//! # Features
//! `cli` (the command and farm jobs), `accuracy` (reports), `video` (MP4) and `preview` (the page of
//! `kinora preview`) are on by default.

// The rooms, in the order of the flow. A room may use the rooms above it, never those below. They are public for this
// repository's tests, benches and examples; what other programs may rely on is re-exported at the end.

// Foundations.
#[doc(hidden)]
pub mod base;
#[doc(hidden)]
pub mod sampling;
#[doc(hidden)]
pub mod film;
#[doc(hidden)]
pub mod drawing;
#[doc(hidden)]
pub mod track;

// The parts of a scene.
#[doc(hidden)]
pub mod camera;
#[doc(hidden)]
pub mod geometry;
#[doc(hidden)]
pub mod appearance;
#[doc(hidden)]
pub mod import;

// Film → files, and file → Sequence.
#[doc(hidden)]
pub mod encode;
#[doc(hidden)]
pub mod annotate;
#[doc(hidden)]
pub mod sequence;

// Sequence → files of other programs.
#[doc(hidden)]
pub mod export;

// Sequence → World → World at time t → Scene → Film.
#[doc(hidden)]
pub mod world;
#[doc(hidden)]
pub mod scene;
#[doc(hidden)]
pub mod trace;

// The order of the systems, and everything built on it.
#[doc(hidden)]
pub mod pipeline;
#[cfg(feature = "accuracy")]
#[doc(hidden)]
pub mod accuracy;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod farm;
#[cfg(feature = "preview")]
#[doc(hidden)]
pub mod preview;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;

#[cfg(test)]
mod testing;

pub use base::stats::ProgressMeter;
pub use encode::{Existing, Output};
pub use pipeline::render::{RenderError, Request, Reuse, Summary, render};
pub use sequence::{Faults, LoadError, Sequence, UnknownObject, load, parse};
