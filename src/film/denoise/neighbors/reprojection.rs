//! Where another film of the same size sees the points that the pixels of a film see.

use super::super::memory::{Held, Memory};
use crate::base::lanes::{Bits, Level, Mask, Real, Row, Select, SimdKernel, Single, dispatch};
use rayon::prelude::*;
use std::array::from_fn;

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

    /// Prefetches numbers for [`Taps::sum`]: those of the last pixel. The others have mostly been read for the pixels
    /// before and above.
    #[inline(always)]
    pub fn prefetch<L: Level>(&self, numbers: &[f32], (first, count): (usize, usize), width: usize) {
        let last = (self.row as usize + 1) * width + self.column as usize + 1;
        L::prefetch(numbers, last * count + first);
    }

    /// The weighted sums of eight numbers of each pixel, from the number `first` on. Pixels of a picture of this width
    /// have `count` numbers.
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

/// What the pixels of a film see, and how others see that. Pixels are counted row by row.
pub trait Views: Sync {
    /// What the pixels of a run see.
    type Points: Clone + Send;

    /// Memory for what a run sees.
    const UNSEEN: Self::Points;

    /// What the pixels of a run see. It has so many pixels from one on.
    fn see(&self, first: usize, count: usize, points: &mut Self::Points);

    /// The positions at which another film sees these points, in pixels from the left and from the top: no numbers if
    /// they are behind its camera. `moved` becomes the points as that film sees them.
    fn find(&self, film: usize, points: &Self::Points, moved: &mut Self::Points, at: &mut [Run; 2]);

    /// Prefetches what the pixels of a film see, for [`Views::hide`].
    fn prefetch(&self, _film: usize, _places: &Places) {}

    /// Takes the shares of the pixels of a film that see something else than these points.
    fn hide(&self, film: usize, moved: &Self::Points, places: &mut Places);
}

/// How a film sees a run of pixels of another one.
#[derive(Clone)]
struct View<P> {
    moved: P,
    at: [Run; 2],
    places: Places,
}

#[warn(missing_docs)]
impl Reprojection {
    pub(super) const BYTES_PER_PIXEL: u64 = size_of::<Taps>() as u64;

    /// Where so many other films see what a film of this size sees. All have their memory from `memory`, and are found
    /// run by run, so what the pixels of a run see is read once, and what others see is on its way meanwhile.
    pub fn all<V: Views>(memory: &Memory, size: (u32, u32), films: usize, views: &V) -> Vec<Self> {
        let (width, pixels) = (size.0 as usize, size.0 as usize * size.1 as usize);
        let mut all: Vec<Held<Taps>> = (0..films).map(|_| memory.unset(pixels)).collect();
        let mut rows: Vec<Vec<&mut [Taps]>> = (0..size.1).map(|_| Vec::with_capacity(films)).collect();
        for taps in &mut all {
            let of_film = taps.chunks_exact_mut(width.max(1));
            rows.iter_mut().zip(of_film).for_each(|(row, taps)| row.push(taps));
        }
        let unseen = || {
            let places = Places { corner: [[0; RUN]; 2], pixels: [[0; RUN]; 4], shares: [[0.0; RUN]; 4] };
            (V::UNSEEN, vec![View { moved: V::UNSEEN, at: [[0.0; RUN]; 2], places }; films])
        };
        let are_still = rows.into_par_iter().enumerate().map_init(unseen, |(points, seen), (y, mut row)| {
            let mut are_still = vec![false; films];
            for x in (0..width).step_by(RUN) {
                let count = RUN.min(width - x);
                views.see(y * width + x, count, points);
                for (film, View { moved, at, places }) in seen.iter_mut().enumerate() {
                    views.find(film, points, moved, at);
                    dispatch(FindPlaces { at, size, places });
                    views.prefetch(film, places);
                }
                let seen = seen.iter_mut().zip(&mut row).zip(&mut are_still).enumerate();
                for (film, ((View { moved, at, places }, row), is_still)) in seen {
                    views.hide(film, moved, places);
                    *is_still |= dispatch(Weigh { at, places, pixel: [x, y], taps: &mut row[x..][..count] });
                }
            }
            are_still
        });
        let either = |mut all: Vec<bool>, more: Vec<bool>| {
            all.iter_mut().zip(more).for_each(|(one, more)| *one |= more);
            all
        };
        let are_still = are_still.reduce(|| vec![false; films], either);
        let all = all.into_iter().zip(are_still);
        all.map(|(taps, is_partly_still)| Self { width, taps, is_partly_still }).collect()
    }

