//! The film: what the tracer fills and the encoder develops.

use crate::color::Rgb;

/// The strongest exposure, in stops up or down.
pub const MOST_STOPS: f64 = 40.0;

/// Index of a film's layer. Layer 0 holds all light that no key weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LayerId(pub u32);

impl LayerId {
    pub const CONSTANT: Self = Self(0);

    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Linear radiance of one frame, kept apart by what weights it. Light is linear: the picture is the sum over
/// the layers of `weights[l]` times the layer, so a frame in which only weights differ needs no ray.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    pub width: u32,
    pub height: u32,
    /// One per layer; the layer's light was traced as if its weight were one.
    pub weights: Vec<Rgb>,
    /// Factor of the displayed picture, above 0. It is no part of the radiance: 1 as traced.
    pub exposure: f32,
    /// Row by row from the top left pixel; each pixel holds its layers one after the other.
    pub data: Vec<Rgb>,
}

impl Film {
    pub fn new(width: u32, height: u32, weights: Vec<Rgb>) -> Self {
        let data = vec![Rgb::ZERO; width as usize * height as usize * weights.len()];
        Self { width, height, weights, exposure: 1.0, data }
    }

    /// Shows the film `stops` brighter, each of which doubles it. Easings may lead past [`MOST_STOPS`]; the
    /// exposure stays within.
    pub fn expose(&mut self, stops: f64) {
        self.exposure = libm::exp2(stops.clamp(-MOST_STOPS, MOST_STOPS)) as f32;
    }

    pub fn layers(&self) -> usize {
        self.weights.len()
    }

    /// The weighted sum of every pixel's layers, row by row: f64 in the order of the layers, rounded once.
    pub fn radiance(&self) -> impl Iterator<Item = Rgb> {
        self.data.chunks_exact(self.layers()).map(|pixel| self.weighted(pixel))
    }

    /// The same of one pixel, counted row by row.
    pub fn radiance_at(&self, pixel: usize) -> Rgb {
        self.weighted(&self.data[pixel * self.layers()..][..self.layers()])
    }

    fn weighted(&self, layers: &[Rgb]) -> Rgb {
        let sum =
            |sum: glam::DVec3, (weight, layer): (&Rgb, &Rgb)| sum + weight.as_dvec3() * layer.as_dvec3();
        self.weights.iter().zip(layers).fold(glam::DVec3::ZERO, sum).as_vec3()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radiance_weights_the_layers() {
        let mut film = Film::new(2, 1, vec![Rgb::ONE, Rgb::new(0.5, 0.0, 2.0)]);
        film.data[2] = Rgb::splat(0.25);
        film.data[3] = Rgb::ONE;
        assert_eq!(film.radiance().collect::<Vec<_>>(), [Rgb::ZERO, Rgb::new(0.75, 0.25, 2.25)]);
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
