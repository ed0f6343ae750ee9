//! The film: what the tracer fills and the encoder develops.

use crate::color::Rgb;

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
    /// Row by row from the top left pixel; each pixel holds its layers one after the other.
    pub data: Vec<Rgb>,
}

impl Film {
    pub fn new(width: u32, height: u32, weights: Vec<Rgb>) -> Self {
        let data = vec![Rgb::ZERO; width as usize * height as usize * weights.len()];
        Self { width, height, weights, data }
    }

    pub fn layers(&self) -> usize {
        self.weights.len()
    }

    /// The weighted sum of every pixel's layers, row by row: f64 in the order of the layers, rounded once.
    pub fn radiance(&self) -> impl Iterator<Item = Rgb> {
        self.data.chunks_exact(self.layers()).map(|pixel| {
            let sum =
                |sum: glam::DVec3, (weight, layer): (&Rgb, &Rgb)| sum + weight.as_dvec3() * layer.as_dvec3();
            self.weights.iter().zip(pixel).fold(glam::DVec3::ZERO, sum).as_vec3()
        })
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
}
