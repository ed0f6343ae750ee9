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
pub use reprojection::Reprojection;

use super::guides::{Guides, POSITION, guide_planes};
use super::halves::Halves;
use super::planes::Planes;

/// The samples of a neighbour in time.
pub struct Neighbor<'a> {
    halves: &'a Halves,
    reprojection: Reprojection,
    /// The guides of both halves at the points of the picture.
    guides: [Planes; 2],
}

#[warn(missing_docs)]
impl<'a> Neighbor<'a> {
    /// Bytes per pixel of what it holds besides its samples.
    pub(super) const BYTES_PER_PIXEL: u64 = Reprojection::BYTES_PER_PIXEL + 2 * Guides::BYTES_PER_PIXEL;

    /// A neighbour with these samples, and where they show what the pixels of the picture show. Both have the same size.
    pub fn new(halves: &'a Halves, reprojection: Reprojection) -> Self {
        let guides =
            halves.films.each_ref().map(|film| pool::moved(&guide_planes(film), 0..POSITION, &reprojection));
        Self { halves, reprojection, guides }
    }
}
