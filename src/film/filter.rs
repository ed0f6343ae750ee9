//! Reconstruction filters: how light around the centre of a pixel contributes to it.
//!
//! Filters are importance-sampled, not splatted. A sample is placed around the centre of its pixel with the density
//! of the filter, and contributes to this pixel only, with weight 1 (Ernst, Stamminger, Greiner, *Filter Importance
//! Sampling*, 2006). All filters are separable, with the same filter along x and y, so each axis is sampled
//! separately.

use crate::base::digest::Content;
use crate::base::lanes::Real;
use std::f64::consts::PI;
use std::ops::Range;

/// A filter along one axis of the picture. It is symmetric, not negative, and 0 beyond half its width.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
pub struct Filter {
    pub kernel: Kernel,
    /// Full width of the support in pixels, above 0.
    pub width: f64,
}

/// The shape of a filter, over t from -1 to 1 on its support.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Content)]
pub enum Kernel {
    /// Constant.
    Box,
    /// 1 - |t|.
    Tent,
    /// A normal distribution that is truncated at three standard deviations and shifted down to 0 there.
    Gaussian,
    /// The window of Harris, *On the Use of Windows for Harmonic Analysis*, 1978, with four terms and -92 dB.
    BlackmanHarris,
}

impl Filter {
    /// The mean over the square of the pixel.
    pub const PIXEL: Self = Self { kernel: Kernel::Box, width: 1.0 };
}

/// Uses the usual width of the kernel.
impl From<Kernel> for Filter {
    fn from(kernel: Kernel) -> Self {
        let width = match kernel {
            Kernel::Box => 1.0,
            Kernel::Tent => 2.0,
            Kernel::Gaussian | Kernel::BlackmanHarris => 3.0,
        };
        Self { kernel, width }
    }
}

/// Half the square of 3, the standard deviations in half the width of the Gaussian.
const GAUSSIAN: f64 = 4.5;

/// The weights of the cosines of the Blackman-Harris window.
const HARRIS: [f64; 4] = [0.35875, 0.48829, 0.14128, 0.01168];

impl Kernel {
    /// The kernel at t in 0..=1, up to a factor.
    fn value(self, t: f64) -> f64 {
        let cosine = |k: f64, weight: f64| weight * libm::cos(k * PI * t);
        match self {
            Self::Box => 1.0,
            Self::Tent => 1.0 - t,
            Self::Gaussian => libm::exp(-GAUSSIAN * t * t) - libm::exp(-GAUSSIAN),
            Self::BlackmanHarris => {
                let [mean, a, b, c] = HARRIS;
                mean + cosine(1.0, a) + cosine(2.0, b) + cosine(3.0, c)
            }
        }
    }

    /// The integral of the kernel from t to 1, up to a factor, for t in 0..=1.
    fn tail(self, t: f64) -> f64 {
        match self {
            Self::Box => 1.0 - t,
            Self::Tent => 0.5 * (1.0 - t) * (1.0 - t),
            Self::Gaussian => {
                // The integral of exp(-4.5 t²) minus its value at the edge.
                let root = GAUSSIAN.sqrt();
                let bell = libm::erf(root) - libm::erf(root * t);
                0.5 * PI.sqrt() / root * bell - libm::exp(-GAUSSIAN) * (1.0 - t)
            }
            Self::BlackmanHarris => {
                let wave = |k: f64, weight: f64| weight * libm::sin(k * PI * t) / (k * PI);
                let [mean, a, b, c] = HARRIS;
                mean * (1.0 - t) - wave(1.0, a) - wave(2.0, b) - wave(3.0, c)
            }
        }
    }

    /// The t at which the tail is `share` of the tail at 0, for shares between 0 and 1. Bisection finds it to the
    /// last bit.
    fn quantile(self, share: f64) -> f64 {
        let wanted = share * self.tail(0.0);
        let (mut low, mut high) = (0.0, 1.0);
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return middle;
            }
            if self.tail(middle) > wanted { low = middle } else { high = middle }
        }
    }
}

