//! Random numbers, and what they are bent into: directions, points of a disk.

mod frame;
mod hash;
mod sampler;
mod sobol;
mod warp;

pub use frame::Frame;
pub use hash::{hash, hash_lanes};
pub use sampler::{LaneSampler, PixelSampler, Points, Sampler, dimension};
pub use warp::{
    at_height, cone, cone_pdf, cosine_hemisphere, cosine_hemisphere_pdf, disk, in_ball, uniform_sphere,
};