    /// That of a film in which nothing is hidden. `find` gives the position at which it sees what a pixel sees.
    pub(in super::super) fn unhidden(
        memory: &Memory,
        size: (u32, u32),
        find: impl Fn(usize) -> [f64; 2] + Sync,
    ) -> Self {
        let mut all = Self::all(memory, size, 1, &Unhidden { find });
        all.swap_remove(0)
    }

    /// The same without points that the same pixel sees at the same place.
    pub fn without_still(mut self) -> Self {
        if !self.is_partly_still {
            return self;
        }
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

/// A film in which nothing is hidden: finds the position at which it sees what a pixel sees.
struct Unhidden<F> {
    find: F,
}

impl<F: Fn(usize) -> [f64; 2] + Sync> Views for Unhidden<F> {
    /// The pixels of a run: the first one, and how many there are.
    type Points = (usize, usize);

    const UNSEEN: Self::Points = (0, 0);

    fn see(&self, first: usize, count: usize, points: &mut Self::Points) {
        *points = (first, count);
    }

    fn find(&self, _: usize, &(first, count): &Self::Points, _: &mut Self::Points, at: &mut [Run; 2]) {
        for (index, pixel) in (first..).take(count).enumerate() {
            [at[0][index], at[1][index]] = (self.find)(pixel);
        }
    }

    fn hide(&self, _: usize, _: &Self::Points, _: &mut Places) {}
}

/// The four pixels around each position of a run, in the order of `Taps`.
#[derive(Clone)]
#[warn(missing_docs)]
pub struct Places {
    /// The column on the left and the row above.
    corner: [[u32; RUN]; 2],
    /// The pixels, counted row by row. One that has no share is any other of the picture.
    pub pixels: [[u32; RUN]; 4],
    /// The weights of the pixels in bilinear interpolation. Outside of the picture, they are 0.
    pub shares: [Run; 4],
}

impl Places {
    /// The last one of the pixels around a position.
    pub const LAST: usize = 3;
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
        let Self { at, size: (width, height), places: Places { corner, pixels, shares } } = self;
        let (zero, one) = (L::F64::splat(0.0), L::F64::splat(1.0));
        let (next, below) = (L::U32::splat(1), L::U32::splat(width));
        for index in (0..RUN).step_by(L::F64::LANES) {
            let (column, right, is_across) = between(L::F64::load(&at[0], index), width);
            let (row, down, is_down) = between(L::F64::load(&at[1], index), height);
            let is_inside = is_across & is_down;
            let [column, row] = [
                L::F64::select(is_inside, column, zero).to_u32(),
                L::F64::select(is_inside, row, zero).to_u32(),
            ];
            column.store(&mut corner[0], index);
            row.store(&mut corner[1], index);
            let first = row.wrapping_mul(below).wrapping_add(column);
            let under = first.wrapping_add(below);
            let (left, up) = (one - right, one - down);
            let all = [
                (first, left * up),
                (first.wrapping_add(next), right * up),
                (under, left * down),
                (under.wrapping_add(next), right * down),
            ];
            for (tap, (pixel, share)) in all.into_iter().enumerate() {
                let share = L::F64::select(is_inside, share, zero);
                share.store(&mut shares[tap], index);
                // Without a share, it may be beyond the edge.
                L::U32::select(zero.lt(share), pixel, first).store(&mut pixels[tap], index);
            }
        }
    }
}

/// Weights pixels by their shares, so that weights add up to 1. Returns whether any point is seen by the same pixel.
struct Weigh<'a> {
    at: &'a [Run; 2],
    places: &'a Places,
    /// Column and row of the first pixel of the run.
    pixel: [usize; 2],
    taps: &'a mut [Taps],
}

