//! How much a neighbour's light is worth at each pixel.
//!
//! It is measured around the pixel, without the pixel itself, whose samples it weights. That is not quite all: light that is
//! interpolated, or compared with the pixels around it for outliers, shares samples with that of the next pixels.

use super::super::halves::OF_LAYER;
use super::super::planes::{Planes, channels};
use super::super::surroundings::Sums;
use super::Neighbor;
use super::reprojection::{AHEAD, Taps};
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

/// The rows that are in memory while they are compared: at least those around a row.
const ROWS: usize = (2 * FAR + 1).next_power_of_two();

/// The fewest rows that are compared one after the other. Those around them are compared twice.
const BATCH: usize = 4 * ROWS;

/// Compares both halves of a picture with those of neighbours.
pub struct Agreement<'a> {
    /// The light of a picture.
    pub own: &'a [Planes; 2],
    /// The number of the layer that counts.
    pub place: usize,
    /// What is added to the squared light of a pixel.
    pub floor: f32,
}

impl Agreement<'_> {
    /// Adds a layer of light of a neighbour to that of the picture, `sums`, and returns its weights at each pixel,
    /// relative to that of the picture's own samples: a plane. Rows are weighted as soon as those below are compared,
    /// so what is measured of them is still in the cache.
    pub fn add_weighted(&self, neighbor: &Neighbor, their_place: usize, sums: &mut [Planes; 2]) -> Planes {
        let [light, _] = self.own;
        let (height, stride) = (light.height, light.stride);
        let mut weights = light.unset_like(1);
        let [first, second] = sums;
        let of_batch = height.div_ceil(rayon::current_num_threads()).max(BATCH);
        let bands =
            weights.bands_mut(of_batch).zip(first.bands_mut(of_batch)).zip(second.bands_mut(of_batch));
        let bands: Vec<_> = bands.collect();
        bands.into_par_iter().enumerate().for_each_init(
            || Workspace::new(light),
            |workspace, (band, ((weights, first), second))| {
                let halves = first.chunks_exact_mut(3 * stride).zip(second.chunks_exact_mut(3 * stride));
                let first = band * of_batch;
                let mut compared = first.saturating_sub(FAR);
                for (y, (weights, (first, second))) in
                    (first..).zip(weights.chunks_exact_mut(stride).zip(halves))
                {
                    let below = height.min(y + FAR + 1);
                    (compared..below).for_each(|y| workspace.compare(self, (neighbor, their_place), y));
                    compared = below;
                    workspace.add_weighted((y, height), weights, [first, second]);
                }
            },
        );
        weights
    }
}

/// What a batch works with. Each row takes the place of an earlier one.
struct Workspace {
    /// The light of both halves of the neighbour at the points of the pixels; zero where it does not see them.
    seen: Planes,
    measured: Planes,
    sums: Sums,
    around: Vec<f32>,
}

impl Workspace {
    /// For pictures of the size of `light`.
    fn new(light: &Planes) -> Self {
        let planes = |count: usize| Planes::unset(light.memory(), (light.width, ROWS), count);
        let (sums, around) = (Sums::new(light.stride), vec![0.0; AROUND * light.stride]);
        Self { seen: planes(HALVES * 3), measured: planes(PLANES), sums, around }
    }

    /// Compares a row.
    fn compare(&mut self, agreement: &Agreement, (neighbor, their_place): (&Neighbor, usize), y: usize) {
        let Agreement { own, place, floor } = agreement;
        let (stride, width) = (self.measured.stride, self.measured.width);
        let Neighbor { halves, reprojection } = neighbor;
        let from =
            Light { numbers: &halves.dimmed, layers: halves.film().held.len(), layer: their_place, width };
        let (seen, line) = (self.seen.line_mut(y % ROWS), self.measured.line_mut(y % ROWS));
        let is_seen = &mut line[SEEN * stride..][..stride];
        dispatch(See { from, taps: reprojection.row(y), seen, is_seen });
        let [c, d] = [0, 1].map(|half| channels(&seen[half * 3 * stride..][..3 * stride]));
        let own = own.each_ref().map(|light| light.channels(*place, y));
        dispatch(Compare { own, theirs: [c, d], floor: *floor, stride, line });
    }

