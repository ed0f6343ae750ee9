//! A film that is shown while it is traced: first few pixels, then all, then more samples of each.
//!
//! No sample is traced twice. The samples of a pixel are added in their order, so the sums are those of
//! [`super::trace`] at the same number of samples.

use super::ONE_EACH;
use super::adaptive::halves::SampleHalves;
use super::pixels::{PixelTracer, SampleSet};
use super::settings::{Moment, TraceSettings};
use crate::base::cancel::Stop;
use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::base::stats::{Counts, RayCounts};
use crate::camera::Camera;
use crate::film::{AovSet, Film, LayerId, lit};
use crate::scene::Scene;
use crate::scene::top_level::Bvh;
use rayon::prelude::*;
use std::ops::Range;

/// Columns and rows of a tile. The work between two checks of a stop is at most a sample of all its pixels.
const TILE: (u32, u32) = (32, 16);

/// Distances of the pixels that have their first sample, step by step.
const STRIDES: [u32; 3] = [4, 2, 1];

/// How far a film is traced: the pixels that have samples, and the number of their samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Refinement {
    /// The number of steps towards the first sample of every pixel: 1 for every fourth pixel of every fourth row, 2 for
    /// every second one, 3 for all.
    pub steps: usize,
    /// Samples of each pixel, at least 1. More than 1 only after the last step.
    pub samples: u32,
}

impl Refinement {
    pub const FIRST: Self = Self { steps: 1, samples: 1 };
    /// One sample of every pixel.
    pub const ALL_PIXELS: Self = Self { steps: STRIDES.len(), samples: 1 };

    /// The next stage, until pixels have `most` samples: more pixels, then twice the samples. None after the last.
    pub fn next(self, most: u32) -> Option<Self> {
        match self {
            Self { steps, .. } if steps < STRIDES.len() => Some(Self { steps: steps + 1, ..self }),
            Self { samples, .. } if samples < most => {
                Some(Self { samples: samples.saturating_mul(2).min(most), ..self })
            }
            _ => None,
        }
    }

    /// The width in pixels of a cell of the picture.
    pub fn stride(self) -> u32 {
        STRIDES[self.steps.clamp(1, STRIDES.len()) - 1]
    }
}

/// A film in progress.
#[derive(Clone, Debug)]
pub struct ProgressiveFilm {
    size: (u32, u32),
    aovs: AovSet,
    /// The number of all layers of light.
    lights: usize,
    /// The layers of light that are traced, ascending.
    lit: Vec<LayerId>,
    tiles: Vec<Tile>,
    /// What is complete; none before the first stage.
    done: Option<Refinement>,
    /// Samples of the first half, for the error. 0 if there is none.
    half: u32,
}

#[derive(Clone, Debug)]
struct Tile {
    /// The pixels, in the order of their steps.
    places: Vec<(u32, u32)>,
    /// The number of places of the first steps.
    ends: [usize; STRIDES.len()],
    /// All layers of each place: the sums of all samples, and of the first half.
    sums: Vec<DVec3>,
    first: Vec<DVec3>,
    steps: usize,
    drawn: u32,
}

/// The moments of a frame cannot be continued after a stop in between: then its film has lost its meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StageEnd {
    Complete,
    /// Stopped; the same stage continues where it was.
    Stopped,
}

impl ProgressiveFilm {
    /// An empty film of `lights` layers of light, of which `lit` are traced.
    pub fn new(settings: &TraceSettings, lights: usize, lit: Vec<LayerId>) -> Self {
        let (width, height) = settings.size;
        let layers = lights + settings.aovs.layers();
        let tops = (0..height).step_by(TILE.1 as usize);
        let corner = |top: u32| (0..width).step_by(TILE.0 as usize).map(move |left| (left, top));
        let tiles = tops.flat_map(corner).map(|corner| Tile::new(corner, settings.size, layers)).collect();
        Self { size: settings.size, aovs: settings.aovs, lights, lit, tiles, done: None, half: 0 }
    }

    /// What is complete.
    pub fn done(&self) -> Option<Refinement> {
        self.done
    }

    /// The layers of light that are traced.
    pub fn lit(&self) -> &[LayerId] {
        &self.lit
    }

    /// The number of all layers of light, traced or not.
    pub fn lights(&self) -> usize {
        self.lights
    }

    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> u64 {
        Self::bytes_of(self.size, self.lights + self.aovs.layers())
    }

