//! How much a neighbour's light is worth at each pixel.
//!
//! It is measured around the pixel, without the pixel itself, whose samples it weights. That is not quite all: light that is
//! interpolated, or compared with the pixels around it for outliers, shares samples with that of the next pixels.

use super::super::planes::Planes;
use super::super::surroundings::Sums;
use super::reprojection::Reprojection;
use crate::base::lanes::{Color, Level, Row, Select, SimdKernel, Single, dispatch};
use rayon::prelude::*;

/// How far the light of a neighbour is compared with that of the picture, in pixels along an axis: from afar, for means of
/// little noise, and from nearby, since shadows and highlights may have moved there alone.
const FAR: usize = 6;
const NEAR: usize = 2;

/// The most that a neighbour weighs. Interpolation takes the mean of four pixels at most.
const MOST: f32 = 4.0;

/// How many times changes count. Unlike noise, those of several neighbours may add up.
const ADDED_UP: f32 = 2.0;

/// What is measured at each pixel: whether the neighbour sees the point; the squared error of a half of the picture by
/// noise; that of the neighbour by noise, and by what has changed. Relative to the light; 0 if the point is not seen.
const PLANES: usize = 4;
const SEEN: usize = 0;
const NOISE: usize = 1;
const THEIR_NOISE: usize = 2;
const CHANGE: usize = 3;
const ERRORS: [usize; 3] = [NOISE, THEIR_NOISE, CHANGE];

/// The comparison of a picture with one neighbour after the other, in the same memory.
pub struct Agreement {
    measured: Planes,
}

impl Agreement {
    /// For pictures of the size of `light`.
    pub fn new(light: &Planes) -> Self {
        Self { measured: Planes::zeros(light.memory(), light.size(), PLANES) }
    }

    /// The weights of a neighbour at each pixel, relative to that of the picture's own samples: a plane. `own` is the
    /// light of both halves, of which the layer number `place` counts, and `theirs` that of the neighbour at the same
    /// points. `floor` is added to the squared light of a pixel.
    pub fn weights(
        &mut self,
        (own, place): ([&Planes; 2], usize),
        theirs: [&Planes; 2],
        by: &Reprojection,
        floor: f32,
    ) -> Planes {
        let Self { measured } = self;
        let stride = measured.stride;
        measured.par_lines_mut().enumerate().for_each(|(y, line)| {
            let seen = by.row(y).iter().map(|taps| if taps.is_seen() { 1.0 } else { 0.0 });
            line[SEEN * stride..][..stride].iter_mut().zip(seen).for_each(|(into, seen)| *into = seen);
            let own = own.map(|light| light.channels(place, y));
            dispatch(Compare { own, theirs: theirs.map(|light| light.channels(0, y)), floor, stride, line });
        });
        let mut weights = measured.unset_like(1);
        weights.par_lines_mut().enumerate().for_each_init(
            || (Sums::new(stride), vec![0.0; AROUND.len() * stride]),
            |(sums, around), (y, weights)| {
                for ((plane, reach), row) in AROUND.into_iter().zip(around.chunks_exact_mut(stride)) {
                    sums.add((measured, plane), (y, reach), row);
                }
                dispatch(Weigh { seen: measured.row(SEEN, y), around, weights });
            },
        );
        weights
    }
}

/// The planes that are summed around each pixel, and how far.
const AROUND: [(usize, usize); 6] =
    [(SEEN, FAR), (NOISE, FAR), (THEIR_NOISE, FAR), (CHANGE, FAR), (SEEN, NEAR), (CHANGE, NEAR)];

/// Compares a row of light: of both halves of the picture, and of both halves of the neighbour.
struct Compare<'a> {
    own: [[&'a [f32]; 3]; 2],
    theirs: [[&'a [f32]; 3]; 2],
    floor: f32,
    stride: usize,
    /// All planes of the row. What is seen is known.
    line: &'a mut [f32],
}

impl SimdKernel for Compare<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { own, theirs, floor, stride, line } = self;
        let [zero, half, one] = [0.0, 0.5, 1.0].map(L::F32::splat);
        for x in (0..stride).step_by(L::F32::LANES) {
            let [a, b] = [Color::<L::F32>::load(own[0], x), Color::load(own[1], x)];
            let [c, d] = [Color::<L::F32>::load(theirs[0], x), Color::load(theirs[1], x)];
            let light = (a + b).element_sum() * half;
            let unit = one / (light * light + L::F32::splat(floor));
            let errors =
                [(a - b).length_squared() * half, (c - d).length_squared() * half, (c - a).dot(d - b)];
            let mut is_compared = zero.lt(L::F32::load(line, SEEN * stride + x));
            for error in errors {
                // Light that overflows cannot be compared.
                is_compared = is_compared & (error * unit).abs().lt(L::F32::splat(f32::INFINITY));
            }
            L::F32::select(is_compared, one, zero).store(line, SEEN * stride + x);
            for (plane, error) in ERRORS.into_iter().zip(errors) {
                L::F32::select(is_compared, error * unit, zero).store(line, plane * stride + x);
            }
        }
    }
}

/// The weights of a row, from what has been measured around each pixel.
struct Weigh<'a> {
    seen: &'a [f32],
    /// The rows of [`AROUND`].
    around: &'a [f32],
    weights: &'a mut [f32],
}

impl SimdKernel for Weigh<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { seen, around, weights } = self;
        let (zero, stride) = (L::F32::splat(0.0), weights.len());
        for x in (0..stride).step_by(L::F32::LANES) {
            let mut sums = [zero; AROUND.len()];
            for (row, sum) in sums.iter_mut().enumerate() {
                *sum = L::F32::load(around, row * stride + x);
            }
            let [all, noise, theirs, change, near, change_near] = sums;
            let change_near = L::F32::select(zero.lt(near), change_near * all / near, zero);
            let change = change.max(change_near).max(zero);
            let error = theirs + L::F32::splat(ADDED_UP) * change;
            let weight = noise / error.max(noise * L::F32::splat(1.0 / MOST));
            let is_weighted = zero.lt(L::F32::load(seen, x)) & zero.lt(noise);
            L::F32::select(is_weighted, weight, zero).store(weights, x);
        }
    }
}
