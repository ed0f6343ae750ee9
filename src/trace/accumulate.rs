//! What the samples of a wave add to each layer.

use crate::color::Rgb;
use crate::film::LayerId;
use crate::lanes::{Color, Level, Mask, Real, Row, SimdKernel, dispatch, lanes};

/// Sums of light, sample after sample and of each its layers.
#[derive(Default)]
pub struct Accumulator {
    layers: usize,
    sums: Vec<[f64; 3]>,
}

impl Accumulator {
    pub fn new(layers: usize) -> Self {
        Self { layers, sums: Vec::new() }
    }

    /// Begins with so many samples.
    pub fn reset(&mut self, samples: usize) {
        self.sums.clear();
        self.sums.resize(samples * self.layers, [0.0; 3]);
    }

    /// Adds light to a layer of the samples in the lanes of a mask.
    #[inline(always)]
    pub fn add<F: Real>(&mut self, layer: LayerId, light: Color<F::F32>, mask: F::Mask, slots: F::U32) {
        let (r, g, b) = (light.r.to_array(), light.g.to_array(), light.b.to_array());
        let slots = slots.to_array();
        for lane in lanes(mask.bits()) {
            self.add_to(layer, Rgb::new(r[lane], g[lane], b[lane]), slots[lane]);
        }
    }

    /// Adds light to a layer of one sample.
    #[inline(always)]
    pub fn add_to(&mut self, layer: LayerId, light: Rgb, slot: u32) {
        let sum = &mut self.sums[slot as usize * self.layers + layer.index()];
        for (sum, light) in sum.iter_mut().zip(light.to_array()) {
            *sum += f64::from(light);
        }
    }

    /// A sample's layers from one on.
    pub fn layers_from(&mut self, layer: usize, slot: u32) -> &mut [[f64; 3]] {
        &mut self.sums[slot as usize * self.layers + layer..]
    }

    /// The layers of each sample.
    pub fn samples(&self) -> impl Iterator<Item = &[[f64; 3]]> {
        self.sums.chunks_exact(self.layers.max(1))
    }

    /// Whether all of the sums are finite and not below 0.
    pub fn is_light(&self) -> bool {
        dispatch(IsLight(self.sums.as_flattened()))
    }
}

/// Whether all of these numbers are finite and not below 0.
struct IsLight<'a>(&'a [f64]);

impl SimdKernel for IsLight<'_> {
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
