//! The generate stage: rays from the eye.

use super::context::TraceContext;
use super::medium::OUTSIDE;
use super::stream::{PathState, PathStream, Throughput, flags};
use crate::base::lanes::{Bits, Level, Lookup, Mask, Real, Row, SimdKernel, Vec3};
use crate::base::stats::Counts;
use crate::camera::RayCone;
use crate::sampling::{LaneSampler, Points, Sampler, dimension};

/// Samples of pixels that are followed together: each has a slot, its place among them.
#[derive(Default)]
pub struct PixelSamples {
    len: usize,
    x: Vec<u32>,
    y: Vec<u32>,
    /// The samples' numbers, as grids count them.
    number: Vec<u32>,
    /// By which random numbers are drawn: those of the pixels, and those of the samples.
    pixel: Vec<u32>,
    sample: Vec<u32>,
}

impl PixelSamples {
    /// With room for so many.
    pub fn with_capacity(size: usize) -> Self {
        let column = || vec![0; size.next_multiple_of(8)];
        Self { len: 0, x: column(), y: column(), number: column(), pixel: column(), sample: column() }
    }

    pub fn len(&self) -> usize {
        self.len
    }

    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Adds a group, for which there is room.
    #[inline]
    pub fn extend(&mut self, group: &SampleGroup) {
        let slots = self.len..self.len + group.count;
        let Self { x, y, number, pixel, sample, .. } = self;
        for (column, values) in [x, y, number, pixel, sample].into_iter().zip(&group.columns) {
            column[slots.clone()].copy_from_slice(&values[..group.count]);
        }
        self.len += group.count;
    }

    /// The random numbers of the samples in slots.
    #[inline(always)]
    pub fn sampler<F: Real>(&self, slots: F::U32, points: Points) -> LaneSampler<F> {
        let (slots, mut at) = (slots.to_array(), [0; 8]);
        for lane in 0..F::LANES {
            at[lane] = slots[lane];
        }
        let at = Lookup::new(&at[..F::LANES]);
        LaneSampler { pixel: Row::gather(&self.pixel, &at), sample: Row::gather(&self.sample, &at), points }
    }
}

/// Up to eight samples on their way into [`PixelSamples`].
#[derive(Default)]
pub struct SampleGroup {
    count: usize,
    /// x and y, numbers, and the pixels' and the samples' random numbers.
    columns: [[u32; 8]; 5],
    /// The places of the samples' pixels.
    places: [u32; 8],
}

impl SampleGroup {
    /// Adds a sample of the pixel at a place. Whether the group is full then.
    #[inline(always)]
    pub fn push(&mut self, place: u32, (x, y): (u32, u32), number: u32, sampler: Sampler) -> bool {
        let at = self.count & 7;
        let values = [x, y, number, sampler.pixel(), sampler.sample()];
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

    pub fn places(&self) -> &[u32] {
        &self.places[..self.count]
    }
}

/// Starts paths along the camera's rays through samples: the path of each takes the slot of its place among them.
pub struct Generate<'a> {
    pub context: &'a TraceContext<'a>,
    pub samples: &'a PixelSamples,
    /// Samples along each axis of a regular grid; none if they are placed at random.
    pub grid: Option<u32>,
    pub paths: &'a mut PathStream,
    pub counts: &'a mut Counts,
}

impl SimdKernel for Generate<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { context, samples, grid, paths, counts } = self;
        let lens = context.scene.camera.lens.is_some();
        counts.rays.camera += samples.len() as u64;
        counts.evaluations.lens_samples += if lens { samples.len() as u64 } else { 0 };
        paths.clear();
        paths.reserve(samples.len());
        paths.set_depth(0);
        for first in (0..samples.len()).step_by(8) {
            let count = (samples.len() - first).min(8);
            let group = Group::<L::F64>::new(samples, first, count);
            let place = match grid {
                Some(across) => group.on_grid(across),
                None => group.at_random(context, lens),
            };
            let there = L::Mask::from_bits(0xff >> (8 - count));
            paths.push(there, &group.begin(context, place));
        }
    }
}

/// Up to eight samples.
struct Group<F: Real> {
    left: F,
    top: F,
    number: F,
    pixel: F::U32,
    sample: F::U32,
    slot: F::U32,
}

impl<F: Real> Group<F> {
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
            pixel: Row::gather(&samples.pixel, &at),
            sample: Row::gather(&samples.sample, &at),
            slot: Row::load(&slots, 0),
        }
    }

    /// Where in the unit square samples of a regular grid lie before the filter spreads them. There is no lens.
    #[inline(always)]
    fn on_grid(&self, across: u32) -> [F; 4] {
        let (n, half, zero) = (F::splat(f64::from(across)), F::splat(0.5), F::splat(0.0));
        let row = (self.number / n).floor();
        let column = self.number - row * n;
        [(column + half) / n, (row + half) / n, zero, zero]
    }

    /// The same of samples at random, and where on the lens.
    #[inline(always)]
    fn at_random(&self, context: &TraceContext, lens: bool) -> [F; 4] {
        let points = context.quality.points;
        let sampler = LaneSampler::<F> { pixel: self.pixel, sample: self.sample, points };
        let camera = F::U32::splat(dimension::CAMERA);
        if lens {
            return sampler.numbers::<4>(camera);
        }
        let [x, y] = sampler.numbers::<2>(camera);
        [x, y, F::splat(0.0), F::splat(0.0)]
    }

    /// Paths through places of the pixels.
    #[inline(always)]
    fn begin(&self, context: &TraceContext, [x, y, u, v]: [F; 4]) -> PathState<F> {
        let (filter, camera) = (&context.settings.filter, context.scene.camera);
        let (width, height) = context.settings.size;
        let (width, height) = (F::splat(f64::from(width)), F::splat(f64::from(height)));
        let (half, two, zero) = (F::splat(0.5), F::splat(2.0), F::splat(0.0));
        let across = self.left + (filter.offset(x) + half);
        let down = self.top + (filter.offset(y) + half);
        // Square pixels: both axes in units of half the picture's height, from its centre.
        let screen = [(two * across - width) / height, (height - two * down) / height];
        let ray = camera.rays::<F>(screen, [u, v]);
        let cone = match context.columns.cones {
            true => camera.cones(&ray, two / height),
            false => RayCone { width: zero, spread: zero },
        };
        let none = F::U32::splat(0);
        let aov = if context.aovs.is_some() { flags::FROM_EYE } else { 0 };
        PathState {
            ray,
            throughput: Throughput::full(),
            cone,
            scattered_at: Vec3::zero(),
            pdf: zero,
            key: none,
            slot: self.slot,
            left: F::U32::splat(context.quality.surfaces()),
            flags: F::U32::splat(aov),
            medium: F::U32::splat(OUTSIDE),
            after: zero,
            pending: none,
        }
    }
}
