//! The samples of neighbours in time, where they show the same light.
//!
//! A neighbour sees a point of a pixel at another place of its picture ([`Reprojection`]). Its light there is as good as
//! more samples, unless the light has changed, depends on the direction, or is hidden. How far it is off is measured
//! around each pixel: both halves of the neighbour differ from both halves of the picture, and noise has no part in the
//! product of these differences (`agreement`). By that, the neighbours are weighted and pooled with the samples (`pool`).

mod agreement;
mod pool;
mod reprojection;

pub use pool::Pooled;
pub use reprojection::{Places, RUN, Reprojection, Run, Taps, Views};

use super::halves::Halves;

/// The samples of a neighbour in time, and where they show what the pixels of the picture show.
#[warn(missing_docs)]
pub struct Neighbor<'a> {
    /// Of the size of the picture.
    pub halves: &'a Halves,
    /// From the pixels of the picture to those of the neighbour.
    pub reprojection: Reprojection,
}

impl Neighbor<'_> {
    /// Bytes per pixel of what it holds besides its samples.
    pub(super) const BYTES_PER_PIXEL: u64 = Reprojection::BYTES_PER_PIXEL;
}
