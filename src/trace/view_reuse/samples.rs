//! Where the samples of views lie.

use super::coverage::{Coverage, TracingViews};
use super::raster::{CellBlock, Raster};
use crate::film::filter::Filter;
use crate::sampling::{RankOneLattice, hash};
use crate::sequence::quality::Quality;
use std::ops::Range;

/// The settings on which the places of samples depend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SamplePlan {
    /// Of the pictures, in pixels.
    pub size: (u32, u32),
    pub filter: Filter,
    /// The number of samples that each pixel should have.
    pub samples: u32,
    /// The seed of random numbers; none if nothing is random.
    pub seed: Option<u32>,
}

impl SamplePlan {
    /// The plan for frames whose samples are random, or not.
    pub fn new(size: (u32, u32), quality: &Quality, random: bool) -> Self {
        let samples = if random { quality.samples } else { quality.antialias * quality.antialias };
        Self { size, filter: quality.filter, samples, seed: random.then_some(quality.seed) }
    }
}

/// The samples of each cell: a lattice that goes on from cell to cell.
///
/// Carried to another picture, a cell's samples are cut by the borders of pixels. So stratification within a cell is of
/// little use, but a lattice stays even wherever it is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleGrid {
    lattice: RankOneLattice,
    asked: u32,
    seed: Option<u32>,
}

/// Views trace five samples where four are asked for. This makes up for the different numbers of samples that pixels get
/// if samples are carried to them.
const MORE: (u64, u64) = (5, 4);

/// Of random samples, three where two are asked for: pixels of other views also lose the stratification of their random
/// numbers.
const MORE_RANDOM: (u64, u64) = (3, 2);

/// How far around its picture a view traces samples, in mean distances between them. A strip of this width has enough
/// samples for an even lattice.
const MARGIN: f64 = 2.0;

/// What hashes of seeds are for.
const VIEW: u32 = 1;
const SHIFT: u32 = 2;

/// The most samples of a block that are traced at once.
const MAX_SAMPLES: u64 = 1 << 16;

/// The largest side of a block.
const MAX_SIDE: u64 = 16;

/// A sample of a cell.
pub struct CellSample {
    /// Its number in its cell.
    pub number: u32,
    /// In pixels from the left and the top of the picture.
    pub position: [f64; 2],
    /// The solid angle that it stands for, up to the factors of a [`ViewMap`](super::view::ViewMap).
    pub weight: f64,
}

impl SampleGrid {
    pub fn new(plan: &SamplePlan) -> Self {
        let (more, than) = if plan.seed.is_some() { MORE_RANDOM } else { MORE };
        let count = (u64::from(plan.samples) * more).div_ceil(than);
        let count = u32::try_from(count).unwrap_or(u32::MAX);
        Self { lattice: RankOneLattice::new(count), asked: plan.samples, seed: plan.seed }
    }

    /// The seed of the random numbers of a view's samples. Views have different ones, because pixels take samples of
    /// several views.
    pub fn seed(&self, view: usize) -> u32 {
        self.seed.map_or(0, |seed| hash([seed, view as u32, VIEW]))
    }

    /// By how much the lattice of a view is moved (Cranley, Patterson 1976). Each view has its own shift, even if nothing
    /// is random. So the strips that views add to each other have samples everywhere, not only where one lattice has them.
    fn shift(&self, view: usize) -> [f64; 2] {
        let seed = hash([self.seed.unwrap_or_default(), view as u32, VIEW]);
        [0, 1].map(|axis| f64::from(hash([seed, axis, SHIFT])) / 4_294_967_296.0)
    }

    /// The raster of pictures whose views trace these samples.
    pub fn raster(&self, plan: &SamplePlan) -> Raster {
        Raster::new(plan.size, plan.filter, MARGIN / f64::from(self.count()).sqrt())
    }

    /// The samples of a cell.
    pub fn count(&self) -> u32 {
        self.lattice.count()
    }

    /// The number of samples that each pixel should have.
    pub fn asked(&self) -> u32 {
        self.asked
    }

    /// The share of its samples that a cell must have.
    pub fn asked_share(&self) -> f64 {
        f64::from(self.asked) / f64::from(self.count())
    }

    /// Ranges of a cell's samples that are traced at once.
    pub fn parts(&self) -> impl Iterator<Item = Range<u32>> + Clone + use<> {
        let (count, most) = (self.count(), MAX_SAMPLES as u32);
        (0..count)
            .step_by(MAX_SAMPLES as usize)
            .map(move |first| first..count.min(first.saturating_add(most)))
    }

    /// The side of the blocks of cells that are traced at once.
    pub fn block_side(&self) -> i32 {
        let cells = MAX_SAMPLES / u64::from(self.count());
        cells.max(1).isqrt().min(MAX_SIDE) as i32
    }

    /// Calls `take` with each of these samples of a cell that view `own` traces.
    pub fn each(
        &self,
        coverage: &Coverage,
        (own, cell, tracing): (usize, &CellBlock, &TracingViews),
        numbers: Range<u32>,
        mut take: impl FnMut(CellSample),
    ) {
        let (left, top) = (f64::from(cell.columns.start), f64::from(cell.rows.start));
        let shift = self.shift(own);
        for number in numbers {
            let [x, y] = self.lattice.point(number, shift);
            let position = [left + x, top + y];
            if let Some(density) = coverage.density(own, position, tracing) {
                take(CellSample { number, position, weight: 1.0 / density });
            }
        }
    }
}
