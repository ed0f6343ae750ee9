//! The film: linear radiance of a frame in layers, and AOVs. The tracer fills it and the encoder develops it.
//!
//! In: samples of the tracer.
//! Out: weighted radiance, coverage and denoising features of each pixel.
//! May use: `base`, `sampling`.

pub mod filter;

use crate::base::color::Rgb;
use crate::base::digest::Content;
use glam::Vec3;
use std::sync::Arc;

/// The largest exposure, in stops up or down.
pub const MAX_STOPS: f64 = 40.0;

/// The index of a layer of the film. Layer 0 holds all light whose weight has no keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Content)]
pub struct LayerId(pub u32);

impl LayerId {
    pub const CONSTANT: Self = Self(0);

    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// The AOVs (arbitrary output variables) that a film records besides light. Others are neither traced nor stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AovSet {
    /// How much of the background is visible in each pixel. The film then omits light that camera rays receive from
    /// the background directly.
    pub coverage: bool,
    /// Denoising features: depth, normal and albedo of the first visible surface.
    pub features: bool,
}

/// The number of layers of the denoising features: [depth, hits, 0], normal and albedo.
const FEATURES: usize = 3;

impl AovSet {
    /// The number of their layers. They follow the layers of light.
    pub fn layers(self) -> usize {
        usize::from(self.coverage) + if self.features { FEATURES } else { 0 }
    }

    /// The layer of the visible background, after `lights` layers of light.
    pub fn coverage_layer(self, lights: usize) -> Option<LayerId> {
        self.coverage.then_some(LayerId(lights as u32))
    }

    /// The first layer of the denoising features.
    pub fn features_layer(self, lights: usize) -> Option<LayerId> {
        self.features.then_some(LayerId((lights + usize::from(self.coverage)) as u32))
    }
}

/// The first visible surface of a pixel, as the mean over its samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DenoisingFeatures {
    /// Distance from the camera along its line of sight; none if no sample hits anything.
    pub depth: Option<f32>,
    /// The unit normal in world space; zero if no sample hits anything.
    pub normal: Vec3,
    /// The share of light that the surface reflects and transmits, over all its lobes.
    pub albedo: Rgb,
}

/// The quality of an adaptively sampled film. Errors are root mean squares over pixels and colour channels, as a
/// share of the mean of the frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    pub error: f64,
    /// The true error is between `low` and `high` in 95 of 100 frames.
    pub low: f64,
    pub high: f64,
    /// Samples per pixel, as the mean over the pixels.
    pub samples: f64,
    /// Share of the pixels that reached the maximum number of samples, whatever their error.
    pub capped: f64,
}

impl Noise {
    /// The noise from an estimate `square` of the squared error under independent samples. `variance` is the variance
    /// of the estimate, and `truth` the variance of the true squared error. `gain` is the factor by which
    /// stratification reduces the squared error at best; the reported error assumes half of that reduction.
    ///
    /// The estimate and the truth are sums of squares. If each is distributed like a sum of n squares of normal
    /// numbers, whose relative variance is 2 / n, their ratio has Fisher's F distribution with these two degrees of
    /// freedom.
    pub fn of_square(square: f64, (variance, truth): (f64, f64), gain: f64) -> Self {
        if square == 0.0 {
            return Self::default();
        }
        let freedom = |variance: f64| 2.0 * square * square / variance;
        let at = |z: f64| square * f_quantile(z, freedom(truth), freedom(variance));
        // 95 % of a normal distribution are within 1.96 standard deviations.
        let (low, high) = ((gain * at(-1.96)).sqrt(), at(1.96).sqrt());
        Self { error: ((1.0 + gain) / 2.0 * square).sqrt(), low, high, ..Self::default() }
    }
}

/// The quantile of the F distribution that corresponds to `z` standard deviations of a normal distribution. The cube
/// root of the F distribution is approximately the ratio of two normal numbers (Paulson, "An approximate
/// normalization of the analysis of variance distribution", 1942). Infinite if the degrees of freedom are too few to
/// bound it.
fn f_quantile(z: f64, above: f64, below: f64) -> f64 {
    let (a, b) = (2.0 / (9.0 * above), 2.0 / (9.0 * below));
    // Solve ((1 - b) x - (1 - a))^2 = z^2 (b x^2 + a) for x.
    let square = (1.0 - b) * (1.0 - b) - z * z * b;
    if square <= 0.0 {
        return if z > 0.0 { f64::INFINITY } else { 0.0 };
    }
    let half = (1.0 - a) * (1.0 - b);
    let rest = (1.0 - a) * (1.0 - a) - z * z * a;
    let root = (half * half - square * rest).max(0.0).sqrt().copysign(z);
    let x = ((half + root) / square).max(0.0);
    x * x * x
}

