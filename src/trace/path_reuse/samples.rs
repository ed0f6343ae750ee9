//! The samples of some pixels, traced once for all frames.

use super::super::camera_rays::{PixelSamples, SampleGroup};
use super::super::pixels::{PixelTracer, SampleSet};
use super::super::sums::valid;
use super::super::wavefront::{ScratchBuffer, WAVE};
use super::gain::work;
use crate::base::math::DVec3;
use crate::base::stats::{Counts, Dropped};
use crate::sampling::PixelSampler;
use crate::scene::movers::FrameMask;
use std::ops::Range;

/// Samples of pixels, one pixel after the other.
pub struct SharedSamples<'p> {
    pixels: &'p [(u32, u32)],
    /// The number of each pixel's first sample, the number of its samples, and the layers of each.
    first: u32,
    count: u32,
    layers: usize,
    /// The light of each sample in each layer, without movers.
    light: Vec<DVec3>,
    /// The frames in which the light of each sample may differ.
    pub frames: Vec<FrameMask>,
    /// The moment of each sample, if frames have several.
    moments: Vec<u32>,
    /// The samples of each moment, ascending, if frames have several.
    by_moment: Vec<Vec<u32>>,
}

/// Samples of a frame that were traced again.
#[derive(Default)]
pub struct Retraced {
    /// Their indices, ascending.
    samples: Vec<u32>,
    light: Vec<DVec3>,
}