    /// Weights a row of a picture of that height, and adds its light.
    fn add_weighted(
        &mut self,
        (y, height): (usize, usize),
        weights: &mut [f32],
        light: [&mut [f32]; HALVES],
    ) {
        let Self { seen, measured, sums, around } = self;
        let stride = measured.stride;
        let (far, near) = around.split_at_mut(PLANES * stride);
        for (plane, row) in far.chunks_exact_mut(stride).enumerate() {
            sums.add::<FAR>(measured, plane, (y, height), row);
        }
        for (plane, row) in [SEEN, CHANGE].into_iter().zip(near.chunks_exact_mut(stride)) {
            sums.add::<NEAR>(measured, plane, (y, height), row);
        }
        let theirs = [0, 1].map(|half| seen.channels(half, y % ROWS));
        let seen = measured.row(SEEN, y % ROWS);
        dispatch(Weigh { seen, around, weights, light: theirs, sums: light });
    }
}

/// The halves of a picture.
const HALVES: usize = 2;

/// A layer of light of both halves of a picture, without outliers.
#[derive(Clone, Copy)]
struct Light<'a> {
    numbers: &'a [f32],
    layers: usize,
    layer: usize,
    width: usize,
}

/// Sees the points of a row of pixels.
struct See<'a> {
    from: Light<'a>,
    taps: &'a [Taps],
    seen: &'a mut [f32],
    is_seen: &'a mut [f32],
}

impl SimdKernel for See<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { from: Light { numbers, layers, layer, width }, taps, seen, is_seen } = self;
        let (stride, layer) = (is_seen.len(), (layer * OF_LAYER, layers * OF_LAYER));
        for x in (0..stride).step_by(L::F32::LANES) {
            let (mut pixels, mut are_seen) = ([L::F32::splat(0.0); OF_LAYER], [0.0; OF_LAYER]);
            for soon in taps.iter().skip(x + AHEAD).take(L::F32::LANES) {
                soon.prefetch::<L>(numbers, layer, width);
            }
            for (lane, taps) in taps.iter().skip(x).take(L::F32::LANES).enumerate() {
                pixels[lane] = taps.sum::<L::F32>(numbers, layer, width);
                are_seen[lane] = if taps.is_seen() { 1.0 } else { 0.0 };
            }
            L::F32::load(&are_seen, 0).store(is_seen, x);
            let [a, b, c, _, d, e, f, _] = L::transpose(pixels);
            for (channel, light) in [a, b, c, d, e, f].into_iter().enumerate() {
                light.store(seen, channel * stride + x);
            }
        }
    }
}

/// The sums around each pixel: all planes from afar, and two from nearby.
const AROUND: usize = PLANES + 2;

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

/// The weights of a row, from what has been measured around each pixel, and the sums of the light with these weights.
struct Weigh<'a> {
    seen: &'a [f32],
    /// Rows of sums: those of all planes, and those of what is seen and of changes nearby.
    around: &'a [f32],
    weights: &'a mut [f32],
    light: [[&'a [f32]; 3]; HALVES],
    sums: [&'a mut [f32]; HALVES],
}

impl SimdKernel for Weigh<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { seen, around, weights, light, sums: [first, second] } = self;
        let (zero, stride) = (L::F32::splat(0.0), weights.len());
        for x in (0..stride).step_by(L::F32::LANES) {
            let mut sums = [zero; AROUND];
            for (row, sum) in sums.iter_mut().enumerate() {
                *sum = L::F32::load(around, row * stride + x);
            }
            let [all, noise, theirs, change, near, change_near] = sums;
            let change_near = L::F32::select(zero.lt(near), change_near * all / near, zero);
            let change = change.max(change_near).max(zero);
            let error = theirs + L::F32::splat(ADDED_UP) * change;
            let weight = noise / error.max(noise * L::F32::splat(1.0 / MOST));
            let is_weighted = zero.lt(L::F32::load(seen, x)) & zero.lt(noise);
            let weight = L::F32::select(is_weighted, weight, zero);
            weight.store(weights, x);
            // Without weight, light may be infinite.
            let is_added = zero.lt(weight);
            for (light, sums) in light.iter().zip([&mut *first, &mut *second]) {
                for (channel, light) in light.iter().enumerate() {
                    let at = channel * stride + x;
                    let more = L::F32::select(is_added, L::F32::load(light, x) * weight, zero);
                    (L::F32::load(sums, at) + more).store(sums, at);
                }
            }
        }
    }
}
