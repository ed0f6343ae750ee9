//! The generate stage: camera rays.

use super::context::TraceContext;
use super::medium::OUTSIDE;
use super::stream::{PathState, PathStream, Throughput, flags};
use crate::base::lanes::{Bits, Level, Lookup, Mask, Real, Row, Select, SimdKernel, Vec3};
use crate::base::stats::Counts;
use crate::camera::{RayCone, screen_of};
use crate::sampling::{LaneSampler, Sampler, SamplerKind, dimension};

/// The samples of a wave. Each has a slot, its index in these columns.
#[derive(Default)]
pub struct PixelSamples {
    len: usize,
    x: Vec<u32>,
    y: Vec<u32>,
    /// The numbers of the samples within their pixels, as grids count them.
    number: Vec<u32>,
    /// What the random numbers depend on: the pixels' hashes, and the numbers of the samples in their runs.
    pixel_hash: Vec<u32>,
    sample: Vec<u32>,
    /// Positions in pixels from the left and from the top of the picture, if they are given.
    position: [Vec<f64>; 2],
}

/// Where the samples of a wave lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placement {
    /// On a regular grid in each pixel, with so many samples along each axis.
    Grid(u32),
    /// At random in each pixel.
    Random,
    /// At the positions that the samples have.
    Given,
}

impl PixelSamples {
    /// Without samples, with room for `size` of them.
    pub fn with_capacity(size: usize) -> Self {
        let size = size.next_multiple_of(8) + 8;
        let column = || vec![0; size];
        let position = [vec![0.0; size], vec![0.0; size]];
        Self {
            len: 0,
            x: column(),
            y: column(),
            number: column(),
            pixel_hash: column(),
            sample: column(),
            position,
        }
    }

    pub fn len(&self) -> usize {
        self.len
    }

    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// The numbers of the samples within their pixels.
    pub fn numbers(&self) -> &[u32] {
        &self.number[..self.len]
    }

    /// Adds a group. There must be room for it.
    #[inline]
    pub fn extend(&mut self, group: &SampleGroup) {
        // Eight numbers are copied at once. Those behind the group are overwritten later.
        let slots = self.len..self.len + 8;
        let Self { x, y, number, pixel_hash, sample, .. } = self;
        for (column, values) in [x, y, number, pixel_hash, sample].into_iter().zip(&group.columns) {
            column[slots.clone()].copy_from_slice(values);
        }
        self.len += group.count;
    }

    /// Adds a sample at a position of the picture. There must be room for it.
    #[inline]
    pub fn push_at(&mut self, [across, down]: [f64; 2], sampler: Sampler) {
        (self.pixel_hash[self.len], self.sample[self.len]) = (sampler.pixel_hash(), sampler.sample());
        (self.position[0][self.len], self.position[1][self.len]) = (across, down);
        self.len += 1;
    }

    /// The positions of eight samples from slot `first` on.
    #[inline(always)]
    fn positions<F: Real>(&self, first: usize) -> [F; 2] {
        [F::load(&self.position[0], first), F::load(&self.position[1], first)]
    }

    /// The samplers of the samples in these slots.
    #[inline(always)]
    pub fn sampler<F: Real>(&self, slots: F::U32, points: SamplerKind) -> LaneSampler<F> {
        let (slots, mut at) = (slots.to_array(), [0; 8]);
        for lane in 0..F::LANES {
            at[lane] = slots[lane];
        }
        let at = Lookup::new(&at[..F::LANES]);
        LaneSampler {
            pixel_hash: Row::gather(&self.pixel_hash, &at),
            sample: Row::gather(&self.sample, &at),
            kind: points,
        }
    }
}

/// Up to eight samples on their way into [`PixelSamples`].
#[derive(Default)]
pub struct SampleGroup {
    count: usize,
    /// x and y, numbers, and the keys of random numbers.
    columns: [[u32; 8]; 5],
    /// The indices of the samples' pixels.
    places: [u32; 8],
}

impl SampleGroup {
    /// Adds a sample of the pixel of an index. Returns whether the group is full.
    #[inline(always)]
    pub fn push(&mut self, place: u32, (x, y): (u32, u32), number: u32, sampler: Sampler) -> bool {
        let at = self.count & 7;
        let values = [x, y, number, sampler.pixel_hash(), sampler.sample()];
        for (column, value) in self.columns.iter_mut().zip(values) {
            column[at] = value;
        }
        self.places[at] = place;
        self.count += 1;
        self.count == 8
    }

    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// The numbers of the samples within their pixels.
    pub fn numbers(&self) -> &[u32] {
        &self.columns[2][..self.count]
    }

    pub fn places(&self) -> &[u32] {
        &self.places[..self.count]
    }
}

/// Starts a path along the camera ray of each sample, in the slot of that sample.
pub struct GenerateRays<'a> {
    pub context: &'a TraceContext<'a>,
    pub samples: &'a PixelSamples,
    pub placement: Placement,
    pub paths: &'a mut PathStream,
    pub counts: &'a mut Counts,
}