impl<'p> SharedSamples<'p> {
    /// Traces the samples of pixels with these numbers in the scene without movers. `moments` is the number of moments of
    /// frames that have several.
    pub fn trace(
        shared: &PixelTracer,
        (pixels, numbers): (&'p [(u32, u32)], Range<u32>),
        (all, moments): (FrameMask, u32),
        counts: &mut Counts,
    ) -> Self {
        let (first, count) = (numbers.start, numbers.len() as u32);
        let (seed, layers) = (shared.context.quality.seed, shared.layers());
        let size = pixels.len() * count as usize;
        let moment = |index: usize| {
            let (pixel, number) = (index / count as usize, first + (index % count as usize) as u32);
            PixelSampler::new(pixels[pixel], seed).part_of_time(number, moments)
        };
        let mut samples = Self {
            pixels,
            first,
            count,
            layers,
            light: vec![DVec3::ZERO; size * layers],
            frames: vec![0; size],
            moments: if moments > 1 { (0..size).map(moment).collect() } else { vec![0; size] },
            by_moment: Vec::new(),
        };
        if moments > 1 {
            samples.by_moment.resize(moments as usize, Vec::new());
            for (index, moment) in (0..).zip(&samples.moments) {
                samples.by_moment[*moment as usize].push(index);
            }
        }
        let mut scratch = shared.take_scratch();
        let (mut wave, mut indices) = scratch.take_samples();
        shared.each_group(pixels, &SampleSet { samples: numbers.clone(), seed }, |group| {
            if wave.len() + group.places().len() > WAVE {
                samples.follow(shared, &mut scratch, (&mut wave, &mut indices), all);
            }
            wave.extend(group);
            let places = group.places().iter().zip(group.numbers());
            indices.extend(places.map(|(place, number)| place * count + (number - first)));
        });
        if wave.len() > 0 {
            samples.follow(shared, &mut scratch, (&mut wave, &mut indices), all);
        }
        scratch.give_back(wave, indices);
        let traced = std::mem::take(&mut scratch.counts);
        counts.paths.once_rays += traced.rays.total();
        counts.paths.still_work += work(&traced.rays, std::mem::take(&mut scratch.marks.misses));
        counts.paths.tests += std::mem::take(&mut scratch.marks.tests);
        *counts += traced;
        shared.give_back(scratch);
        samples
    }

    /// Traces a wave of samples of these indices.
    fn follow(
        &mut self,
        shared: &PixelTracer,
        scratch: &mut ScratchBuffer,
        (wave, indices): (&mut PixelSamples, &mut Vec<u32>),
        all: FrameMask,
    ) {
        scratch.marks.reset(all, indices.iter().map(|index| self.moments[*index as usize]));
        shared.follow_samples(scratch, wave);
        for (slot, &index) in indices.iter().enumerate() {
            let index = index as usize;
            let light = &mut self.light[index * self.layers..][..self.layers];
            for (layer, light) in light.iter_mut().enumerate() {
                *light = scratch.sums.get(layer, slot as u32);
            }
            self.frames[index] = scratch.marks.frames[slot];
        }
        wave.clear();
        indices.clear();
    }

    /// Whether a frame has a sample at a moment; none means that it has all.
    fn is_at(&self, index: usize, moment: Option<u32>) -> bool {
        moment.is_none_or(|moment| self.moments[index] == moment)
    }

    /// Traces those samples of a frame's moment again that may differ.
    pub fn retrace(
        &self,
        whole: &PixelTracer,
        (frame, moment): (FrameMask, Option<u32>),
        counts: &mut Counts,
    ) -> Retraced {
        let mut again = Retraced::default();
        let differs = |index: &u32| self.frames[*index as usize] & frame != 0;
        match moment {
            None => again.samples.extend((0..self.frames.len() as u32).filter(differs)),
            Some(moment) => {
                again.samples.extend(self.by_moment[moment as usize].iter().copied().filter(differs))
            }
        }
        if again.samples.is_empty() {
            return again;
        }
        let mut scratch = whole.take_scratch();
        let (mut wave, places) = scratch.take_samples();
        for indices in again.samples.chunks(WAVE) {
            self.gather(indices, whole.context.quality.seed, &mut wave);
            whole.follow_samples(&mut scratch, &wave);
            for slot in 0..indices.len() {
                let light = (0..self.layers).map(|layer| scratch.sums.get(layer, slot as u32));
                again.light.extend(light);
            }
            wave.clear();
        }
        scratch.give_back(wave, places);
        let traced = std::mem::take(&mut scratch.counts);
        counts.paths.retraced_work += work(&traced.rays, 0);
        *counts += traced;
        whole.give_back(scratch);
        again
    }

    /// The wave of samples of these indices.
    fn gather(&self, indices: &[u32], seed: u32, wave: &mut PixelSamples) {
        let mut group = SampleGroup::default();
        for index in indices {
            let (pixel, number) =
                (self.pixels[(index / self.count) as usize], self.first + index % self.count);
            let sampler = PixelSampler::new(pixel, seed).sample(number);
            if group.push(0, pixel, number, sampler) {
                wave.extend(&group);
                group.clear();
            }
        }
        wave.extend(&group);
    }

    /// Adds the samples at a moment, without movers, to the sums of the pixels.
    fn add_still(
        &self,
        (tracer, moment): (&PixelTracer, Option<u32>),
        sums: &mut [DVec3],
        dropped: &mut Dropped,
    ) {
        let none = Retraced::default();
        for (pixel, sums) in sums.chunks_mut(self.layers).enumerate() {
            self.add((tracer, moment), (pixel, &none, &mut 0), sums, dropped);
        }
    }

    /// Adds a pose's samples to its sums of the pixels.
    pub fn add_to(
        &self,
        (tracer, moment): (&PixelTracer, Option<u32>),
        again: &Retraced,
        still: &StillSums,
        sums: &mut [DVec3],
        dropped: &mut Dropped,
    ) {
        let mut next = 0;
        let known = still.before.chunks(self.layers).zip(still.after.chunks(self.layers));
        for (pixel, (sums, (before, after))) in sums.chunks_mut(self.layers).zip(known).enumerate() {
            let is_in = |index: &u32| (index / self.count) as usize == pixel;
            // Adding the same samples to the same sums gives the same.
            if !again.samples.get(next).is_some_and(is_in) && same_bits(sums, before) {
                sums.copy_from_slice(after);
            } else {
                self.add((tracer, moment), (pixel, again, &mut next), sums, dropped);
            }
        }
    }

    /// Adds the samples of a pixel in their order. `next` counts those that were traced again.
    fn add(
        &self,
        (tracer, moment): (&PixelTracer, Option<u32>),
        (pixel, again, next): (usize, &Retraced, &mut usize),
        sums: &mut [DVec3],
        dropped: &mut Dropped,
    ) {
        let (limit, lit) = (tracer.context.quality.clamp.map(f64::from), tracer.context.lit_layers);
        let first = pixel * self.count as usize;
        for index in (first..first + self.count as usize).filter(|index| self.is_at(*index, moment)) {
            let mut light = &self.light[index * self.layers..][..self.layers];
            if again.samples.get(*next) == Some(&(index as u32)) {
                light = &again.light[*next * self.layers..][..self.layers];
                *next += 1;
            }
            for (layer, (sum, light)) in sums.iter_mut().zip(light).enumerate() {
                if layer < lit {
                    *sum += valid(*light, limit, dropped);
                } else {
                    *sum += *light;
                }
            }
        }
    }
}

impl Retraced {
    pub fn len(&self) -> usize {
        self.samples.len()
    }
}

/// The sums of pixels at a moment without movers.
pub struct StillSums {
    /// Without the last samples, and with them.
    before: Vec<DVec3>,
    after: Vec<DVec3>,
    /// The number of the first of these samples in each pixel.
    last: Option<u32>,
}

impl StillSums {
    pub fn new(zero: &[DVec3]) -> Self {
        Self { before: zero.to_vec(), after: zero.to_vec(), last: None }
    }

    /// Adds samples, unless they are in the sums already.
    pub fn add(
        &mut self,
        tracer: (&PixelTracer, Option<u32>),
        samples: &SharedSamples,
        dropped: &mut Dropped,
    ) {
        if self.last != Some(samples.first) {
            self.last = Some(samples.first);
            self.before.clone_from(&self.after);
            samples.add_still(tracer, &mut self.after, dropped);
        }
    }
}

fn same_bits(a: &[DVec3], b: &[DVec3]) -> bool {
    let bits = |sum: &DVec3| sum.to_array().map(f64::to_bits);
    a.iter().map(bits).eq(b.iter().map(bits))
}
