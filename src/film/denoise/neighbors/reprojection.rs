//! Where another film of the same size sees the points that the pixels of a film see.

use super::super::memory::{Held, Memory};
use crate::base::lanes::{Level, Real, Row, SimdKernel, Single, dispatch};
use rayon::prelude::*;

/// Positions nearer to the centre of a pixel than this, in pixels, are the centre: where nothing moves, rounding must not
/// blur.
const CENTERED: f64 = 1e-3;

/// For each pixel of a film, the pixels of another film around the same point.
#[derive(Debug, PartialEq)]
#[warn(missing_docs)]
pub struct Reprojection {
    width: usize,
    taps: Held<Taps>,
    /// Whether any point is seen by the same pixel.
    pub(super) is_partly_still: bool,
}

/// So many pixels before they are needed, those of a neighbour are prefetched: where it sees the points of a row is no
/// pattern that processors find.
pub const AHEAD: usize = 16;

/// Four pixels, weighted as in bilinear interpolation. Those that see something else have no weight; the weights of the
/// others add up to 1. All are 0 if the point is not seen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Taps {
    /// The column on the left and the row above. Those on the right and below follow, as far as there are any.
    pub column: u32,
    pub row: u32,
    /// Left and right in the upper row, then in the lower one.
    pub weights: [f32; 4],
    /// Whether the same pixel sees the point, at the same place.
    pub is_still: bool,
}

impl Taps {
    pub fn is_seen(&self) -> bool {
        self.weights != [0.0; 4]
    }

    /// Prefetches numbers for [`Taps::sum`]: those of the last pixel. The others have mostly been read for the pixels before
    /// and above.
    #[inline(always)]
    pub fn prefetch<L: Level>(&self, numbers: &[f32], (first, count): (usize, usize), width: usize) {
        let last = (self.row as usize + 1) * width + self.column as usize + 1;
        L::prefetch(numbers, last * count + first);
    }

    /// The weighted sums of eight numbers of each pixel, from the number `first` on. Pixels of a picture of this width have
    /// `count` numbers.
    #[inline(always)]
    pub fn sum<S: Single>(&self, numbers: &[f32], (first, count): (usize, usize), width: usize) -> S {
        let at = (self.row as usize * width + self.column as usize) * count + first;
        let [a, b, c, d] = self.weights;
        let mut sum = S::splat(0.0);
        if (a > 0.0) & (b > 0.0) & (c > 0.0) & (d > 0.0) {
            // Nearly all points that are seen: without a branch for each pixel.
            let [upper, lower] = [at, at + width * count].map(|at| &numbers[at..][..count + S::LANES]);
            sum = sum + S::load(upper, 0) * S::splat(a);
            sum = sum + S::load(upper, count) * S::splat(b);
            sum = sum + S::load(lower, 0) * S::splat(c);
            sum = sum + S::load(lower, count) * S::splat(d);
            return sum;
        }
        // Pixels without a weight may hold any light, also an infinite one, and may be beyond the edge.
        for (pixel, weight) in [0, 1, width, width + 1].into_iter().zip(self.weights) {
            if weight > 0.0 {
                sum = sum + S::load(numbers, at + pixel * count) * S::splat(weight);
            }
        }
        sum
    }
}

/// The most pixels of a row that are found at once.
pub const RUN: usize = 64;

/// A number of each pixel of a run. Those of pixels that a shorter run lacks may be any.
pub type Run = [f64; RUN];

#[warn(missing_docs)]
impl Reprojection {
    pub(super) const BYTES_PER_PIXEL: u64 = size_of::<Taps>() as u64;

