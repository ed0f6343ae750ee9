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
//! Four examples show the library: [render a file](#render-a-file), [build a sequence](#build-a-sequence),
//! [trace a scene](#trace-a-scene) and [read a film](#read-a-film). The shortest use is this:
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
//! `kinora preview`) are on by default. The library needs none of them: a program that uses it may switch them off with
//! `default-features = false`, and then compiles fewer crates.
//!
//! # Versions
//! The names on this page follow Semantic Versioning. Modules that are not on it are for this repository alone and may
//! change in any version. Vectors, matrices and colours are those of the crate `glam`.
#![cfg_attr(doc, doc = concat!("# Render a file\n```\n", include_str!("../examples/render_file.rs"), "```\n"))]
#![cfg_attr(doc, doc = concat!("# Build a sequence\n```\n", include_str!("../examples/build_sequence.rs"), "```\n"))]
#![cfg_attr(doc, doc = concat!("# Trace a scene\n```\n", include_str!("../examples/trace_by_hand.rs"), "```\n"))]
#![cfg_attr(doc, doc = concat!("# Read a film\n```\n", include_str!("../examples/read_film.rs"), "```\n"))]

// The rooms, in the order of the flow. A room may use the rooms above it, never those below. They are public for this
// repository's tests, benches and examples; what other programs may rely on is re-exported at the end.

// Foundations.
#[cfg_attr(not(clippy), doc(hidden))]
pub mod base;
#[cfg_attr(not(clippy), doc(hidden))]
pub mod sampling;
#[cfg_attr(not(clippy), doc(hidden))]
pub mod film;
#[cfg_attr(not(clippy), doc(hidden))]
pub mod drawing;
#[cfg_attr(not(clippy), doc(hidden))]
pub mod track;

// The parts of a scene.
#[cfg_attr(not(clippy), doc(hidden))]
pub mod camera;
#[cfg_attr(not(clippy), doc(hidden))]
pub mod geometry;
#[cfg_attr(not(clippy), doc(hidden))]
pub mod appearance;
#[cfg_attr(not(clippy), doc(hidden))]
pub mod import;

// Film → files, and file → Sequence.
#[cfg_attr(not(clippy), doc(hidden))]
pub mod encode;
#[cfg_attr(not(clippy), doc(hidden))]
pub mod annotate;
#[cfg_attr(not(clippy), doc(hidden))]
pub mod sequence;

// Sequence → files of other programs.
#[cfg_attr(not(clippy), doc(hidden))]
pub mod export;

// Sequence → World → World at time t → Scene → Film.
#[cfg_attr(not(clippy), doc(hidden))]
pub mod world;
#[cfg_attr(not(clippy), doc(hidden))]
pub mod scene;
#[cfg_attr(not(clippy), doc(hidden))]
pub mod trace;

// The order of the systems, and everything built on it.
#[cfg_attr(not(clippy), doc(hidden))]
pub mod pipeline;
#[cfg(feature = "accuracy")]
#[cfg_attr(not(clippy), doc(hidden))]
pub mod accuracy;
#[cfg(feature = "cli")]
#[cfg_attr(not(clippy), doc(hidden))]
pub mod farm;
#[cfg(feature = "preview")]
#[cfg_attr(not(clippy), doc(hidden))]
pub mod preview;
#[cfg(feature = "cli")]
#[cfg_attr(not(clippy), doc(hidden))]
pub mod cli;

#[cfg(test)]
mod testing;

// The face: what other programs may rely on. Every item of it is documented (`missing_docs`): rustc does not look for
// documentation behind `doc(hidden)`, so clippy sees the rooms without it, and `#[warn(missing_docs)]` marks the
// definitions of these names and their methods.

// From a file to files.
pub use base::stats::ProgressMeter;
pub use encode::{Existing, Output, OutputError};
pub use pipeline::render::{RenderError, Request, Reuse, Summary, render};
pub use sequence::{FaultPlace, Faults, LoadError, Sequence, UnknownObject, load, parse};

// The parts of a sequence.
pub use appearance::light::{Attenuation, LightKind, LightTracks};
pub use appearance::material::MaterialBinding;
pub use base::color::Rgb;
pub use base::math::{Angle, DAffine3, DQuat, DVec3};
pub use base::time::{Rate, Time, Timeline};
pub use camera::path::CameraPath;
pub use geometry::shape::{Cuboid, Plane, Rectangle, Shape, Sphere};
pub use geometry::transform::{Rotation, TransformTracks};
pub use sequence::quality::{Integrator, NoiseTarget, PathSettings, Quality};
pub use sequence::{Named, Object, OutputSettings};
pub use track::{Animated, Ease, Key, Repeat, Track, TrackError};

// A scene at one moment, and its tracer.
pub use appearance::light::{Light, Source};
pub use appearance::material::{Lobes, Material};
pub use base::math::{Basis, look_at};
pub use camera::{Camera, Projection, ThinLens};
pub use scene::top_level::Bvh;
pub use scene::{Finish, Geometry, Scene, Shading, Weights};
pub use trace::{TraceSettings, trace};

// Films: the light of frames.
pub use film::{AovSet, DenoisingFeatures, Film, LayerId};
pub use pipeline::schedule::{FilmCollector, FrameError, FrameLoop};
