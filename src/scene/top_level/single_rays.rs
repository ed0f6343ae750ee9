//! The single rays of a bundle.

use crate::base::lanes::Level;
use crate::geometry::bvh::{Slabs, TraversalRay, Tree};
use crate::geometry::shape::PreparedRay;

/// A single ray of a bundle.
#[derive(Clone, Copy)]
pub(super) struct SingleRay {
    pub(super) single: TraversalRay,
    pub(super) slabs: Slabs,
}

/// The single rays of a bundle, each prepared at its first use.
pub(super) struct Singles<const ALONE: usize>([Option<SingleRay>; ALONE]);

impl<const ALONE: usize> Singles<ALONE> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self([None; ALONE])
    }

    /// A single ray. None if it misses the tree or if there is no room for it.
    #[inline(always)]
    pub(super) fn get<L: Level>(
        &mut self,
        tree: &Tree,
        rays: &PreparedRay<L::F64>,
        ray: usize,
    ) -> Option<&SingleRay> {
        let alone = self.0.get_mut(ray)?;
        if alone.is_none() {
            let single = TraversalRay::new(rays.ray.lane(ray));
            *alone = Slabs::new::<L::Narrow>(tree, &single, [0.0, f64::INFINITY])
                .map(|slabs| SingleRay { single, slabs });
        }
        alone.as_ref()
    }
}
