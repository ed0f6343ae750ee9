//! Sums of squares of light whose weights are known only later.
//!
//! With layers d and weights w, the square of Σ w d is Σ w w' d d'. So the sums of products of pairs of layers give the
//! square for any weights.

use super::block::{PixelArray, ShortList};
use crate::base::color::Rgb;
use crate::base::math::DVec3;

/// The sum of the products of every two layers, by colour.
#[derive(Clone, Debug, Default)]
pub struct LayerProducts(ShortList<DVec3>);

impl LayerProducts {
    /// Of the layers of some pixels, times a factor.
    pub fn new(layers: &[PixelArray<DVec3>], factor: f64) -> Self {
        let mut sums = ShortList::with_capacity(layers.len() * (layers.len() + 1) / 2);
        for (index, a) in layers.iter().enumerate() {
            sums.extend(
                layers[..=index]
                    .iter()
                    .map(|b| factor * a.iter().zip(b).fold(DVec3::ZERO, |sum, (a, b)| sum + *a * *b)),
            );
        }
        Self(sums)
    }

    /// Replaces the sums by the mean of themselves and `share` times the others.
    pub fn mean(&mut self, others: &Self, share: f64) {
        self.0.iter_mut().zip(&others.0).for_each(|(own, other)| *own = 0.5 * (*own + share * *other));
    }

    /// The sum of squares of light with these weights, as a mean over colours.
    pub fn weighted(&self, weights: &[Rgb]) -> f64 {
        let mut sums = self.0.iter();
        let mut all = DVec3::ZERO;
        for (index, a) in weights.iter().enumerate() {
            for (other, (b, sum)) in weights[..=index].iter().zip(&mut sums).enumerate() {
                let twice = if other == index { 1.0 } else { 2.0 };
                all += twice * a.as_dvec3() * b.as_dvec3() * *sum;
            }
        }
        all.element_sum() / 3.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_of_any_weights() {
        let pixels = [[1.0, -2.0, 0.5], [0.25, 3.0, -1.0]].map(|layers| layers.map(DVec3::splat));
        let layers = [0, 1, 2].map(|layer| {
            let mut all = PixelArray::default();
            (all[0], all[1]) = (pixels[0][layer], pixels[1][layer]);
            all
        });
        let products = LayerProducts::new(&layers, 2.0);
        for weights in [[1.0, 0.0, 0.0], [0.5, 2.0, 0.25], [0.0, 1.0, 4.0]] {
            let weighted = |layers: &[DVec3; 3]| -> f64 {
                layers.iter().zip(weights).map(|(layer, weight)| layer.x * weight).sum()
            };
            let wanted: f64 = pixels.iter().map(|layers| 2.0 * weighted(layers) * weighted(layers)).sum();
            assert_eq!(products.weighted(&weights.map(|weight| Rgb::splat(weight as f32))), wanted);
        }
    }
}
