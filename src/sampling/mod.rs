//! Random numbers, lattices, and the warping of both to directions and to points of a disk.
//!
//! In: pixels, samples and seeds.
//! Out: stratified random numbers, and directions and points with their densities.
//! May use: `base`.

mod frame;
mod hash;
mod lattice;
mod sampler;
mod sobol;
mod warp;

pub use frame::{FrameAxes, LocalFrame};
pub use hash::{hash, hash_lanes};
pub use lattice::RankOneLattice;
pub use sampler::{LaneSampler, PixelSampler, Sampler, SamplerKind, TimePart, dimension};
pub use warp::{
    cone, cone_pdf, cosine_hemisphere, cosine_hemisphere_pdf, direction_at_height, disk, uniform_ball,
    uniform_sphere,
};