    /// Bytes of a film of this size and number of layers.
    pub fn bytes_of((width, height): (u32, u32), layers: usize) -> u64 {
        let pixel = 2 * layers * size_of::<DVec3>() + size_of::<(u32, u32)>();
        u64::from(width) * u64::from(height) * pixel as u64
    }

    /// Keeps the sums so far as the first half of the samples, for [`ProgressiveFilm::error`].
    pub fn begin_half(&mut self) {
        if let Some(done) = self.done.filter(|done| *done >= Refinement::ALL_PIXELS) {
            self.half = done.samples;
            self.tiles.par_iter_mut().for_each(|tile| tile.first.clone_from(&tile.sums));
        }
    }

    /// Traces the samples of one moment up to a stage. The last moment completes it. In a cross-fade, `before` is the camera
    /// before the cut, with its share of the light.
    pub fn trace(
        &mut self,
        (scene, before): (&Scene, Option<(&Camera, f64)>),
        bvh: &Bvh,
        settings: &TraceSettings,
        (moment, random): (Moment, bool),
        goal: Refinement,
        stop: &Stop,
    ) -> (StageEnd, Counts) {
        let other = before.map(|(camera, share)| (Scene { camera, ..*scene }, share));
        let tracer = |scene| {
            let mut pixels = PixelTracer::new(scene, bvh, settings, moment);
            pixels.random = random;
            pixels
        };
        let other = other.as_ref().map(|(scene, share)| (tracer(scene), *share));
        let pixels = FadedPixels { pixels: tracer(scene), before: other };
        let last = moment.index + 1 == moment.of;
        let tiles = self.tiles.par_iter_mut().with_max_len(ONE_EACH);
        let counts = tiles.map(|tile| tile.trace(&pixels, goal, last, stop));
        let counts = counts.reduce(Counts::default, |mut a, b| {
            a += b;
            a
        });
        if stop.signal().is_some() {
            return (StageEnd::Stopped, counts);
        }
        if last {
            self.done = Some(goal);
        }
        (StageEnd::Complete, counts)
    }

    /// The film as it is, weighted. Before every pixel has a sample, it is smaller by the stride of its stage. None
    /// before the first stage.
    pub fn film(&self, weights: &[Rgb]) -> Option<Film> {
        let done = self.done?;
        let stride = done.stride();
        let (width, height) = (self.size.0.div_ceil(stride), self.size.1.div_ceil(stride));
        // The layers that are traced decide what the film holds.
        let mut traced = vec![Rgb::ZERO; self.lights];
        self.lit.iter().for_each(|layer| traced[layer.index()] = Rgb::ONE);
        let mut film = Film::with_aovs(width, height, traced, self.aovs);
        let held: Vec<usize> = lit(&film.weights).map(LayerId::index).collect();
        let held: Vec<usize> = held.into_iter().chain(self.lights..self.layers()).collect();
        let data = film.data_mut();
        for tile in &self.tiles {
            let end = tile.ends[done.steps - 1];
            for (place, sums) in tile.places[..end].iter().zip(tile.sums.chunks_exact(self.layers())) {
                let at = (place.1 / stride * width + place.0 / stride) as usize * held.len();
                for (value, &layer) in data[at..].iter_mut().zip(&held) {
                    // As the tracer of whole frames divides, so that the bytes are equal.
                    *value = match tile.drawn {
                        0 | 1 => sums[layer].as_vec3(),
                        drawn => (sums[layer] / f64::from(drawn)).as_vec3(),
                    };
                }
            }
        }
        Some(film.weighted_by(weights))
    }

    /// The estimated error of the film: the root mean square over pixels and colours, as a share of the mean. None
    /// without two halves of random samples.
    pub fn error(&self, weights: &[Rgb]) -> Option<f64> {
        let (mut square, mut mean) = (0.0, 0.0);
        let pixels = f64::from(self.size.0) * f64::from(self.size.1);
        self.each_error(weights, |_, error, value| {
            square += error / pixels;
            mean += value / pixels;
        })?;
        (mean > 0.0).then(|| square.sqrt() / mean)
    }

