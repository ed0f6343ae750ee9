//! The film: what the tracer fills and the encoder develops.

pub mod filter;

use crate::base::color::Rgb;
use crate::base::digest::content;
use glam::Vec3;
use std::sync::Arc;

/// The strongest exposure, in stops up or down.
pub const MOST_STOPS: f64 = 40.0;

/// Index of a film's layer. Layer 0 holds all light that no key weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LayerId(pub u32);

content!(struct LayerId(index));

impl LayerId {
    pub const CONSTANT: Self = Self(0);

    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// What a film records besides light, where something asks for it. What nobody asks for is neither traced nor kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extras {
    /// How much of the background shows through each pixel. Light of the background that is seen straight on is
    /// left out then.
    pub coverage: bool,
    /// Depth, normals and albedo of what is seen first.
    pub guides: bool,
}

/// Layers that guides take: [depth, hits, 0], normal and albedo.
const GUIDES: usize = 3;

impl Extras {
    /// How many layers of a film they take, after those of light.
    pub fn layers(self) -> usize {
        usize::from(self.coverage) + if self.guides { GUIDES } else { 0 }
    }

    /// The layer of what shows through, after `lights` layers of light.
    pub fn coverage_layer(self, lights: usize) -> Option<LayerId> {
        self.coverage.then_some(LayerId(lights as u32))
    }

    /// The first layer of the guides.
    pub fn guides_layer(self, lights: usize) -> Option<LayerId> {
        self.guides.then_some(LayerId((lights + usize::from(self.coverage)) as u32))
    }
}

/// What is seen first in a pixel, as the mean over its samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guides {
    /// Distance from the camera along its line of sight; none where nothing is hit.
    pub depth: Option<f32>,
    /// Of unit length, in the world, or zero where nothing is hit.
    pub normal: Vec3,
    /// Share of the light that the surface sends on, in all its lobes.
    pub albedo: Rgb,
}

/// How good a film is that was sampled until it was good enough. Its error is the root of the mean square over pixels and
/// colours, as a share of the frame's mean.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    pub error: f64,
    /// In 95 of 100 frames, the error that there really is lies between these.
    pub low: f64,
    pub high: f64,
    /// Mean over the pixels.
    pub samples: f64,
    /// Share of the pixels that have all the samples that they may, whatever their error.
    pub capped: f64,
}

impl Noise {
    /// Of an estimate of the squared error as it was with independent samples, of the variances of the estimate and of what the
    /// squared error really is, and of the factor by which it is less than that at best: what is told lies half way.
    ///
    /// Both are sums of squares. If each is like that of n squares of normal numbers, whose relative variance is 2 / n, their
    /// ratio has Fisher's F distribution with the two numbers of degrees of freedom.
    pub fn of_square(square: f64, (variance, truth): (f64, f64), gain: f64) -> Self {
        if square == 0.0 {
            return Self::default();
        }
        let freedom = |variance: f64| 2.0 * square * square / variance;
        let at = |z: f64| square * f_quantile(z, freedom(truth), freedom(variance));
        // 1.96 standard deviations of a normal distribution hold 95 of 100.
        let (low, high) = ((gain * at(-1.96)).sqrt(), at(1.96).sqrt());
        Self { error: ((1.0 + gain) / 2.0 * square).sqrt(), low, high, ..Self::default() }
    }
}

/// The quantile of the F distribution where a normal distribution has that of `z` standard deviations: its cube root is
/// like the ratio of two normal numbers (Paulson, "An approximate normalization of the analysis of variance
/// distribution", 1942). Infinite where the freedom is too little to bound it.
fn f_quantile(z: f64, above: f64, below: f64) -> f64 {
    let (a, b) = (2.0 / (9.0 * above), 2.0 / (9.0 * below));
    // ((1 - b) x - (1 - a))^2 = z^2 (b x^2 + a), by its roots for x.
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

/// Linear radiance of one frame, kept apart by what weights it. Light is linear: the picture is the sum over
/// the layers of `weights[l]` times the layer, so a frame in which only weights differ needs no ray.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    pub width: u32,
    pub height: u32,
    /// One per layer of light, which was traced as if its weight were one. A layer of weight 0 is dark, whatever the
    /// film holds of it.
    pub weights: Vec<Rgb>,
    /// Factor of the displayed picture, above 0. It is no part of the radiance: 1 as traced.
    pub exposure: f32,
    /// What is recorded besides light.
    pub extras: Extras,
    /// How good it is, if that was asked for.
    pub noise: Option<Noise>,
    /// How good it is with each of the weights that it was sampled for.
    pub noises: Arc<[Noise]>,
    /// Whether a run was stopped before it was so good.
    pub unfinished: bool,
    /// The layers of light that were traced, ascending. The others are not held.
    pub held: Arc<[LayerId]>,
    /// Row by row from the top left pixel; each pixel holds its layers of light and those of the extras. Films of
    /// frames that differ in weights alone share it.
    pub data: Arc<Vec<Rgb>>,
}

/// The layers of light that are not dark, ascending.
pub fn lit(weights: &[Rgb]) -> impl Iterator<Item = LayerId> {
    (0..).zip(weights).filter(|(_, weight)| **weight != Rgb::ZERO).map(|(layer, _)| LayerId(layer))
}

impl Film {
    pub fn new(width: u32, height: u32, weights: Vec<Rgb>) -> Self {
        Self::with_extras(width, height, weights, Extras::default())
    }

