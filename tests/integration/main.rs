//! Tests from the outside: the command as users run it, and the library as programs call it.
#![allow(
    clippy::expect_used,
    clippy::panic,
    reason = "a test that panics has done its work; clippy knows only `#[test]`"
)]

mod coat;
mod command;
mod support;

mod face;
mod rooms;
mod documents;
mod bounces;
mod inputs;
mod cli;
mod render;
mod ray_visibility;
mod relief;
mod reuse;
mod outlook;
mod outputs;
mod assemble;
mod places;
mod preview;
mod runs;
mod interruptions;
mod farm;
mod farm_jobs;
mod limits;
mod files;
mod terminal;
mod animation;
mod gltf;
mod annotations;
mod background;
mod counters;
mod cross_fades;
mod solids;
mod coverage;
mod coincident;
mod sheets;
mod touching;
mod determinism;
mod golden;
mod images;
mod larger;
mod integrators;
mod radiance;
mod transport;
mod denoise;
mod neighbors;
mod noise;
mod observability;
mod accuracy;
mod stratification;
mod time_limits;
mod watertight;
mod data;
mod groups;
mod mesh_materials;
mod meshes;
mod particles;
mod series;
mod shipped;
mod turntable;
mod zoom;