impl SimdKernel for Weigh<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Level>(self) -> bool {
        let Self { at: [across, down], places: Places { corner, shares, .. }, pixel: [x, y], taps } = self;
        let (zero, one) = (L::F32::splat(0.0), L::F32::splat(1.0));
        let (near, middle) = (L::F64::splat(CENTERED), L::F64::splat(y as f64 + 0.5));
        let mut is_partly_still = false;
        for (first, taps) in (0..RUN).step_by(L::F32::LANES).zip(taps.chunks_mut(L::F32::LANES)) {
            let mut all = [zero; 4];
            for (share, weight) in shares.iter().zip(&mut all) {
                *weight = L::F64::load(share, first).to_f32();
            }
            let sum = all[0] + all[1] + all[2] + all[3];
            let is_seen = zero.lt(sum);
            let mut weights = [[0.0; 8]; 4];
            for (weight, into) in all.iter_mut().zip(&mut weights) {
                *weight = L::F32::select(is_seen, *weight / sum, zero);
                *into = weight.to_array();
            }
            let centers = L::F64::from_array(from_fn(|lane| (x + first + lane) as f64 + 0.5));
            let away = [L::F64::load(across, first) - centers, L::F64::load(down, first) - middle];
            let is_centered = away[0].abs().lt(near) & away[1].abs().lt(near);
            let are_still = (is_centered & one.le(all[0]) & all[0].le(one)).bits();
            for (lane, taps) in taps.iter_mut().enumerate() {
                let [column, row] = corner.each_ref().map(|corner| corner[first + lane]);
                let weights = weights.each_ref().map(|weights| weights[lane]);
                let is_still = are_still >> lane & 1 == 1;
                *taps = Taps { column, row, weights, is_still };
                is_partly_still |= is_still;
            }
        }
        is_partly_still
    }
}

/// The pixel before positions along an axis, the weight of the pixel behind it, which is 0 if there is none, and
/// whether they are in the picture.
#[inline(always)]
fn between<F: Real>(at: F, count: u32) -> (F, F, F::Mask) {
    let (zero, half) = (F::splat(0.0), F::splat(0.5));
    let is_inside = zero.le(at) & at.le(F::splat(f64::from(count)));
    // Half a pixel at each edge is nearest to the pixel there.
    let center = (at - half).max(zero).min(F::splat(f64::from(count.saturating_sub(1))));
    let nearest = (center + half).floor();
    let center = F::select((center - nearest).abs().lt(F::splat(CENTERED)), nearest, center);
    let before = center.floor();
    (before, center - before, is_inside)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A film that sees all points at one position, with some of its pixels.
    struct PartlyHidden<F> {
        at: [f64; 2],
        sees: F,
    }

    impl<F: Fn(usize) -> bool + Sync> Views for PartlyHidden<F> {
        type Points = ();

        const UNSEEN: () = ();

        fn see(&self, _: usize, _: usize, (): &mut ()) {}

        fn find(&self, _: usize, (): &(), (): &mut (), at: &mut [Run; 2]) {
            *at = self.at.map(|at| [at; RUN]);
        }

        fn hide(&self, _: usize, (): &(), places: &mut Places) {
            for (shares, pixels) in places.shares.iter_mut().zip(&places.pixels) {
                let hidden =
                    shares.iter_mut().zip(pixels).filter(|(_, pixel)| !(self.sees)(**pixel as usize));
                hidden.for_each(|(share, _)| *share = 0.0);
            }
        }
    }

    /// The taps around a position in a picture of 4x3 pixels. None outside of it.
    fn taps_at(at: [f64; 2], sees: impl Fn(usize) -> bool + Sync) -> Option<Taps> {
        let views = PartlyHidden { at, sees };
        let found = Reprojection::all(&Memory::default(), (4, 3), 1, &views).remove(0);
        let [across, down] = at;
        ((0.0..=4.0).contains(&across) && (0.0..=3.0).contains(&down)).then(|| found.taps[11])
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