/// Linear radiance of one frame, in one layer per weight. Because light is linear, the picture is the sum of
/// `weights[l]` times layer l. So a frame that differs only in weights needs no rays.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    pub width: u32,
    pub height: u32,
    /// One weight per layer of light. Layers are traced with weight 1. A layer of weight 0 is dark, whatever the film
    /// holds for it.
    pub weights: Vec<Rgb>,
    /// The factor of the displayed picture, above 0. It is not part of the radiance, and 1 after tracing.
    pub exposure: f32,
    /// The recorded AOVs.
    pub aovs: AovSet,
    /// The noise with the current weights, if it was measured.
    pub noise: Option<Noise>,
    /// The noise with each set of weights for which the film was sampled.
    pub noises: Arc<[Noise]>,
    /// Whether the run stopped before the film reached its target.
    pub unfinished: bool,
    /// The layers of light that were traced and are stored, ascending.
    pub held: Arc<[LayerId]>,
    /// The pixels, row by row from the top left. Each pixel has its layers of light and then those of the AOVs. Films
    /// that differ only in weights share the data.
    pub data: Arc<Vec<Rgb>>,
}

/// The layers of light that are not dark, ascending.
pub fn lit(weights: &[Rgb]) -> impl Iterator<Item = LayerId> {
    (0..).zip(weights).filter(|(_, weight)| **weight != Rgb::ZERO).map(|(layer, _)| LayerId(layer))
}

impl Film {
    pub fn new(width: u32, height: u32, weights: Vec<Rgb>) -> Self {
        Self::with_aovs(width, height, weights, AovSet::default())
    }

    /// A black film with the layers that are not dark, and AOVs.
    pub fn with_aovs(width: u32, height: u32, weights: Vec<Rgb>, aovs: AovSet) -> Self {
        let held: Arc<[LayerId]> = lit(&weights).collect();
        let pixels = width as usize * height as usize;
        let data = Arc::new(vec![Rgb::ZERO; pixels * (held.len() + aovs.layers())]);
        Self {
            width,
            height,
            weights,
            exposure: 1.0,
            aovs,
            noise: None,
            noises: Arc::default(),
            unfinished: false,
            held,
            data,
        }
    }

    /// The data, for writing. Films that share it keep a copy.
    pub fn data_mut(&mut self) -> &mut [Rgb] {
        Arc::make_mut(&mut self.data).as_mut_slice()
    }

    /// The film with other weights. Layers that are not held must be dark.
    pub fn weighted_by(&self, weights: &[Rgb]) -> Self {
        Self { weights: weights.to_vec(), noise: None, ..self.clone() }
    }

    /// The film with the set of weights number `weighting` among those for which it was sampled.
    pub fn shown_as(&self, weighting: usize, weights: &[Rgb]) -> Self {
        Self { noise: self.noises.get(weighting).copied(), ..self.weighted_by(weights) }
    }

    /// Makes the displayed picture `stops` brighter: see [`exposure`].
    pub fn expose(&mut self, stops: f64) {
        self.exposure = exposure(stops);
    }

    /// The number of values per pixel.
    pub fn layers(&self) -> usize {
        self.held.len() + self.aovs.layers()
    }

    /// The weighted sum of the layers of every pixel, row by row: in f64, in the order of the layers, rounded once.
    pub fn radiance(&self) -> impl Iterator<Item = Rgb> {
        self.data.chunks_exact(self.layers()).map(|pixel| self.weighted(pixel))
    }

    /// The weighted sum of the layers of one pixel, counted row by row.
    pub fn radiance_at(&self, pixel: usize) -> Rgb {
        self.weighted(self.pixel(pixel))
    }

    /// The part of the radiance of a pixel that comes from one layer of light.
    pub fn radiance_of(&self, pixel: usize, layer: usize) -> Rgb {
        let (id, weight) = (LayerId(layer as u32), self.weights[layer]);
        match self.held.binary_search(&id) {
            Ok(place) if weight != Rgb::ZERO => {
                (weight.as_dvec3() * self.pixel(pixel)[place].as_dvec3()).as_vec3()
            }
            _ => Rgb::ZERO,
        }
    }

    /// The alpha of a pixel: the share that hides the background, from 0 to 1. It is 1 unless coverage is recorded.
    /// The radiance of the pixel is premultiplied by alpha.
    pub fn alpha_at(&self, pixel: usize) -> f32 {
        let Some(layer) = self.aovs.coverage_layer(self.held.len()) else { return 1.0 };
        // The visible background may be tinted, but a picture has one alpha.
        let through = self.pixel(pixel)[layer.index()].element_sum() / 3.0;
        (1.0 - through).clamp(0.0, 1.0)
    }

    /// The denoising features of a pixel, if they are recorded.
    pub fn features_at(&self, pixel: usize) -> Option<DenoisingFeatures> {
        let first = self.aovs.features_layer(self.held.len())?.index();
        let [depth, normal, albedo] = *self.pixel(pixel)[first..].first_chunk()?;
        let hits = depth.y;
        Some(DenoisingFeatures {
            depth: (hits > 0.0).then_some(depth.x / hits),
            normal: normal.normalize_or_zero(),
            albedo,
        })
    }

    fn pixel(&self, pixel: usize) -> &[Rgb] {
        &self.data[pixel * self.layers()..][..self.layers()]
    }