    /// `find` writes the positions at which the other film sees what the pixels of a run see, in pixels from the left
    /// and from the top: no numbers if it is behind the other camera. The run has so many pixels from one on. `find`
    /// returns what they see. `sees` decides whether a pixel of the other film sees the same as one of the run. Pixels
    /// are counted row by row. The film has its memory from `memory`.
    pub fn new<P>(
        memory: &Memory,
        size: (u32, u32),
        find: impl Fn(usize, usize, &mut [Run; 2]) -> P + Sync,
        sees: impl Fn(usize, &P, usize) -> bool + Sync,
    ) -> Self {
        let width = size.0 as usize;
        let mut taps = memory.unset::<Taps>(width * size.1 as usize);
        taps.par_chunks_exact_mut(width.max(1)).enumerate().for_each(|(y, row)| {
            let (mut at, mut places) = ([[0.0; RUN]; 2], Places::default());
            for (x, taps) in (0..).step_by(RUN).zip(row.chunks_mut(RUN)) {
                let points = find(y * width + x, taps.len(), &mut at);
                dispatch(FindPlaces { at: &at, size, places: &mut places });
                for (index, taps) in taps.iter_mut().enumerate() {
                    let found = places.taps(index, width, |pixel| sees(pixel, &points, index));
                    let [across, down] = at.each_ref().map(|at| at[index]);
                    let away = [across - ((x + index) as f64 + 0.5), down - (y as f64 + 0.5)];
                    let is_centered = away.iter().all(|away| away.abs() < CENTERED);
                    *taps = Taps { is_still: is_centered && found.weights[0] == 1.0, ..found };
                }
            }
        });
        let is_partly_still = taps.iter().any(|taps| taps.is_still);
        Self { width, taps, is_partly_still }
    }

    /// That of a film in which nothing is hidden. `find` gives the position at which it sees what a pixel sees.
    pub(in super::super) fn unhidden(
        memory: &Memory,
        size: (u32, u32),
        find: impl Fn(usize) -> [f64; 2] + Sync,
    ) -> Self {
        let find = |first: usize, count: usize, at: &mut [Run; 2]| {
            for (index, pixel) in (first..).take(count).enumerate() {
                [at[0][index], at[1][index]] = find(pixel);
            }
        };
        Self::new(memory, size, find, |_, (), _| true)
    }

    /// The same without points that the same pixel sees at the same place.
    pub fn without_still(mut self) -> Self {
        self.taps.iter_mut().filter(|taps| taps.is_still).for_each(|taps| *taps = Taps::default());
        self.is_partly_still = false;
        self
    }

    /// Whether the point of a pixel is seen.
    pub fn sees(&self, [x, y]: [usize; 2]) -> bool {
        self.row(y)[x].is_seen()
    }

    /// The taps of the pixels of a row.
    pub(super) fn row(&self, y: usize) -> &[Taps] {
        &self.taps[y * self.width..][..self.width]
    }
}

/// The four pixels around each position of a run.
struct Places {
    /// The column on the left and the row above. -1 outside of the picture.
    before: [Run; 2],
    /// The weights of the pixels in bilinear interpolation, in the order of [`Taps`].
    shares: [Run; 4],
}

impl Default for Places {
    fn default() -> Self {
        Self { before: [[-1.0; RUN]; 2], shares: [[0.0; RUN]; 4] }
    }
}

impl Places {
    /// The taps of a pixel in a picture of this width. None have a weight outside of the picture.
    #[inline(always)]
    fn taps(&self, index: usize, width: usize, sees: impl Fn(usize) -> bool) -> Taps {
        let [column, row] = self.before.each_ref().map(|before| before[index]);
        if !(column >= 0.0 && row >= 0.0) {
            return Taps::default();
        }
        let (column, row) = (column as u32, row as u32);
        let first = row as usize * width + column as usize;
        let mut weights = [0.0; 4];
        for (tap, pixel) in [first, first + 1, first + width, first + width + 1].into_iter().enumerate() {
            let share = self.shares[tap][index];
            if share > 0.0 && sees(pixel) {
                weights[tap] = share as f32;
            }
        }
        let sum: f32 = weights.iter().sum();
        if sum > 0.0 {
            weights.iter_mut().for_each(|weight| *weight /= sum);
        }
        Taps { column, row, weights, is_still: false }
    }
}

/// Finds the pixels around positions.
struct FindPlaces<'a> {
    at: &'a [Run; 2],
    size: (u32, u32),
    places: &'a mut Places,
}