    /// The estimated error of each pixel, row by row, as a share of the mean of the film. None as for
    /// [`ProgressiveFilm::error`].
    pub fn error_map(&self, weights: &[Rgb]) -> Option<Vec<f32>> {
        let mut errors = vec![0.0; self.size.0 as usize * self.size.1 as usize];
        let mut mean = 0.0;
        let count = errors.len() as f64;
        self.each_error(weights, |(x, y), error, value| {
            errors[(y * self.size.0 + x) as usize] = error.sqrt();
            mean += value / count;
        })?;
        let scale = if mean > 0.0 { 1.0 / mean } else { 0.0 };
        Some(errors.into_iter().map(|error| (error * scale) as f32).collect())
    }

    /// Passes the squared error and the mean over colours of each pixel to `take`.
    fn each_error(&self, weights: &[Rgb], mut take: impl FnMut((u32, u32), f64, f64)) -> Option<()> {
        let done = self.done?;
        if self.half == 0 || done.samples <= self.half {
            return None;
        }
        let halves = SampleHalves::new(self.half, done.samples);
        let factor = halves.factor() / 3.0;
        let layers = self.layers();
        for tile in &self.tiles {
            let sums = tile.sums.chunks_exact(layers).zip(tile.first.chunks_exact(layers));
            for (place, (all, first)) in tile.places.iter().zip(sums) {
                let weighted = |sums: &[DVec3]| -> DVec3 {
                    let lit = self.lit.iter().map(|layer| layer.index());
                    lit.map(|layer| weights[layer].as_dvec3() * sums[layer]).sum()
                };
                let (all, first) = (weighted(all), weighted(first));
                let error = factor * halves.difference(first, all).length_squared();
                take(*place, error, all.element_sum() / (3.0 * halves.count()));
            }
        }
        Some(())
    }

    fn layers(&self) -> usize {
        self.lights + self.aovs.layers()
    }
}

impl Tile {
    fn new((left, top): (u32, u32), (width, height): (u32, u32), layers: usize) -> Self {
        let (columns, rows) = (left..width.min(left + TILE.0), top..height.min(top + TILE.1));
        let (mut places, mut ends) = (Vec::new(), [0; STRIDES.len()]);
        for (step, stride) in STRIDES.into_iter().enumerate() {
            let known = |at: u32, size: u32| step > 0 && is_first(at, STRIDES[step - 1], size);
            for y in rows.clone().filter(|y| is_first(*y, stride, height)) {
                let xs = columns.clone().filter(|x| is_first(*x, stride, width));
                places.extend(xs.map(|x| (x, y)).filter(|(x, y)| !(known(*x, width) && known(*y, height))));
            }
            ends[step] = places.len();
        }
        let sums = vec![DVec3::ZERO; places.len() * layers];
        Self { places, ends, first: Vec::new(), sums, steps: 0, drawn: 0 }
    }

    /// Traces the samples up to a stage that belong to the moment of `faded`.
    fn trace(&mut self, faded: &FadedPixels, goal: Refinement, last: bool, stop: &Stop) -> Counts {
        let pixels = &faded.pixels;
        let (mut counts, layers) = (Counts::default(), pixels.layers());
        let seed = pixels.context.quality.seed;
        let mut add = |places: Range<usize>, samples: Range<u32>| {
            let sums = &mut self.sums[places.start * layers..places.end * layers];
            counts += faded.add(&self.places[places], &SampleSet { samples, seed }, sums);
        };
        for step in self.steps..goal.steps {
            if stop.signal().is_some() {
                return counts;
            }
            add(if step == 0 { 0 } else { self.ends[step - 1] }..self.ends[step], 0..1);
            if last && pixels.moment.of == 1 {
                self.steps = step + 1;
            }
        }
        let mut drawn = self.drawn.max(1);
        while goal.steps == STRIDES.len() && drawn < goal.samples {
            if stop.signal().is_some() {
                return counts;
            }
            add(0..self.places.len(), drawn..drawn + 1);
            drawn += 1;
            if pixels.moment.of == 1 {
                self.drawn = drawn;
            }
        }
        if last {
            (self.steps, self.drawn) = (goal.steps, if goal.steps == STRIDES.len() { drawn } else { 1 });
        }
        counts
    }
}

/// Pixels of one camera, or of two whose light is mixed.
struct FadedPixels<'a> {
    pixels: PixelTracer<'a>,
    /// The other camera, with its share.
    before: Option<(PixelTracer<'a>, f64)>,
}

