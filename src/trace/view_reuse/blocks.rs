//! The blocks of cells of which a view traces samples.

use super::coverage::{Coverage, Overlap, TracingViews};
use super::raster::CellBlock;
use super::samples::{CellSample, SampleGrid};
use std::ops::Range;

/// A block of cells of which a view traces samples.
pub struct TracedBlock {
    block: CellBlock,
    tracing: TracingViews,
    /// The requested views whose pictures contain parts of the block: a bit for each in their list.
    films: u64,
}

/// The blocks of view `own` of which it traces samples for requested views, at most [`MAX_VIEWS`](super::MAX_VIEWS).
pub fn traced_blocks(
    coverage: &Coverage,
    grid: &SampleGrid,
    own: usize,
    requested: &[usize],
) -> Vec<TracedBlock> {
    let traced = |block: CellBlock| {
        let tracing = coverage.tracing(own, &block, coverage.all())?;
        let needs =
            |view: usize| coverage.overlap((own, view), coverage.raster.needed(), &block).0 != Overlap::None;
        let films = requested.iter().enumerate().filter(|(_, view)| needs(**view));
        let films = films.fold(0, |films, (film, _)| films | 1u64 << film);
        (films != 0).then_some(TracedBlock { block, tracing, films })
    };
    match coverage.traces(own) {
        true => coverage.raster.blocks(grid.block_side()).into_iter().filter_map(traced).collect(),
        false => Vec::new(),
    }
}

impl TracedBlock {
    /// Whether a requested view, by its index in their list, contains a part of the block.
    pub fn is_in(&self, film: usize) -> bool {
        self.films >> film & 1 == 1
    }

    /// The number of its cells.
    pub fn cells(&self) -> u64 {
        self.block.len()
    }

    /// The number of samples in all its cells, also those that are not traced.
    pub fn most_samples(&self, grid: &SampleGrid) -> u64 {
        self.cells() * u64::from(grid.count())
    }

    /// Calls `take` with each sample that is traced, of those with these numbers in each cell, and the column and row of
    /// its cell.
    pub fn each(
        &self,
        coverage: &Coverage,
        grid: &SampleGrid,
        (own, numbers): (usize, Range<u32>),
        mut take: impl FnMut((i32, i32), CellSample),
    ) {
        for (cell, tracing) in self.traced_cells(coverage, own) {
            let place = (cell.columns.start, cell.rows.start);
            grid.each(coverage, (own, &cell, &tracing), numbers.clone(), |sample| take(place, sample));
        }
    }

    /// The number of samples that are traced.
    pub fn count(&self, coverage: &Coverage, grid: &SampleGrid, own: usize) -> u64 {
        if self.tracing.is_certain() {
            return self.most_samples(grid);
        }
        let of_cell = |(cell, tracing): (CellBlock, TracingViews)| {
            let mut count = 0;
            match tracing.is_certain() {
                true => count = u64::from(grid.count()),
                false => grid.each(coverage, (own, &cell, &tracing), 0..grid.count(), |_| count += 1),
            }
            count
        };
        self.traced_cells(coverage, own).map(of_cell).sum()
    }

    /// The cells with samples that may be traced.
    fn traced_cells<'a>(
        &'a self,
        coverage: &'a Coverage,
        own: usize,
    ) -> impl Iterator<Item = (CellBlock, TracingViews)> + 'a {
        self.block.cells().filter_map(move |cell| {
            let tracing = match self.tracing.is_certain() {
                true => self.tracing.clone(),
                false => coverage.tracing(own, &cell, &self.tracing)?,
            };
            Some((cell, tracing))
        })
    }
}
