//! Traces films of one scene that cameras at one point see in different directions and fields of view.
//!
//! The light in a direction is the same for all of them. So each view traces only the directions that finer views have
//! not traced ([`coverage`]), and every film takes the mean of all samples in its pixels, each weighted by the solid
//! angle that it stands for ([`film_sums`]). Films add samples in the order of views, blocks and cells, so their sums do
//! not depend on threads. Which samples there are depends on the views alone: a film has the same sums whichever films
//! are traced with it.
//!
//! In: a scene at a moment, its tree, settings and views. Out: a film for each requested view.

mod blocks;
mod coverage;
mod film_sums;
mod raster;
mod samples;
#[cfg(test)]
mod tests;
mod tracer;
mod view;

pub use film_sums::bytes_of_sums;
pub use samples::SamplePlan;
pub use tracer::trace_views;
pub use view::View;

use crate::base::digest::Digest;
use blocks::traced_blocks;
use coverage::Coverage;
use raster::Raster;
use rayon::prelude::*;
use samples::SampleGrid;
use view::finest_first;

/// The most views that share samples.
pub const MAX_VIEWS: usize = 64;

/// Below this gain in camera rays, views do not share samples.
const MIN_GAIN: f64 = 1.2;

/// The side of the picture on which the gain is estimated.
const REDUCED_SIDE: i32 = 64;

/// Views from one point that share samples, finest first.
#[derive(Clone, Debug, PartialEq)]
pub struct SharedViews {
    views: Vec<View>,
}

impl SharedViews {
    /// None if the gain is too small, or the filter is narrower than a pixel: then most samples of other views are in none.
    pub fn new(views: impl IntoIterator<Item = View>, plan: &SamplePlan) -> Option<Self> {
        if plan.filter.width < 1.0 {
            return None;
        }
        let shared = Self { views: finest_first(views) };
        let all: Vec<usize> = (0..shared.len()).collect();
        let grid = SampleGrid::new(plan);
        let reduced = grid.raster(plan).reduced(REDUCED_SIDE);
        let traced = shared.count(reduced, &grid, &all) as f64;
        let alone = all.len() as f64 * reduced.pixels() as f64 * f64::from(plan.samples);
        (all.len() > 1 && alone >= MIN_GAIN * traced).then_some(shared)
    }

    /// The number of views.
    fn len(&self) -> usize {
        self.views.len()
    }

    /// The place of a view.
    pub fn place(&self, view: &View) -> Option<usize> {
        self.views.iter().position(|other| other == view)
    }

    /// The digest of all views. Samples of each film depend on them.
    pub fn digest(&self) -> Digest {
        Digest::of(&self.views)
    }

    /// The number of camera rays for the films of these views together. Rays of pixels that lack samples are left out.
    pub fn camera_rays(&self, plan: &SamplePlan, requested: &[usize]) -> u64 {
        let grid = SampleGrid::new(plan);
        self.count(grid.raster(plan), &grid, requested)
    }

    fn count(&self, raster: Raster, grid: &SampleGrid, requested: &[usize]) -> u64 {
        let coverage = Coverage::new(&self.views, raster, grid);
        let of_view = |own: usize| {
            let blocks = traced_blocks(&coverage, grid, own, requested);
            blocks.iter().map(|block| block.count(&coverage, grid, own)).sum::<u64>()
        };
        (0..self.len()).into_par_iter().map(of_view).sum()
    }
}
