//! What the light of a pixel may be: its samples, or a fit at one of several scales.

use super::super::Film;
use super::choice::Measured;
use super::guides::Guides;
use super::outliers::{dimmed, ranges};
use super::regression::{Pictures, fit};
use crate::base::color::Rgb;
use rayon::prelude::*;

/// The sides of the cells of the scales, in pixels. Windows are twice as wide.
const CELLS: [usize; 4] = [2, 4, 8, 16];

/// Errors are relative to the light of their pixel, since a bright pixel would decide for all dark ones around it. They are
/// relative to at least this share of the mean light.
const DARK: f64 = 0.3;

/// The number of candidates: the samples, the samples without outliers, and the fits to these of all scales.
pub const CANDIDATES: usize = CELLS.len() + 2;

/// Bytes per pixel of the candidates of both halves, their guides and what they become.
pub fn bytes_of_pixel(layers: u64) -> u64 {
    // While fits are made, each light has its range.
    2 * Guides::BYTES_PER_PIXEL + 2 * (CANDIDATES as u64 + 4) * layers * size_of::<Rgb>() as u64
}

/// The candidates of all pixels.
pub struct Candidates<'a> {
    halves: [Half<'a>; 2],
    /// Per layer: what is added to the square of a pixel's light, to which its squared errors are relative.
    floors: Vec<f32>,
}

/// The candidates of a half.
struct Half<'a> {
    film: &'a Film,
    layers: usize,
    dimmed: Vec<Rgb>,
    fits: [Vec<Rgb>; CELLS.len()],
}

impl<'a> Half<'a> {
    /// The fits have the guides of the other half. With their own, fits would follow what random numbers have in common in
    /// guides and light: in glass, samples that are reflected and samples that are not see other surfaces.
    fn new(film: &'a Film, guides: &Guides) -> Self {
        let (layers, dimmed) = (film.held.len(), dimmed(film));
        let light = |pixel: usize, layer: usize| dimmed[pixel * layers + layer].as_dvec3();
        let pictures = Pictures { count: layers, light: &light };
        let ranges = ranges((guides.width, guides.height), layers, &dimmed);
        let fits = CELLS.map(|cell| {
            let mut fitted = fit(guides, &pictures, cell);
            let pairs = fitted.par_iter_mut().zip(&ranges);
            pairs.for_each(|(light, [least, most])| *light = light.max(*least).min(*most));
            fitted
        });
        Self { film, layers, dimmed, fits }
    }

    fn at(&self, pixel: usize, layer: usize) -> [Rgb; CANDIDATES] {
        let place = pixel * self.layers + layer;
        let [a, b, c, d] = self.fits.each_ref().map(|fits| fits[place]);
        [self.film.pixel(pixel)[layer], self.dimmed[place], a, b, c, d]
    }
}

impl<'a> Candidates<'a> {
    pub fn new([first, second]: [&'a Film; 2]) -> Self {
        let layers = first.held.len();
        let halves =
            [(first, second), (second, first)].map(|(film, other)| Half::new(film, &Guides::new(other)));
        let floor = |layer: usize| {
            let light = halves.iter().flat_map(|half| half.dimmed.iter().skip(layer).step_by(layers));
            let (sum, count) = light
                .fold((0.0, 0.0), |(sum, count), light| (sum + f64::from(light.element_sum()), count + 1.0));
            let dark = DARK * sum / count;
            (dark * dark) as f32
        };
        let floors = (0..layers).map(floor).collect();
        Self { halves, floors }
    }

    /// The candidates of both halves for a layer of a pixel.
    pub fn at(&self, pixel: usize, layer: usize) -> [[Rgb; CANDIDATES]; 2] {
        self.halves.each_ref().map(|half| half.at(pixel, layer))
    }

    /// By what squares are multiplied to be relative to the light of a pixel.
    pub fn unit(&self, pixel: usize, layer: usize) -> f32 {
        let both = self.halves.each_ref().map(|half| half.dimmed[pixel * half.layers + layer].element_sum());
        let light = (both[0] + both[1]) / 2.0;
        1.0 / (light * light + self.floors[layer])
    }

    /// What is known of the candidates for a layer of a pixel.
    ///
    /// Let a candidate of a half differ from the truth by the bias β and by noise of the variance v, and its samples by noise
    /// of the variance s. If the halves are independent, the squares of the differences between a candidate and the samples
    /// of the other half are β² + v + s on average, that between the samples 2 s, and that between the candidates 2 v. The
    /// error of the mean of both is β² + v / 2. But samples of one sequence avoid each other. What that changes is known from
    /// the audits, on average over the picture: the product of the differences to both is the squared error, with more noise.
    pub fn measure(&self, pixel: usize, layer: usize, audits: [Rgb; 2]) -> Measured {
        let [first, second] = self.at(pixel, layer);
        let (a, b) = (first[0], second[0]);
        let samples = (a - b).length_squared();
        let unit = self.unit(pixel, layer);
        let mut all = Measured::default();
        for (candidate, (first, second)) in first.into_iter().zip(second).enumerate() {
            let crossed = (first - b).length_squared() + (second - a).length_squared();
            all.errors[candidate] =
                unit * ((crossed - samples) / 2.0 - (first - second).length_squared() / 4.0);
            let mean = (first + second) * 0.5;
            all.audited[candidate] = unit * (mean - audits[0]).dot(mean - audits[1]);
            let [own, other] = [(a - first).element_sum(), (b - second).element_sum()];
            if own * other > 0.0 {
                let both = own.abs().min(other.abs());
                all.differences[candidate] = unit * both * both / 3.0;
            }
        }
        // Light that overflows, and pictures without any.
        if all.is_finite() { all } else { Measured::default() }
    }
}
