//! The hard cases of numerics: exact inputs, known answers and limits, a test for each under its id (`int_01_…`).
//!
//! Cases that need what is private stand beside the code that they try; `cargo test int_0` finds them all. `u` is the
//! unit round-off of f64, 2^-53. Answers come from closed forms, from brute force, or from arithmetic of twice the
//! precision ([`exact`]), never from the code under test. Sweeps are shorter by default;
//! `cargo test --release -- --ignored` runs them whole.
#![allow(
    clippy::expect_used,
    clippy::panic,
    reason = "a test that panics has done its work; clippy knows only `#[test]`"
)]

mod support;

use kinora::base::math::exact;

mod intersection;
mod traversal;
mod self_intersection;
mod transforms;
mod shading;
mod sampling;
mod camera;
mod colour;
mod matrix;
mod moved;
mod odd;
mod properties;
mod sources;
