//! What the light of a pixel may be: its samples, or a fit at one of several scales.

use super::guides::Guides;
use super::halves::Halves;
use super::memory::Memory;
use super::neighbors::{Neighbor, Pooled};
use super::planes::Planes;
use super::regression::{SCALES, fit};
use crate::base::color::Rgb;
use crate::base::lanes::{Color, Single};
use std::array::from_fn;

/// Errors are relative to the light of their pixel, since a bright pixel would decide for all dark ones around it. They
/// are relative to at least this share of the mean light.
const DARK: f64 = 0.3;

/// The candidates of one picture alone: the samples, the samples without outliers, and the fits to these of all scales.
pub const ALONE: usize = 2 + SCALES;

/// The scales of fits to samples that are pooled with those of neighbours: the smallest ones. There is less noise to fit,
/// and what has changed spreads less.
const POOLED_SCALES: usize = 2;

/// The most candidates: those of one picture, the pooled samples without outliers, and the fits to these.
pub const CANDIDATES: usize = ALONE + 1 + POOLED_SCALES;

/// Bytes per pixel of the candidates of both halves, and what they become.
pub fn bytes_of_pixel(layers: u64) -> u64 {
    // The memory of the brightness by which light is dimmed may be too small for anything else.
    let light = ALONE * size_of::<Rgb>() + size_of::<f32>();
    2 * layers * light as u64
}

/// Bytes per pixel while the samples of a layer are pooled and fitted. For each half: the sums of the light, and the
/// fits. For all: the weights of neighbours. Guides are counted apart.
pub const BYTES_OF_POOLED: u64 =
    (2 * (1 + POOLED_SCALES) * size_of::<Rgb>()) as u64 + (8 * size_of::<f32>()) as u64;

/// The candidates of all pixels from a picture alone.
pub struct Candidates<'a> {
    halves: &'a Halves,
    samples: [Planes; 2],
    /// The light without outliers.
    dimmed: [Planes; 2],
    guides: [Guides; 2],
    /// Per half: the fits of all scales to its light without outliers.
    fits: [[Planes; SCALES]; 2],
    /// Per layer: what is added to the square of a pixel's light, to which its squared errors are relative.
    floors: Vec<f32>,
}

impl<'a> Candidates<'a> {
    /// The fits have the guides of the other half. With their own, fits would follow what random numbers have in common
    /// in guides and light: in glass, samples that are reflected and samples that are not see other surfaces.
    pub fn new(halves: &'a Halves) -> Self {
        let (memory, size) = (halves.memory(), halves.size());
        let (dimmed, guides) = rayon::join(|| halves.dimmed(), || Guides::new(size, &halves.guides));
        let [a, b] = &dimmed;
        let fits = rayon::join(|| fit(&guides[1], &guides[1], a), || fit(&guides[0], &guides[0], b)).into();
        let samples = halves.films.each_ref().map(|film| Planes::of_film(memory, film, 0..film.held.len()));
        let floors = (0..halves.film().held.len()).map(|layer| floor(&dimmed, layer)).collect();
        Self { halves, samples, dimmed, guides, fits, floors }
    }

    /// The candidates of a layer, with those from the samples of neighbours, if there are any.
    pub fn of_layer(&self, layer: usize, neighbors: &[Neighbor]) -> LayerCandidates<'_> {
        let pooled = (!neighbors.is_empty()).then(|| {
            let id = self.halves.film().held[layer];
            let of_layer = (id, layer, self.floors[layer]);
            let Pooled { light, guides, shown, still } =
                Pooled::new((self.halves, &self.dimmed), self.guides.each_ref(), neighbors, of_layer);
            let [a, b] = &light;
            let shown = shown.as_ref().unwrap_or(&self.guides);
            let fits = rayon::join(|| fit(&guides[1], &shown[1], a), || fit(&guides[0], &shown[0], b)).into();
            PooledCandidates { light, fits, still }
        });
        LayerCandidates { all: self, layer, pooled }
    }

    pub fn size(&self) -> (usize, usize) {
        self.samples[0].size()
    }
}

/// What is added to the square of a pixel's light in a layer.
fn floor(dimmed: &[Planes; 2], layer: usize) -> f32 {
    let light = |half: &Planes, y: usize| -> f64 {
        let [red, green, blue] = half.channels(layer, y);
        let pixels = red.iter().zip(green).zip(blue);
        pixels.map(|((red, green), blue)| f64::from(red + green + blue)).sum()
    };
    let (width, height) = dimmed[0].size();
    let rows = (0..height).flat_map(|y| dimmed.each_ref().map(|half| light(half, y)));
    let dark = DARK * rows.sum::<f64>() / (2.0 * width as f64 * height as f64);
    (dark * dark) as f32
}