/// The number of steps of the table of a sampler.
const STEPS: usize = 256;

/// A filter that is prepared for sampling. The preparation takes about a millisecond, a sample a few nanoseconds.
#[derive(Clone, Debug, PartialEq)]
pub struct FilterSampler {
    /// In pixels.
    width: f64,
    /// For kernels that are not constant: the t beyond which one side has the fraction v² of its integral, for v from 0
    /// to 1 in even steps. For kernels that fall to 0 at their edge, t is nearly linear in v; for a tent exactly.
    side: Option<Box<[f64; STEPS + 1]>>,
}

impl FilterSampler {
    pub fn new(filter: Filter) -> Self {
        let quantile = |i: usize| match i as f64 / STEPS as f64 {
            0.0 => 1.0,
            1.0 => 0.0,
            v => filter.kernel.quantile(v * v),
        };
        let side = (filter.kernel != Kernel::Box).then(|| Box::new(std::array::from_fn(quantile)));
        Self { width: filter.width, side }
    }

    /// The offset of a sample along one axis, in pixels from the centre of the pixel. Uniform `u` in 0..=1 give the
    /// density of the filter. The offset increases with `u`, and is 0 for 1/2.
    #[inline(always)]
    pub fn offset<F: Real>(&self, u: F) -> F {
        let (half, one) = (F::splat(0.5), F::splat(1.0));
        let Some(side) = &self.side else { return (u - half) * F::splat(self.width) };
        let left = u.lt(half);
        // This is exact, so the sides mirror each other.
        let beyond = F::select(left, u, one - u);
        let v = (F::splat(2.0) * beyond).sqrt() * F::splat(STEPS as f64);
        let step = v.floor().min(F::splat((STEPS - 1) as f64));
        let (steps, mut from) = (step.to_array(), step.to_array());
        let mut to = from;
        for lane in 0..F::LANES {
            let step = steps[lane] as usize;
            (from[lane], to[lane]) = (side[step], side[step + 1]);
        }
        let from = F::from_array(from);
        let t = from + (F::from_array(to) - from) * (v - step);
        F::select(left, F::splat(-0.5), half) * F::splat(self.width) * t
    }
}

/// A filter that is prepared for weighting samples at any distance.
#[derive(Clone, Debug, PartialEq)]
pub struct FilterWeights {
    width: f64,
    is_pixel: bool,
    /// The filter over t from 0 to 1 in even steps.
    side: Box<[f64; STEPS + 2]>,
}

impl FilterWeights {
    pub fn new(filter: Filter) -> Self {
        let value = |i: usize| filter.kernel.value((i as f64 / STEPS as f64).min(1.0));
        let (width, is_pixel) = (filter.width, filter == Filter::PIXEL);
        Self { width, is_pixel, side: Box::new(std::array::from_fn(value)) }
    }

    /// Whether the filter is the mean over the square of the pixel.
    #[inline(always)]
    pub fn is_pixel(&self) -> bool {
        self.is_pixel
    }

    /// The weight of a sample at this distance from the centre of a pixel along one axis, up to a factor: interpolated
    /// linearly between the steps of a table.
    #[inline]
    pub fn at(&self, offset: f64) -> f64 {
        let t = 2.0 * offset.abs() / self.width;
        if t >= 1.0 {
            return 0.0;
        }
        let place = t * STEPS as f64;
        let step = place as usize;
        self.side[step] + (self.side[step + 1] - self.side[step]) * (place - step as f64)
    }

    /// The integral of the weights over the plane, in square pixels.
    pub fn integral(&self) -> f64 {
        // The table is linear between its steps. Its last value is beyond the edge.
        let pieces = self.side.windows(2).take(STEPS).map(|step| 0.5 * (step[0] + step[1]));
        let along = self.width * pieces.sum::<f64>() / STEPS as f64;
        along * along
    }