impl FadedPixels<'_> {
    /// [`PixelTracer::add`] of the weighted mean.
    fn add(&self, places: &[(u32, u32)], set: &SampleSet, sums: &mut [DVec3]) -> Counts {
        let Some((before, share)) = &self.before else { return self.pixels.add(places, set, sums) };
        let mut counts = Counts::default();
        for (pixels, share) in [(before, *share), (&self.pixels, 1.0 - share)] {
            let mut part = vec![DVec3::ZERO; sums.len()];
            counts += pixels.add(places, set, &mut part);
            sums.iter_mut().zip(part).for_each(|(sum, part)| *sum += part * share);
        }
        counts
    }
}

/// Whether a column or row is the one of its cell that has the first sample: the second one, or the only one.
fn is_first(at: u32, stride: u32, size: u32) -> bool {
    match stride {
        1 => true,
        _ => at % stride == 1 || at.is_multiple_of(stride) && at + 1 == size,
    }
}

/// The number of rays for one sample of a pixel, as the mean over each cell of `cell` x `cell` pixels, row by row.
pub fn rays_per_sample(
    scene: &Scene,
    bvh: &Bvh,
    settings: &TraceSettings,
    random: bool,
    cell: u32,
    stop: &Stop,
) -> Option<Vec<f32>> {
    let mut pixels = PixelTracer::new(scene, bvh, settings, Moment::ONLY);
    pixels.random = random;
    let (width, height) = settings.size;
    let corners: Vec<(u32, u32)> = (0..height)
        .step_by(cell as usize)
        .flat_map(|top| (0..width).step_by(cell as usize).map(move |left| (left, top)))
        .collect();
    let set = SampleSet { samples: 0..1, seed: settings.quality.seed };
    let rays = corners.par_iter().map(|&(left, top)| {
        if stop.signal().is_some() {
            return 0.0;
        }
        let rows = top..height.min(top + cell);
        let places: Vec<(u32, u32)> =
            rows.flat_map(|y| (left..width.min(left + cell)).map(move |x| (x, y))).collect();
        let mut sums = vec![DVec3::ZERO; places.len() * pixels.layers()];
        let counts = pixels.add(&places, &set, &mut sums);
        counts.rays.total() as f32 / places.len() as f32
    });
    let rays: Vec<f32> = rays.collect();
    stop.signal().is_none().then_some(rays)
}

/// The rays for one sample of a pixel.
pub fn rays_of_pixel(
    scene: &Scene,
    bvh: &Bvh,
    settings: &TraceSettings,
    random: bool,
    pixel: (u32, u32),
) -> RayCounts {
    let mut pixels = PixelTracer::new(scene, bvh, settings, Moment::ONLY);
    pixels.random = random;
    let mut sums = vec![DVec3::ZERO; pixels.layers()];
    let set = SampleSet { samples: 0..1, seed: settings.quality.seed };
    pixels.add(&[pixel], &set, &mut sums).rays
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_comes_once_and_every_cell_has_one() {
        for size in [(1, 1), (5, 9), (33, 17), (64, 32), (70, 35)] {
            let settings = (size.0, size.1);
            let mut all = Vec::new();
            for top in (0..size.1).step_by(16) {
                for left in (0..size.0).step_by(32) {
                    let tile = Tile::new((left, top), settings, 1);
                    for (step, stride) in STRIDES.into_iter().enumerate() {
                        let cells: std::collections::BTreeSet<_> = tile.places[..tile.ends[step]]
                            .iter()
                            .map(|(x, y)| (x / stride, y / stride))
                            .collect();
                        let columns = (size.0.min(left + 32) - left).div_ceil(stride);
                        let rows = (size.1.min(top + 16) - top).div_ceil(stride);
                        assert_eq!((cells.len(), tile.ends[step]), ((columns * rows) as usize, cells.len()));
                    }
                    all.extend(tile.places);
                }
            }
            all.sort_unstable();
            all.dedup();
            assert_eq!(all.len() as u32, size.0 * size.1);
        }
    }

    #[test]
    fn stages_go_from_few_pixels_to_all_samples() {
        let mut stage = Refinement::FIRST;
        let mut stages = vec![(stage.stride(), stage.samples)];
        while let Some(next) = stage.next(6) {
            stage = next;
            stages.push((stage.stride(), stage.samples));
        }
        assert_eq!(stages, [(4, 1), (2, 1), (1, 1), (1, 2), (1, 4), (1, 6)]);
    }
}
