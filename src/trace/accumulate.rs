//! Sums of light per layer and sample of a wave.

use crate::base::color::Rgb;
use crate::base::lanes::{Bits, Color, Level, Mask, Real, Row, SimdKernel, Single, dispatch, lanes};
use crate::base::math::DVec3;
use crate::film::LayerId;
use std::ops::Range;

/// Sums of light: for each layer and each of its channels, one number per sample.
#[derive(Default)]
pub struct Accumulator {
    layers: usize,
    /// Numbers per channel: the samples, and padding for the lanes behind the last one.
    length: usize,
    sums: Vec<f64>,
}

impl Accumulator {
    pub fn new(layers: usize) -> Self {
        Self { layers, ..Self::default() }
    }

    /// Prepares for films of this number of layers.
    pub fn fit(&mut self, layers: usize) {
        self.layers = layers;
    }

    /// Clears the sums for this number of samples.
    pub fn reset(&mut self, samples: usize) {
        self.length = samples + 8;
        self.sums.clear();
        self.sums.resize(3 * self.layers * self.length, 0.0);
    }

    /// Adds light to a layer of the samples `slots`, in the lanes of a mask.
    #[inline(always)]
    pub fn add<F: Real>(&mut self, layer: LayerId, light: Color<F::F32>, mask: F::Mask, slots: F::U32) {
        let mut consecutive = F::U32::splat(0).to_array();
        for lane in 0..F::LANES {
            consecutive[lane] = lane as u32;
        }
        let all = slots.to_array();
        let consecutive = F::U32::splat(all[0]).wrapping_add(F::U32::from_array(consecutive));
        if !(mask & !slots.eq(consecutive)).any() {
            let at = self.place(layer.index(), all[0]);
            self.add_row(at, F::select(mask, light.r.to_f64(), F::splat(0.0)));
            self.add_row(at + self.length, F::select(mask, light.g.to_f64(), F::splat(0.0)));
            self.add_row(at + 2 * self.length, F::select(mask, light.b.to_f64(), F::splat(0.0)));
            return;
        }
        let (r, g, b, slots) = (light.r.to_array(), light.g.to_array(), light.b.to_array(), all);
        for lane in lanes(mask.bits()) {
            self.add_to(layer, Rgb::new(r[lane], g[lane], b[lane]), slots[lane]);
        }
    }

    /// Adds light to a layer of one sample.
    #[inline(always)]
    pub fn add_to(&mut self, layer: LayerId, light: Rgb, slot: u32) {
        let at = self.place(layer.index(), slot);
        for (channel, light) in light.to_array().into_iter().enumerate() {
            self.sums[at + channel * self.length] += f64::from(light);
        }
    }

    /// The sum of a layer of a sample.
    #[inline]
    pub fn get(&self, layer: usize, slot: u32) -> DVec3 {
        let at = self.place(layer, slot);
        DVec3::new(self.sums[at], self.sums[at + self.length], self.sums[at + 2 * self.length])
    }

    /// The channels of a layer of consecutive samples.
    #[inline]
    pub fn of_samples(&self, layer: usize, slots: Range<usize>) -> [&[f64]; 3] {
        let (at, count) = (3 * layer * self.length + slots.start, slots.len());
        [0, 1, 2].map(|channel| &self.sums[at + channel * self.length..][..count])
    }

    /// Replaces the sum of a layer of a sample.
    pub fn set(&mut self, layer: usize, slot: u32, sum: DVec3) {
        let at = self.place(layer, slot);
        for (channel, number) in sum.to_array().into_iter().enumerate() {
            self.sums[at + channel * self.length] = number;
        }
    }

    /// The index of the first channel of a layer of a sample.
    #[inline(always)]
    fn place(&self, layer: usize, slot: u32) -> usize {
        3 * layer * self.length + slot as usize
    }

    #[inline(always)]
    fn add_row<F: Real>(&mut self, at: usize, light: F) {
        (F::load(&self.sums, at) + light).store(&mut self.sums, at);
    }

    /// Whether all sums are finite and not negative.
    pub fn is_valid(&self) -> bool {
        dispatch(AllValid(&self.sums))
    }
}

/// Tests that all numbers are finite and not negative.
struct AllValid<'a>(&'a [f64]);

impl SimdKernel for AllValid<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Level>(self) -> bool {
        let (zero, infinity) = (L::F64::splat(0.0), L::F64::splat(f64::INFINITY));
        let mut all = L::Mask::splat(true);
        let (eights, rest) = self.0.as_chunks::<8>();
        for eight in eights {
            let values = L::F64::load(eight, 0);
            all = all & zero.le(values) & values.lt(infinity);
        }
        !(!all).any() && rest.iter().all(|value| *value >= 0.0 && *value < f64::INFINITY)
    }
}
