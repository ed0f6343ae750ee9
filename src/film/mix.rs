//! The mean of two films: of frames that two cameras show together, and of separate samples of one frame.

use super::{Film, Noise};
use crate::base::color::Rgb;
use std::sync::Arc;

#[warn(missing_docs)]
impl Film {
    /// The weighted mean of two films of the same size with the same layers and weights: `share`, between 0 and 1, is that
    /// of the other one. Light is linear, so this is what a film would hold that was exposed to both.
    pub fn mixed_with(&self, other: &Self, share: f64) -> Self {
        let mix = |(one, other): (&Rgb, &Rgb)| {
            (one.as_dvec3() * (1.0 - share) + other.as_dvec3() * share).as_vec3()
        };
        let data = self.data.iter().zip(other.data.iter()).map(mix).collect();
        let means = [(self, 1.0 - share), (other, share)].map(|(film, share)| share * film.mean());
        let noise = |(one, other): (Noise, Noise)| one.mixed_with(other, means);
        let noises = self.noises.iter().copied().zip(other.noises.iter().copied());
        let mixed = self.noise.zip(other.noise).map(noise);
        let noises: Arc<[Noise]> = noises.map(noise).collect();
        let samples = (self.samples.is_some() || other.samples.is_some()).then(|| {
            let pixels = 0..self.width as usize * self.height as usize;
            let both = |pixel| self.samples_of(pixel).iter().zip(other.samples_of(pixel));
            Arc::new(pixels.flat_map(both).map(mix).collect())
        });
        Self {
            data: Arc::new(data),
            samples,
            noise: mixed,
            // Denoised films know their error with any weights; their mean knows that with its own.
            noises: if noises.is_empty() { mixed.into_iter().collect() } else { noises },
            remaining: None,
            unfinished: self.unfinished || other.unfinished,
            ..self.clone()
        }
    }

    /// The mean of the radiance over pixels and colours.
    fn mean(&self) -> f64 {
        let pixels = f64::from(self.width) * f64::from(self.height);
        self.radiance().map(|light| f64::from(light.element_sum()) / 3.0).sum::<f64>() / pixels
    }
}

impl Noise {
    /// The noise of a weighted mean of two films. `means` are the means of the films times their weights: errors are
    /// relative to them. The films may be sampled alike, so their errors may add up.
    fn mixed_with(self, other: Self, means: [f64; 2]) -> Self {
        let all = means[0] + means[1];
        let [one, two] = means.map(|mean| if all > 0.0 { mean / all } else { 0.5 });
        // The unknown error of a film that adds nothing does not count.
        let part = |share: f64, error: f64| if share == 0.0 { 0.0 } else { share * error };
        let sum = |a: f64, b: f64| part(one, a) + part(two, b);
        Self {
            error: sum(self.error, other.error),
            // If the errors are independent.
            low: libm::hypot(one * self.low, two * other.low),
            high: sum(self.high, other.high),
            samples: self.samples + other.samples,
            capped: self.capped.max(other.capped),
            denoised: self.denoised.max(other.denoised),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film(value: f32, error: f64) -> Film {
        let mut film = Film::new(2, 1, vec![Rgb::splat(2.0)]);
        film.data_mut().fill(Rgb::splat(value));
        let noise =
            Noise { error, low: error / 2.0, high: 2.0 * error, samples: 8.0, capped: 0.25, denoised: None };
        Film { noise: Some(noise), noises: [noise].into(), ..film }
    }

    #[test]
    fn radiance_is_mixed_linearly() {
        let mixed = film(1.0, 0.1).mixed_with(&film(5.0, 0.1), 0.25);
        assert_eq!(mixed.radiance().collect::<Vec<_>>(), [Rgb::splat(4.0); 2]);
        let infinite = film(1.0, 0.1).mixed_with(&film(f32::INFINITY, 0.1), 0.25);
        assert_eq!(infinite.radiance_at(0), Rgb::splat(f32::INFINITY));
    }

    #[test]
    fn samples_are_mixed_too() {
        let denoised = Film { samples: Some(Arc::new(vec![Rgb::splat(3.0); 2])), ..film(1.0, 0.1) };
        let mixed = denoised.mixed_with(&film(5.0, 0.1), 0.25);
        assert_eq!((mixed.radiance_at(1), mixed.samples_at(1)), (Rgb::splat(4.0), Rgb::splat(7.0)));
        assert_eq!(film(1.0, 0.1).mixed_with(&film(5.0, 0.1), 0.25).samples, None);
    }

    #[test]
    fn errors_are_relative_to_the_mixed_light() {
        // The second film gives 3 parts of 4 of the light, and all of the error.
        let mixed = film(1.0, 0.0).mixed_with(&film(3.0, 0.04), 0.5);
        let noise = mixed.noise.expect("noise");
        assert!((noise.error - 0.03).abs() < 1e-12 && (noise.low - 0.015).abs() < 1e-12, "{noise:?}");
        assert_eq!((noise.samples, noise.capped, mixed.noises.len()), (16.0, 0.25, 1));
    }
}