impl SimdKernel for FindPlaces<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { at, size, places: Places { before, shares } } = self;
        let one = L::F64::splat(1.0);
        for index in (0..RUN).step_by(L::F64::LANES) {
            let [x, y] = [L::F64::load(&at[0], index), L::F64::load(&at[1], index)];
            let (column, right) = between(x, size.0);
            let (row, below) = between(y, size.1);
            column.store(&mut before[0], index);
            row.store(&mut before[1], index);
            let (left, above) = (one - right, one - below);
            (left * above).store(&mut shares[0], index);
            (right * above).store(&mut shares[1], index);
            (left * below).store(&mut shares[2], index);
            (right * below).store(&mut shares[3], index);
        }
    }
}

/// The pixel before positions along an axis, -1 outside of the picture, and the weight of the pixel behind it, which is
/// 0 if there is none.
#[inline(always)]
fn between<F: Real>(at: F, count: u32) -> (F, F) {
    let (zero, half) = (F::splat(0.0), F::splat(0.5));
    let is_inside = zero.le(at) & at.le(F::splat(f64::from(count)));
    // Half a pixel at each edge is nearest to the pixel there.
    let center = (at - half).max(zero).min(F::splat(f64::from(count.saturating_sub(1))));
    let nearest = (center + half).floor();
    let center = F::select((center - nearest).abs().lt(F::splat(CENTERED)), nearest, center);
    let before = center.floor();
    (F::select(is_inside, before, F::splat(-1.0)), center - before)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The taps around a position in a picture of 4x3 pixels. None outside of it.
    fn taps_at(at: [f64; 2], sees: impl Fn(usize) -> bool) -> Option<Taps> {
        let mut places = Places::default();
        dispatch(FindPlaces { at: &at.map(|at| [at; RUN]), size: (4, 3), places: &mut places });
        let taps = places.taps(RUN - 1, 4, sees);
        (places.before[0][0] >= 0.0 && places.before[1][0] >= 0.0).then_some(taps)
    }

    fn taps(at: [f64; 2], hidden: Option<usize>) -> Option<Taps> {
        taps_at(at, |pixel| Some(pixel) != hidden)
    }

    #[test]
    fn taps_interpolate_between_centers() {
        let found = taps([2.0, 1.75], None).expect("inside");
        assert_eq!((found.column, found.row, found.weights), (1, 1, [0.375, 0.375, 0.125, 0.125]));
        let centered = taps([1.5 + 1e-9, 2.5], None).expect("inside");
        assert_eq!((centered.column, centered.row, centered.weights), (1, 2, [1.0, 0.0, 0.0, 0.0]));
        assert_eq!(taps([4.0, 0.0], None).expect("the corner").weights, [1.0, 0.0, 0.0, 0.0]);
        assert_eq!([taps([4.1, 1.0], None), taps([1.0, -0.1], None), taps([f64::NAN, 1.0], None)], [None; 3]);
    }

    #[test]
    fn hidden_pixels_have_no_weight() {
        let found = taps([2.0, 1.75], Some(5)).expect("inside");
        assert_eq!(found.weights, [0.0, 0.6, 0.2, 0.2]);
        let only = taps_at([2.0, 1.5], |pixel| pixel == 6).expect("inside");
        assert_eq!(only.weights, [0.0, 1.0, 0.0, 0.0]);
        assert!(!taps_at([2.0, 1.5], |_| false).expect("inside").is_seen());
    }

    #[test]
    fn pixels_that_see_the_same_are_still() {
        let shifted = |by: f64| {
            let find = |pixel: usize| [(pixel % 4) as f64 + 0.5 + by, (pixel / 4) as f64 + 0.5];
            Reprojection::unhidden(&Memory::default(), (4, 3), find)
        };
        assert!(shifted(0.0).taps.iter().all(|taps| taps.is_still));
        assert!(!shifted(1.0).is_partly_still && !shifted(0.25).is_partly_still);
        assert!(!shifted(9.0).row(2)[3].is_seen());
        assert!(!shifted(0.0).without_still().row(0)[0].is_seen());
        assert_eq!(shifted(0.25).without_still(), shifted(0.25));
    }
}