/// The candidates of a layer that the samples of neighbours give, three planes each.
struct PooledCandidates {
    light: [Planes; 2],
    fits: [[Planes; POOLED_SCALES]; 2],
    still: Option<Planes>,
}

/// The candidates of all pixels in a layer.
pub struct LayerCandidates<'a> {
    all: &'a Candidates<'a>,
    layer: usize,
    pooled: Option<PooledCandidates>,
}

impl LayerCandidates<'_> {
    /// The number of candidates.
    pub fn count(&self) -> usize {
        if self.pooled.is_some() { CANDIDATES } else { ALONE }
    }

    pub fn size(&self) -> (usize, usize) {
        self.all.size()
    }

    /// Where planes of the candidates have their memory.
    pub fn memory(&self) -> &Memory {
        self.all.halves.memory()
    }

    /// The samples of both halves in a row, per channel.
    pub fn samples(&self, y: usize) -> [[&[f32]; 2]; 3] {
        [0, 1, 2].map(|channel| self.all.samples.each_ref().map(|half| half.row(3 * self.layer + channel, y)))
    }

    /// The candidates of both halves in a row.
    pub fn row(&self, y: usize) -> CandidateRow<'_> {
        CandidateRow {
            halves: [0, 1].map(|half| from_fn(|candidate| self.channels(half, candidate, y))),
            count: self.count(),
            floor: self.all.floors[self.layer],
            still: self.pooled.as_ref().and_then(|pooled| pooled.still.as_ref()).map(|still| still.row(0, y)),
        }
    }

    /// A candidate of a half in a row. Those that do not exist are empty.
    fn channels(&self, half: usize, candidate: usize, y: usize) -> [&[f32]; 3] {
        let Self { all, layer, pooled } = self;
        match (candidate, pooled) {
            (0, _) => all.samples[half].channels(*layer, y),
            (1, _) => all.dimmed[half].channels(*layer, y),
            (2..ALONE, _) => all.fits[half][candidate - 2].channels(*layer, y),
            (ALONE, Some(pooled)) => pooled.light[half].channels(0, y),
            (_, Some(pooled)) => pooled.fits[half][candidate - ALONE - 1].channels(0, y),
            (_, None) => [&[]; 3],
        }
    }
}

/// The candidates of a row of pixels in a layer.
pub struct CandidateRow<'a> {
    halves: [[[&'a [f32]; 3]; CANDIDATES]; 2],
    count: usize,
    floor: f32,
    still: Option<&'a [f32]>,
}

impl CandidateRow<'_> {
    /// The number of candidates.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.count
    }

    /// A candidate of both halves at eight pixels.
    #[inline(always)]
    pub fn at<S: Single>(&self, candidate: usize, x: usize) -> [Color<S>; 2] {
        let [first, second] = &self.halves;
        [Color::load(first[candidate], x), Color::load(second[candidate], x)]
    }

    /// What the neighbours weigh that see the points of eight pixels through the same pixels.
    #[inline(always)]
    pub fn still<S: Single>(&self, x: usize) -> S {
        match self.still {
            Some(row) => S::load(row, x),
            None => S::splat(0.0),
        }
    }

    /// By what squares are multiplied to be relative to the light of a pixel.
    #[inline(always)]
    pub fn unit<S: Single>(&self, x: usize) -> S {
        let [first, second] = self.at::<S>(1, x);
        let light = (first.element_sum() + second.element_sum()) * S::splat(0.5);
        S::splat(1.0) / (light * light + S::splat(self.floor))
    }
}

/// The squared difference of a candidate to the samples that is at least there in both halves, in the same direction:
/// summed over the channels, relative to the light.
#[inline(always)]
pub fn difference<S: Single>([a, b]: [Color<S>; 2], [first, second]: [Color<S>; 2], unit: S) -> S {
    let [own, other] = [(a - first).element_sum(), (b - second).element_sum()];
    let (zero, both) = (S::splat(0.0), own.abs().min(other.abs()));
    S::select(zero.lt(own * other), unit * both * both * S::splat(1.0 / 3.0), zero)
}