impl SimdKernel for GenerateRays<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { context, samples, placement, paths, counts } = self;
        let lens = context.scene.camera.lens.is_some();
        counts.rays.camera += samples.len() as u64;
        counts.evaluations.lens_samples += if lens { samples.len() as u64 } else { 0 };
        paths.clear();
        paths.reserve(samples.len());
        paths.set_depth(0);
        for first in (0..samples.len()).step_by(8) {
            let count = (samples.len() - first).min(8);
            let group = LaneSamples::<L::F64>::new(samples, first, count);
            let (position, lens) = match placement {
                Placement::Grid(across) => group.filtered(context, group.on_grid(across)),
                Placement::Random => group.filtered(context, group.at_random(context, lens)),
                Placement::Given => (samples.positions(first), [L::F64::splat(0.0); 2]),
            };
            let active = L::Mask::from_bits(0xff >> (8 - count));
            paths.push(active, &group.begin(context, position, lens));
        }
    }
}

/// Up to eight samples in lanes.
struct LaneSamples<F: Real> {
    left: F,
    top: F,
    number: F,
    pixel_hash: F::U32,
    sample: F::U32,
    slot: F::U32,
}

impl<F: Real> LaneSamples<F> {
    #[inline(always)]
    fn new(samples: &PixelSamples, first: usize, count: usize) -> Self {
        let at = Lookup::run(first as u32, count);
        let mut slots = [0; 8];
        for (lane, slot) in slots.iter_mut().enumerate() {
            *slot = at.lane(lane);
        }
        let (left, top): (F::U32, F::U32) = (Row::gather(&samples.x, &at), Row::gather(&samples.y, &at));
        let number: F::U32 = Row::gather(&samples.number, &at);
        Self {
            left: left.to_f64(),
            top: top.to_f64(),
            number: number.to_f64(),
            pixel_hash: Row::gather(&samples.pixel_hash, &at),
            sample: Row::gather(&samples.sample, &at),
            slot: Row::load(&slots, 0),
        }
    }

    /// The positions of grid samples in the unit square, before the filter spreads them. Grids have no lens.
    #[inline(always)]
    fn on_grid(&self, across: u32) -> [F; 4] {
        let (n, half, zero) = (F::splat(f64::from(across)), F::splat(0.5), F::splat(0.0));
        let row = (self.number / n).floor();
        let column = self.number - row * n;
        [(column + half) / n, (row + half) / n, zero, zero]
    }

    /// The positions of random samples in the unit square and on the lens.
    #[inline(always)]
    fn at_random(&self, context: &TraceContext, lens: bool) -> [F; 4] {
        let points = context.quality.points;
        let sampler = LaneSampler::<F> { pixel_hash: self.pixel_hash, sample: self.sample, kind: points };
        let camera = F::U32::splat(dimension::CAMERA);
        if lens {
            return sampler.numbers::<4>(camera);
        }
        let [x, y] = sampler.numbers::<2>(camera);
        [x, y, F::splat(0.0), F::splat(0.0)]
    }

    /// Spreads positions in the unit square by the filter around the centres of the pixels. Returns the positions in the
    /// picture, and those on the lens.
    #[inline(always)]
    fn filtered(&self, context: &TraceContext, [x, y, u, v]: [F; 4]) -> ([F; 2], [F; 2]) {
        let (filter, half) = (&context.settings.filter, F::splat(0.5));
        let across = self.left + (filter.offset(x) + half);
        let down = self.top + (filter.offset(y) + half);
        ([across, down], [u, v])
    }

    /// The paths through positions of the picture and of the lens.
    #[inline(always)]
    fn begin(&self, context: &TraceContext, [across, down]: [F; 2], lens: [F; 2]) -> PathState<F> {
        let camera = context.scene.camera;
        let (height, zero) = (F::splat(f64::from(context.settings.size.1)), F::splat(0.0));
        let ray = camera.rays::<F>(screen_of([across, down], context.settings.size), lens);
        let cone = match context.columns.cones {
            true => camera.cones(&ray, F::splat(2.0) / height),
            false => RayCone { width: zero, spread: zero },
        };
        let none = F::U32::splat(0);
        let from_eye = if context.aovs.is_some() || context.parts_rays { flags::FROM_EYE } else { 0 };
        let mut flags = F::U32::splat(from_eye);
        if let Some(guides) = context.guides {
            let specular = F::U32::splat(from_eye | flags::SPECULAR);
            flags = F::U32::select(self.number.lt(F::splat(f64::from(guides.end))), specular, flags);
        }
        PathState {
            ray,
            throughput: Throughput::full(),
            cone,
            scattered_at: Vec3::zero(),
            pdf: zero,
            key: none,
            slot: self.slot,
            bounces_left: F::U32::splat(context.quality.surfaces()),
            flags,
            medium: F::U32::splat(OUTSIDE),
            t_start: zero,
            pending: none,
        }
    }
}