    /// Skips dark layers: the picture does not need them, so they may hold any value, also an infinite one.
    fn weighted(&self, layers: &[Rgb]) -> Rgb {
        let mut sum = glam::DVec3::ZERO;
        for (id, layer) in self.held.iter().zip(layers) {
            let weight = self.weights[id.index()];
            if weight != Rgb::ZERO {
                sum += weight.as_dvec3() * layer.as_dvec3();
            }
        }
        sum.as_vec3()
    }
}

/// The factor of a picture that is `stops` brighter; each stop doubles it. Easings may overshoot [`MAX_STOPS`], so
/// `stops` is clamped.
pub fn exposure(stops: f64) -> f32 {
    libm::exp2(stops.clamp(-MAX_STOPS, MAX_STOPS)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radiance_weights_the_layers() {
        let mut film = Film::new(2, 1, vec![Rgb::ONE, Rgb::new(0.5, 0.0, 2.0)]);
        film.data_mut()[2..].copy_from_slice(&[Rgb::splat(0.25), Rgb::ONE]);
        assert_eq!(film.radiance().collect::<Vec<_>>(), [Rgb::ZERO, Rgb::new(0.75, 0.25, 2.25)]);
    }

    #[test]
    fn dark_layers_are_not_held_and_what_is_held_of_them_is_not_seen() {
        let mut film = Film::new(1, 1, vec![Rgb::ONE, Rgb::ZERO, Rgb::X]);
        assert_eq!((&*film.held, film.data.len()), (&[LayerId(0), LayerId(2)][..], 2));
        film.data_mut().copy_from_slice(&[Rgb::splat(f32::INFINITY), Rgb::splat(0.5)]);
        let fair = film.weighted_by(&[Rgb::ZERO, Rgb::ZERO, Rgb::ONE]);
        assert_eq!(fair.radiance_at(0), Rgb::splat(0.5));
        let parts = |film: &Film| [0, 1, 2].map(|layer| film.radiance_of(0, layer));
        assert_eq!(parts(&fair), [Rgb::ZERO, Rgb::ZERO, Rgb::splat(0.5)]);
        assert!(Arc::ptr_eq(&film.data, &fair.data), "no copy was made");
    }

    /// Tables of the F distribution at 2.5 % and 97.5 %. The formula is more accurate for more degrees of freedom.
    #[test]
    fn quantiles_of_f() {
        for (above, below, within, low, high) in [
            (5.0, 10.0, 0.04, 0.1511, 4.2361),
            (10.0, 20.0, 0.01, 0.2925, 2.7737),
            (60.0, 120.0, 0.001, 0.6325, 1.5299),
        ] {
            let found = [-1.96, 1.96].map(|z| f_quantile(z, above, below));
            assert!((found[0] / low - 1.0).abs() < within, "{above}, {below}: {found:?}");
            assert!((found[1] / high - 1.0).abs() < within, "{above}, {below}: {found:?}");
        }
        // With so few degrees of freedom, no value is ruled out.
        assert_eq!([-1.96, 1.96].map(|z| f_quantile(z, 0.1, 0.2)), [0.0, f64::INFINITY]);
        assert!((f_quantile(1.96, f64::INFINITY, f64::INFINITY) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn aovs_follow_the_light() {
        let aovs = AovSet { coverage: true, features: true };
        let mut film = Film::with_aovs(1, 2, vec![Rgb::ONE; 2], aovs);
        let values = [0.25, 0.5, 0.75].map(Rgb::splat);
        let features = [Rgb::new(3.0, 0.5, 0.0), Rgb::new(0.0, 0.3, 0.4), Rgb::new(0.1, 0.2, 0.3)];
        film.data_mut()[6..].copy_from_slice(&[values.as_slice(), &features].concat());
        assert_eq!(film.radiance().collect::<Vec<_>>(), [Rgb::ZERO, Rgb::splat(0.75)]);
        assert_eq!((film.alpha_at(0), film.alpha_at(1)), (1.0, 0.25));
        assert_eq!(film.radiance_of(1, 1), Rgb::splat(0.5));
        let seen = film.features_at(1).expect("features");
        assert_eq!((seen.depth, seen.albedo), (Some(6.0), Rgb::new(0.1, 0.2, 0.3)));
        assert!((seen.normal - Rgb::new(0.0, 0.6, 0.8)).length() < 1e-6);
        assert_eq!(film.features_at(0).expect("features").depth, None);
        assert_eq!(Film::new(1, 1, vec![Rgb::ONE]).features_at(0), None);
    }

    #[test]
    fn a_stop_doubles_the_exposure() {
        let mut film = Film::new(1, 1, vec![Rgb::ONE]);
        let mut exposed = |stops| {
            film.expose(stops);
            film.exposure
        };
        assert_eq!([0.0, 1.0, -2.0].map(&mut exposed), [1.0, 2.0, 0.25]);
        assert_eq!([40.0, 1e9].map(&mut exposed), [(1u64 << 40) as f32; 2], "no more than 40 stops");
        assert_eq!([-40.0, -1e9].map(&mut exposed), [1.0 / (1u64 << 40) as f32; 2]);
        assert!((exposed(0.5) - 2.0_f32.sqrt()).abs() < 1e-6);
    }
}
