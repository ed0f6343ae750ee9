//! Pixels: their samples, and the means of these.

use super::context::TraceContext;
use super::generate::{PixelSamples, SampleGroup};
use super::sums::add;
use super::wavefront::{ScratchBuffer, WAVE};
use super::{Moment, TraceSettings};
use crate::base::math::DVec3;
use crate::base::stats::Counts;
use crate::film::{LayerId, lit};
use crate::sampling::PixelSampler;
use crate::scene::Scene;
use crate::scene::top_level::Bvh;
use std::ops::Range;
use std::sync::Mutex;

/// A frame's scene with all that its pixels have in common.
pub struct Pixels<'a> {
    pub context: TraceContext<'a>,
    pub moment: Moment,
    /// Whether samples are drawn at random; else they stand on a regular grid.
    pub random: bool,
    /// What threads trace with, while none does.
    scratch: Mutex<Vec<ScratchBuffer>>,
}

/// Some of a pixel's samples. Another seed gives independent ones.
#[derive(Clone, Debug)]
pub struct SampleSet {
    pub samples: Range<u32>,
    pub seed: u32,
}

impl<'a> Pixels<'a> {
    pub fn new(scene: &'a Scene<'a>, bvh: &'a Bvh, settings: &'a TraceSettings, moment: Moment) -> Self {
        let context = TraceContext::new(scene, bvh, settings);
        let random = moment.of > 1 || context.is_random;
        Self { context, moment, random, scratch: Mutex::default() }
    }

    /// The same with samples drawn at random, whatever the scene calls for.
    pub fn sampled(scene: &'a Scene<'a>, bvh: &'a Bvh, settings: &'a TraceSettings, moment: Moment) -> Self {
        Self { random: true, ..Self::new(scene, bvh, settings, moment) }
    }

    /// How many layers are traced, dark ones among them.
    pub fn layers(&self) -> usize {
        self.context.layers
    }

    /// Those of them that a film holds.
    pub fn held(&self) -> Vec<usize> {
        let lit = lit(&self.context.scene.weights.0).map(LayerId::index);
        lit.chain(self.context.lit_layers..self.context.layers).collect()
    }

    /// Adds pixels' layers, one pixel after the other, to `sums`: the means of their samples or, of several moments, this
    /// moment's part of them. Neighbours should follow each other.
    pub fn trace(&self, pixels: &[(u32, u32)], sums: &mut [DVec3]) -> Counts {
        let set = SampleSet { samples: 0..self.count(), seed: self.context.quality.seed };
        let counts = self.add(pixels, &set, sums);
        let samples = f64::from(self.count());
        sums.iter_mut().for_each(|sum| *sum /= samples);
        counts
    }

    /// Adds some of the pixels' samples to `sums` or, of several moments, those that fall on this one.
    pub fn add(&self, pixels: &[(u32, u32)], set: &SampleSet, sums: &mut [DVec3]) -> Counts {
        let mut scratch = self.take_scratch();
        let (mut samples, mut places) = scratch.take_samples();
        self.each_group(pixels, set, |group| {
            if samples.len() + group.places().len() > WAVE {
                self.follow(&mut scratch, (&mut samples, &mut places), sums);
            }
            samples.extend(group);
            places.extend_from_slice(group.places());
        });
        if samples.len() > 0 {
            self.follow(&mut scratch, (&mut samples, &mut places), sums);
        }
        scratch.give_back(samples, places);
        let counts = std::mem::take(&mut scratch.counts);
        self.give_back(scratch);
        counts
    }

    /// Follows samples of the pixels at these places, and adds what they get to the sums of these.
    #[inline(never)]
    fn follow(
        &self,
        scratch: &mut ScratchBuffer,
        (samples, places): (&mut PixelSamples, &mut Vec<u32>),
        sums: &mut [DVec3],
    ) {
        let grid = (!self.random).then_some(self.context.quality.antialias);
        scratch.follow(&self.context, samples, grid);
        let (limit, lit, layers) = (self.context.quality.clamp, self.context.lit_layers, self.layers());
        let all_light = scratch.sums.is_light() && lit == layers && limit.is_none();
        for (slot, place) in (0..).zip(&*places) {
            let sums = &mut sums[*place as usize * layers..][..layers];
            for (layer, sum) in sums.iter_mut().enumerate() {
                let sample = scratch.sums.get(layer, slot);
                if all_light || layer >= lit {
                    *sum += sample;
                } else {
                    add(sum, sample, limit.map(f64::from), &mut scratch.counts.dropped);
                }
            }
        }
        samples.clear();
        places.clear();
    }

    fn take_scratch(&self) -> ScratchBuffer {
        let free = self.scratch.lock().ok().and_then(|mut free| free.pop());
        free.unwrap_or_else(|| ScratchBuffer::new(&self.context))
    }

    fn give_back(&self, scratch: ScratchBuffer) {
        if let Ok(mut free) = self.scratch.lock() {
            free.push(scratch);
        }
    }

    /// How many samples a pixel has.
    fn count(&self) -> u32 {
        let quality = self.context.quality;
        if self.random { quality.samples } else { quality.antialias * quality.antialias }
    }

    /// Gives all samples at this moment to `take`, eight at a time, such that these see about the same: samples of one pixel,
    /// or one sample each of eight neighbours.
    #[inline]
    fn each_group(&self, pixels: &[(u32, u32)], set: &SampleSet, mut take: impl FnMut(&SampleGroup)) {
        let Moment { index, of } = self.moment;
        let at_once = if set.samples.len() < 8 { 8 } else { 1 };
        let (mut group, mut numbers) = (SampleGroup::default(), [PixelSampler::new((0, 0), 0); 8]);
        for (block, pixels) in pixels.chunks(at_once).enumerate() {
            for (numbers, pixel) in numbers.iter_mut().zip(pixels) {
                *numbers = PixelSampler::new(*pixel, set.seed);
            }
            for number in set.samples.clone() {
                for (place, (pixel, numbers)) in pixels.iter().zip(&numbers).enumerate() {
                    if of > 1 && numbers.part_of_time(number, of) != index {
                        continue;
                    }
                    let place = (block * at_once + place) as u32;
                    if group.push(place, *pixel, number, numbers.sample(number)) {
                        take(&group);
                        group.clear();
                    }
                }
            }
        }
        take(&group);
    }
}
