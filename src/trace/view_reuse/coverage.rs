//! Which directions each view traces, and how densely they are traced in all.
//!
//! Views are visited in their order, finest first. A view traces a direction unless views before it traced it with at
//! least the samples that this view asks for. Views trace more samples than asked for, so that two views of nearly equal
//! density do not trace a direction twice.
//!
//! A view that traces anything traces a margin around its picture too, and a view whose picture needs no more samples
//! traces nothing. So if pictures grow or turn slowly, a few of the views trace strips of some width, in which a lattice
//! is even. If each of them traced what it adds to the one before, the strips would be narrower than the distance of
//! samples.

use super::raster::{CellBlock, Raster};
use super::samples::SampleGrid;
use super::view::{View, ViewMap};

/// The views of a span, and the maps between their pictures.
pub struct Coverage {
    pub raster: Raster,
    views: Vec<View>,
    /// Maps from each view to each view.
    maps: Vec<Vec<ViewMap>>,
    /// The views that trace samples.
    tracing: TracingViews,
    /// The share of its own density that a view asks of others.
    asked: f64,
}

/// The views that may trace directions of a block.
#[derive(Clone, Debug)]
pub struct TracingViews {
    /// In their order. The view of the block is one of them.
    views: Vec<usize>,
    /// Whether each of them traces all directions of the block.
    certain: bool,
}

/// How much of a block a picture contains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overlap {
    None,
    Part,
    All,
}

impl Coverage {
    pub fn new(views: &[View], raster: Raster, grid: &SampleGrid) -> Self {
        let from = |from: &View| views.iter().map(|to| ViewMap::between(from, to, &raster)).collect();
        let maps = views.iter().map(from).collect();
        let tracing = TracingViews { views: Vec::new(), certain: false };
        let mut coverage = Self { raster, views: views.to_vec(), maps, tracing, asked: grid.asked_share() };
        for own in 0..views.len() {
            let mut among = coverage.tracing.clone();
            among.views.push(own);
            let blocks = coverage.raster.blocks(grid.block_side());
            if blocks.iter().any(|block| coverage.needs_samples(own, block, &among, grid)) {
                coverage.tracing = among;
            }
        }
        coverage
    }

    /// Whether the picture of a view needs samples in this block that views before its own do not trace.
    fn needs_samples(&self, own: usize, block: &CellBlock, among: &TracingViews, grid: &SampleGrid) -> bool {
        let needed = self.raster.needed();
        if self.overlap((own, own), needed, block).0 == Overlap::None {
            return false;
        }
        let Some(tracing) = self.tracing(own, block, among) else { return false };
        if tracing.certain || block.len() > 1 {
            let by_cell = |cell: CellBlock| self.needs_samples(own, &cell, &tracing, grid);
            return tracing.certain || block.cells().any(by_cell);
        }
        let mut found = false;
        grid.each(self, (own, block, &tracing), 0..grid.count(), |sample| {
            let position = self.map(own, own).position(sample.position);
            found |= !self.raster.outside(&position, needed).contains(&true);
        });
        found
    }

    pub fn map(&self, from: usize, to: usize) -> &ViewMap {
        &self.maps[from][to]
    }

    pub fn view(&self, index: usize) -> &View {
        &self.views[index]
    }

    /// All views that trace samples.
    pub fn all(&self) -> &TracingViews {
        &self.tracing
    }

    /// Whether a view traces samples.
    pub fn traces(&self, view: usize) -> bool {
        self.tracing.views.binary_search(&view).is_ok()
    }

    /// How much of a block of view `from` is in the picture of view `to` or at most `margin` beside it, with the smallest
    /// and the largest density there.
    pub fn overlap(&self, (from, to): (usize, usize), margin: f64, block: &CellBlock) -> (Overlap, [f64; 2]) {
        let map = self.map(from, to);
        let (mut all, mut any, mut depths) = ([true; 4], false, [f64::INFINITY, f64::NEG_INFINITY]);
        for corner in block.corners() {
            let position = map.position(corner);
            depths = [depths[0].min(position.depth), depths[1].max(position.depth)];
            for (side, outside) in all.iter_mut().zip(self.raster.outside(&position, margin)) {
                *side &= outside;
                any |= outside;
            }
        }
        // Depth is linear over the block, so corners have the extremes.
        let density = |depth: f64| if depth > 0.0 { map.density_at(depth) } else { f64::INFINITY };
        let densities = [density(depths[1]), density(depths[0])];
        match (depths, any, all.contains(&true)) {
            ([_, most], ..) if most <= 0.0 => (Overlap::None, densities),
            // Positions behind a view say nothing about sides.
            ([least, _], ..) if least <= 0.0 => (Overlap::Part, densities),
            (_, false, _) => (Overlap::All, densities),
            (_, _, true) => (Overlap::None, densities),
            _ => (Overlap::Part, densities),
        }
    }

    /// The views among `among` that may trace directions of a block of view `own`. None if `own` traces none of them.
    pub fn tracing(&self, own: usize, block: &CellBlock, among: &TracingViews) -> Option<TracingViews> {
        let traced = self.raster.traced();
        // Usually the view before traced the block, or the same ones as it did.
        if let Some(&before) = among.views.iter().rev().find(|view| **view < own) {
            let (overlap, [low, _]) = self.overlap((own, before), traced, block);
            if overlap == Overlap::All && low >= self.views[own].density() {
                return None;
            }
        }
        let mut found = TracingViews { views: Vec::new(), certain: true };
        // Bounds of the largest density that is traced so far, in any direction of the block.
        let [mut least, mut most] = [0.0_f64; 2];
        for &view in &among.views {
            if view < own && least >= self.views[own].density() * self.asked {
                return None;
            }
            let (overlap, [low, high]) = self.overlap((own, view), traced, block);
            if overlap == Overlap::None || least >= high * self.asked {
                if view == own {
                    return None;
                }
                continue;
            }
            let traces = overlap == Overlap::All && most < low * self.asked;
            found.views.push(view);
            found.certain &= traces;
            most = most.max(high);
            if overlap == Overlap::All {
                // Either this view traces a direction, or others did with the density that it asks for.
                least = least.max(if traces { low } else { low * self.asked });
            }
        }
        Some(found)
    }

    /// The density with which views trace the direction of a position in view `own`. None if `own` does not trace it.
    pub fn density(&self, own: usize, position: [f64; 2], tracing: &TracingViews) -> Option<f64> {
        if let [_] = tracing.views[..]
            && tracing.certain
        {
            return Some(self.views[own].density());
        }
        let (mut most, mut total) = (0.0_f64, 0.0);
        for &view in &tracing.views {
            let map = self.map(own, view);
            let mapped = map.position(position);
            if mapped.depth <= 0.0 || self.raster.outside(&mapped, self.raster.traced()).contains(&true) {
                if view == own {
                    return None;
                }
                continue;
            }
            let density = map.density_at(mapped.depth);
            if most < density * self.asked {
                most = most.max(density);
                total += density;
            } else if view == own {
                return None;
            }
        }
        Some(total)
    }
}

impl TracingViews {
    /// Whether each of the views traces all directions of the block.
    pub fn is_certain(&self) -> bool {
        self.certain
    }
}