    /// A black film of the layers that are not dark.
    pub fn with_extras(width: u32, height: u32, weights: Vec<Rgb>, extras: Extras) -> Self {
        let held: Arc<[LayerId]> = lit(&weights).collect();
        let pixels = width as usize * height as usize;
        let data = Arc::new(vec![Rgb::ZERO; pixels * (held.len() + extras.layers())]);
        Self {
            width,
            height,
            weights,
            exposure: 1.0,
            extras,
            noise: None,
            noises: Arc::default(),
            unfinished: false,
            held,
            data,
        }
    }

    /// What the film holds, to be changed. Films that share it keep their own.
    pub fn data_mut(&mut self) -> &mut [Rgb] {
        Arc::make_mut(&mut self.data).as_mut_slice()
    }

    /// The same light with other weights. Layers that are not held must be dark.
    pub fn weighted_by(&self, weights: &[Rgb]) -> Self {
        Self { weights: weights.to_vec(), noise: None, ..self.clone() }
    }

    /// The same with those weights that it was sampled for at this place.
    pub fn shown_as(&self, weighting: usize, weights: &[Rgb]) -> Self {
        Self { noise: self.noises.get(weighting).copied(), ..self.weighted_by(weights) }
    }

    /// Shows the film `stops` brighter: see [`exposure`].
    pub fn expose(&mut self, stops: f64) {
        self.exposure = exposure(stops);
    }

    /// How many values a pixel holds.
    pub fn layers(&self) -> usize {
        self.held.len() + self.extras.layers()
    }

    /// The weighted sum of every pixel's layers, row by row: f64 in the order of the layers, rounded once.
    pub fn radiance(&self) -> impl Iterator<Item = Rgb> {
        self.data.chunks_exact(self.layers()).map(|pixel| self.weighted(pixel))
    }

    /// The same of one pixel, counted row by row.
    pub fn radiance_at(&self, pixel: usize) -> Rgb {
        self.weighted(self.pixel(pixel))
    }

    /// The part of a pixel's radiance that comes from one layer of light.
    pub fn radiance_of(&self, pixel: usize, layer: usize) -> Rgb {
        let (id, weight) = (LayerId(layer as u32), self.weights[layer]);
        match self.held.binary_search(&id) {
            Ok(place) if weight != Rgb::ZERO => {
                (weight.as_dvec3() * self.pixel(pixel)[place].as_dvec3()).as_vec3()
            }
            _ => Rgb::ZERO,
        }
    }

    /// How much of a pixel hides the background, from 0 to 1: all of it, unless coverage is recorded. The pixel's
    /// radiance is that of the covered part times this, as compositors have it.
    pub fn alpha_at(&self, pixel: usize) -> f32 {
        let Some(layer) = self.extras.coverage_layer(self.held.len()) else { return 1.0 };
        // What shows through may be tinted; the picture has one number for it.
        let through = self.pixel(pixel)[layer.index()].element_sum() / 3.0;
        (1.0 - through).clamp(0.0, 1.0)
    }

    /// What is seen first in a pixel, if that is recorded.
    pub fn guides_at(&self, pixel: usize) -> Option<Guides> {
        let first = self.extras.guides_layer(self.held.len())?.index();
        let [depth, normal, albedo] = *self.pixel(pixel)[first..].first_chunk()?;
        let hits = depth.y;
        Some(Guides {
            depth: (hits > 0.0).then_some(depth.x / hits),
            normal: normal.normalize_or_zero(),
            albedo,
        })
    }

    fn pixel(&self, pixel: usize) -> &[Rgb] {
        &self.data[pixel * self.layers()..][..self.layers()]
    }

    /// Dark layers are passed over: they may hold anything, as what is met in them has not been asked for.
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

/// The factor of a picture that is shown `stops` brighter, each of which doubles it. Easings may lead past
/// [`MOST_STOPS`]; the exposure stays within.
pub fn exposure(stops: f64) -> f32 {
    libm::exp2(stops.clamp(-MOST_STOPS, MOST_STOPS)) as f32
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

    /// Tables of the F distribution at 2.5 and 97.5 of 100. The formula is nearer the more freedom there is.
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
        // So little is known that nothing is ruled out.
        assert_eq!([-1.96, 1.96].map(|z| f_quantile(z, 0.1, 0.2)), [0.0, f64::INFINITY]);
        assert!((f_quantile(1.96, f64::INFINITY, f64::INFINITY) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn extras_stand_after_the_light() {
        let extras = Extras { coverage: true, guides: true };
        let mut film = Film::with_extras(1, 2, vec![Rgb::ONE; 2], extras);
        let values = [0.25, 0.5, 0.75].map(Rgb::splat);
        let guides = [Rgb::new(3.0, 0.5, 0.0), Rgb::new(0.0, 0.3, 0.4), Rgb::new(0.1, 0.2, 0.3)];
        film.data_mut()[6..].copy_from_slice(&[values.as_slice(), &guides].concat());
        assert_eq!(film.radiance().collect::<Vec<_>>(), [Rgb::ZERO, Rgb::splat(0.75)]);
        assert_eq!((film.alpha_at(0), film.alpha_at(1)), (1.0, 0.25));
        assert_eq!(film.radiance_of(1, 1), Rgb::splat(0.5));
        let seen = film.guides_at(1).expect("guides");
        assert_eq!((seen.depth, seen.albedo), (Some(6.0), Rgb::new(0.1, 0.2, 0.3)));
        assert!((seen.normal - Rgb::new(0.0, 0.6, 0.8)).length() < 1e-6);
        assert_eq!(film.guides_at(0).expect("guides").depth, None);
        assert_eq!(Film::new(1, 1, vec![Rgb::ONE]).guides_at(0), None);
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