    /// The pixels of a row or column of `length` that a sample at a position may reach.
    #[inline]
    pub fn reached(&self, position: f64, length: usize) -> Range<usize> {
        let half = self.width / 2.0;
        // Negative positions and those that are not numbers become 0.
        let first = (position - 0.5 - half).ceil() as usize;
        let last = (position + 0.5 + half).floor() as usize;
        first..last.min(length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Kernel; 4] = [Kernel::Box, Kernel::Tent, Kernel::Gaussian, Kernel::BlackmanHarris];
    const COUNT: usize = 100_000;

    /// The offsets of the midpoints of even steps.
    fn offsets(filter: Filter) -> Vec<f64> {
        let sampler = FilterSampler::new(filter);
        (0..COUNT).map(|i| sampler.offset((i as f64 + 0.5) / COUNT as f64)).collect()
    }

    /// The fractions of the kernel below `n` + 1 evenly spaced points from -1 to 1, by Simpson's rule.
    fn cumulated(kernel: Kernel, n: usize) -> Vec<f64> {
        let h = 2.0 / n as f64;
        let density = |t: f64| kernel.value(t.abs().min(1.0));
        let mut sums = vec![0.0];
        for i in 0..n {
            let a = -1.0 + i as f64 * h;
            let piece = density(a) + 4.0 * density(a + h / 2.0) + density(a + h);
            sums.push(sums[i] + piece);
        }
        let all = sums[n];
        sums.into_iter().map(|sum| sum / all).collect()
    }

    #[test]
    fn a_box_is_the_pixel_to_the_last_bit() {
        let sampler = FilterSampler::new(Filter::PIXEL);
        for i in 0..=1000 {
            let u = f64::from(i) / 1000.0;
            assert_eq!(sampler.offset(u).to_bits(), (u - 0.5).to_bits());
        }
        assert_eq!(Filter::from(Kernel::Box), Filter::PIXEL);
    }

    #[test]
    fn samples_have_the_density_of_the_filter() {
        for kernel in ALL {
            let n = 4000;
            let expected = cumulated(kernel, n);
            let offsets = offsets(Filter { kernel, width: 2.0 });
            for (i, expected) in expected.iter().enumerate() {
                let t = -1.0 + 2.0 * i as f64 / n as f64;
                let found = offsets.partition_point(|&x| x < t) as f64 / COUNT as f64;
                assert!((found - expected).abs() < 3e-5, "{kernel:?} at {t}: {found} for {expected}");
            }
        }
    }

    #[test]
    fn samples_ascend_within_the_width_and_mirror() {
        for kernel in ALL {
            for width in [0.1, 1.0, 3.0, 16.0] {
                let sampler = FilterSampler::new(Filter { kernel, width });
                assert_eq!([0.0, 0.5, 1.0].map(|u| sampler.offset(u)), [-width / 2.0, 0.0, width / 2.0]);
                let offsets = offsets(Filter { kernel, width });
                assert!(offsets.windows(2).all(|pair| pair[0] < pair[1]), "{kernel:?}");
                let mirrored = offsets.iter().zip(offsets.iter().rev());
                assert!(mirrored.into_iter().all(|(a, b)| (a + b).abs() < 1e-10 * width), "{kernel:?}");
            }
        }
    }

    #[test]
    fn means_are_zero_and_spreads_known() {
        // Variances over t: 1/3 for a box, 1/6 for a tent, the others by integration of their definition.
        for (kernel, variance) in ALL.into_iter().zip([1.0 / 3.0, 1.0 / 6.0, 0.101_98, 0.076_74]) {
            let offsets = offsets(Filter { kernel, width: 2.0 });
            let mean = offsets.iter().sum::<f64>() / COUNT as f64;
            let spread = offsets.iter().map(|x| x * x).sum::<f64>() / COUNT as f64;
            assert!(mean.abs() < 1e-12, "{kernel:?} {mean}");
            assert!((spread - variance).abs() < 2e-5, "{kernel:?} {spread}");
        }
    }
}
