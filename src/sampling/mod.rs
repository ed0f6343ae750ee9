//! Random numbers, and what they are bent into: directions, points of a disk.

mod frame;
mod sampler;
mod sobol;
mod warp;

pub use frame::Frame;
pub use sampler::{PixelSampler, Points, Sampler, Use, hash};
pub use warp::{
    at_height, cone, cone_density, cosine_hemisphere, cosine_hemisphere_density, disk, in_ball,
    uniform_sphere,
};
