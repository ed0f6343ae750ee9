//! What the light of a pixel may be: its samples, or a fit at one of several scales.

use super::super::Film;
use super::guides::Guides;
use super::outliers::dimmed;
use super::planes::Planes;
use super::regression::{SCALES, fit};
use crate::base::color::Rgb;
use crate::base::lanes::{Color, Single};

/// Errors are relative to the light of their pixel, since a bright pixel would decide for all dark ones around it. They
/// are relative to at least this share of the mean light.
const DARK: f64 = 0.3;

/// The number of candidates: the samples, the samples without outliers, and the fits to these of all scales.
pub const CANDIDATES: usize = SCALES + 2;

/// Bytes per pixel of the candidates of both halves, and what they become.
pub fn bytes_of_pixel(layers: u64) -> u64 {
    // While outliers are dimmed, each light has its brightness.
    let light = CANDIDATES * size_of::<Rgb>() + size_of::<f32>();
    2 * layers * light as u64
}

/// The candidates of all pixels.
pub struct Candidates {
    halves: [Half; 2],
    /// Per layer: what is added to the square of a pixel's light, to which its squared errors are relative.
    floors: Vec<f32>,
}

/// The candidates of a half.
struct Half {
    samples: Planes,
    dimmed: Planes,
    fits: [Planes; SCALES],
}

impl Half {
    /// The fits have the guides of the other half. With their own, fits would follow what random numbers have in common
    /// in guides and light: in glass, samples that are reflected and samples that are not see other surfaces.
    fn new(film: &Film, guides: &Guides) -> Self {
        let samples = Planes::of_film(film, 0..film.held.len());
        let dimmed = dimmed(&samples);
        let fits = fit(guides, &dimmed);
        Self { samples, dimmed, fits }
    }

    /// The candidates in a row of a layer.
    fn row(&self, layer: usize, y: usize) -> [[&[f32]; 3]; CANDIDATES] {
        let [a, b, c, d] = &self.fits;
        [&self.samples, &self.dimmed, a, b, c, d].map(|light| light.channels(layer, y))
    }
}

impl Candidates {
    pub fn new([first, second]: [&Film; 2]) -> Self {
        let half = |film: &Film, other: &Film| Half::new(film, &Guides::new(other));
        let halves: [Half; 2] = rayon::join(|| half(first, second), || half(second, first)).into();
        let floor = |layer: usize| {
            let light = |half: &Half, y: usize| -> f64 {
                let [red, green, blue] = half.dimmed.channels(layer, y);
                let pixels = red.iter().zip(green).zip(blue);
                pixels.map(|((red, green), blue)| f64::from(red + green + blue)).sum()
            };
            let rows = (0..first.height as usize).flat_map(|y| halves.each_ref().map(|half| light(half, y)));
            let dark = DARK * rows.sum::<f64>() / (2.0 * f64::from(first.width) * f64::from(first.height));
            (dark * dark) as f32
        };
        let floors = (0..first.held.len()).map(floor).collect();
        Self { halves, floors }
    }

    pub fn size(&self) -> (usize, usize) {
        self.halves[0].samples.size()
    }

    /// The samples of both halves in a row of a layer, per channel.
    pub fn samples(&self, layer: usize, y: usize) -> [[&[f32]; 2]; 3] {
        [0, 1, 2].map(|channel| self.halves.each_ref().map(|half| half.samples.row(3 * layer + channel, y)))
    }

    /// The candidates of both halves in a row of a layer.
    pub fn row(&self, layer: usize, y: usize) -> CandidateRow<'_> {
        CandidateRow {
            halves: self.halves.each_ref().map(|half| half.row(layer, y)),
            floor: self.floors[layer],
        }
    }
}

/// The candidates of a row of pixels in a layer.
pub struct CandidateRow<'a> {
    halves: [[[&'a [f32]; 3]; CANDIDATES]; 2],
    floor: f32,
}

impl CandidateRow<'_> {
    /// A candidate of both halves at eight pixels.
    #[inline(always)]
    pub fn at<S: Single>(&self, candidate: usize, x: usize) -> [Color<S>; 2] {
        let [first, second] = &self.halves;
        [Color::load(first[candidate], x), Color::load(second[candidate], x)]
    }

    /// The mean of both halves.
    #[inline(always)]
    pub fn mean<S: Single>(&self, candidate: usize, x: usize) -> Color<S> {
        let [first, second] = self.at::<S>(candidate, x);
        (first + second) * S::splat(0.5)
    }

    /// The squared difference of a candidate to the samples that is at least there in both halves, in the same
    /// direction: summed over the channels, relative to the light.
    #[inline(always)]
    pub fn difference<S: Single>(&self, candidate: usize, x: usize) -> S {
        let ([a, b], [first, second]) = (self.at::<S>(0, x), self.at::<S>(candidate, x));
        let [own, other] = [(a - first).element_sum(), (b - second).element_sum()];
        let (zero, both) = (S::splat(0.0), own.abs().min(other.abs()));
        S::select(zero.lt(own * other), self.unit::<S>(x) * both * both * S::splat(1.0 / 3.0), zero)
    }

    /// By what squares are multiplied to be relative to the light of a pixel.
    #[inline(always)]
    pub fn unit<S: Single>(&self, x: usize) -> S {
        let [first, second] = self.at::<S>(1, x);
        let light = (first.element_sum() + second.element_sum()) * S::splat(0.5);
        S::splat(1.0) / (light * light + S::splat(self.floor))
    }
}
