//! Pixels: their samples and means.

use super::camera_rays::{PixelSamples, Placement, SampleGroup};
use super::context::TraceContext;
use super::scratch_pool::ScratchPool;
use super::settings::{Moment, TraceSettings};
use super::sums::valid;
use super::wavefront::{ScratchBuffer, WAVE};
use crate::base::math::DVec3;
use crate::base::stats::{Counts, Dropped};
use crate::film::{LayerId, lit};
use crate::sampling::{PixelSampler, TimePart};
use crate::scene::Scene;
use crate::scene::top_level::Bvh;
use std::ops::Range;
use std::sync::Arc;

/// Traces pixels of one frame at one moment.
pub struct PixelTracer<'a> {
    pub context: TraceContext<'a>,
    pub moment: Moment,
    /// Whether samples are random. Otherwise they form a regular grid.
    pub random: bool,
    pool: Arc<ScratchPool>,
    /// Distinguishes tracers that share a pool.
    number: u32,
}

/// A range of a pixel's samples. Different seeds give independent samples.
#[derive(Clone, Debug)]
pub struct SampleSet {
    pub samples: Range<u32>,
    pub seed: u32,
}

impl<'a> PixelTracer<'a> {
    pub fn new(scene: &'a Scene<'a>, bvh: &'a Bvh, settings: &'a TraceSettings, moment: Moment) -> Self {
        let context = TraceContext::new(scene, bvh, settings);
        let random = moment.of > 1 || context.is_random;
        Self { context, moment, random, pool: Arc::default(), number: 0 }
    }

    /// The same with a pool that it shares with tracers of other numbers.
    pub fn with_pool(self, pool: &Arc<ScratchPool>, number: u32) -> Self {
        Self { pool: Arc::clone(pool), number, ..self }
    }

    /// The same with random samples, whatever the scene needs.
    pub fn sampled(scene: &'a Scene<'a>, bvh: &'a Bvh, settings: &'a TraceSettings, moment: Moment) -> Self {
        Self { random: true, ..Self::new(scene, bvh, settings, moment) }
    }

    /// The number of traced layers, including dark ones.
    pub fn layers(&self) -> usize {
        self.context.layers
    }

    /// The layers that a film holds.
    pub fn held(&self) -> Vec<usize> {
        let lit = lit(&self.context.scene.weights.0).map(LayerId::index);
        lit.chain(self.context.lit_layers..self.context.layers).collect()
    }

    /// Adds the layers of pixels to `sums`, pixel by pixel: the means of their samples or, with several moments, the
    /// part of this moment. Neighbours should be next to each other.
    pub fn trace(&self, pixels: &[(u32, u32)], sums: &mut [DVec3]) -> Counts {
        let (first, count) = (self.context.settings.first_sample, self.count());
        let set = SampleSet { samples: first..first + count, seed: self.context.quality.seed };
        let counts = self.add(pixels, &set, sums);
        let samples = f64::from(count);
        if samples > 1.0 {
            sums.iter_mut().for_each(|sum| *sum /= samples);
        }
        counts
    }

    /// Adds a range of the pixels' samples to `sums` or, with several moments, those that belong to this one.
    pub fn add(&self, pixels: &[(u32, u32)], set: &SampleSet, sums: &mut [DVec3]) -> Counts {
        self.add_to_ends(pixels, (set, &[set.samples.end]), sums)
    }

    /// The same with a sum for each of the ascending `ends`, pixel by pixel: that of the samples with smaller numbers. The
    /// last end is that of the range.
    pub fn add_to_ends(
        &self,
        pixels: &[(u32, u32)],
        (set, ends): (&SampleSet, &[u32]),
        sums: &mut [DVec3],
    ) -> Counts {
        let mut scratch = self.take_scratch();
        let (mut samples, mut places) = scratch.take_samples();
        self.each_group(pixels, set, |group| {
            if samples.len() + group.places().len() > WAVE {
                self.follow(&mut scratch, (&mut samples, &mut places), (ends, sums));
            }
            samples.extend(group);
            places.extend_from_slice(group.places());
        });
        if samples.len() > 0 {
            self.follow(&mut scratch, (&mut samples, &mut places), (ends, sums));
        }
        scratch.give_back(samples, places);
        let counts = std::mem::take(&mut scratch.counts);
        self.give_back(scratch);
        counts
    }

    /// Traces the samples of the pixels at these places, and adds the results to the sums of the pixels, at each of the ends
    /// after their numbers.
    #[inline(never)]
    fn follow(
        &self,
        scratch: &mut ScratchBuffer,
        (samples, places): (&mut PixelSamples, &mut Vec<u32>),
        (ends, sums): (&[u32], &mut [DVec3]),
    ) {
        self.follow_samples(scratch, samples);
        let (limit, lit, layers) = (self.context.quality.clamp, self.context.lit_layers, self.layers());
        let all_light = scratch.sums.is_valid() && lit == layers && limit.is_none();
        let limit = limit.map(f64::from);
        let (numbers, mut start) = (samples.numbers(), 0);
        let ScratchBuffer { sums: light, counts, .. } = scratch;
        while let Some(&place) = places.get(start) {
            // Samples of a pixel follow each other, with ascending numbers; or they are few.
            let run = 1 + places[start + 1..].iter().take_while(|other| **other == place).count();
            // Grids of one sample have nothing else.
            if run == 1 && ends.len() == 1 && all_light {
                let own = place as usize * layers;
                for (layer, sum) in sums[own..own + layers].iter_mut().enumerate() {
                    *sum += light.get(layer, start as u32);
                }
                start += 1;
                continue;
            }
            let numbers = &numbers[start..start + run];
            let (first, last) = (numbers[0], numbers[run - 1]);
            let are_consecutive = (last - first) as usize == run - 1;
            // How many of them have numbers below the end of a part.
            let below = |part: usize| {
                let end = ends[part];
                if end > last {
                    run
                } else if are_consecutive {
                    end.saturating_sub(first) as usize
                } else {
                    numbers.partition_point(|number| *number < end)
                }
            };
            for layer in 0..layers {
                let own = |part: usize| (place as usize * ends.len() + part) * layers + layer;
                // Sums that are equal at all ends, as before a first visit, have their first samples in common.
                let is_one = (1..ends.len()).all(|part| sums[own(part)] == sums[own(0)]);
                let are_valid = all_light || layer >= lit;
                if is_one && are_valid {
                    let [r, g, b] = light.of_samples(layer, start..start + run);
                    let (mut sum, mut counted) = (sums[own(0)], 0);
                    for part in 0..ends.len() {
                        let count = below(part);
                        for slot in counted..count {
                            sum += DVec3::new(r[slot], g[slot], b[slot]);
                        }
                        (sums[own(part)], counted) = (sum, count);
                    }
                    continue;
                }
                let mut dropped = Dropped::default();
                for part in 0..ends.len() {
                    dropped = Dropped::default();
                    for slot in start..start + below(part) {
                        let sample = light.get(layer, slot as u32);
                        sums[own(part)] +=
                            if are_valid { sample } else { valid(sample, limit, &mut dropped) };
                    }
                }
                // All samples are below the last end, so each is counted once.
                counts.dropped += dropped;
            }
            start += run;
        }
        samples.clear();
        places.clear();
    }

    /// Traces samples, at most [`WAVE`]. Then the scratch buffer holds the light of each.
    pub fn follow_samples(&self, scratch: &mut ScratchBuffer, samples: &PixelSamples) {
        let placement =
            if self.random { Placement::Random } else { Placement::Grid(self.context.quality.antialias) };
        scratch.follow(&self.context, samples, placement);
    }

    /// A scratch buffer that no thread is using.
    pub fn take_scratch(&self) -> ScratchBuffer {
        self.pool.take(self.number, &self.context)
    }

    /// Returns a scratch buffer.
    pub fn give_back(&self, scratch: ScratchBuffer) {
        self.pool.give_back(self.number, scratch);
    }

    /// The number of samples of a pixel.
    pub fn count(&self) -> u32 {
        let quality = self.context.quality;
        if self.random { quality.samples } else { quality.antialias * quality.antialias }
    }

    /// Passes all samples at this moment to `take`, eight at a time. Samples of a group are close to each other:
    /// samples of one pixel, or one sample each of eight neighbours.
    #[inline]
    pub fn each_group(&self, pixels: &[(u32, u32)], set: &SampleSet, mut take: impl FnMut(&SampleGroup)) {
        let Moment { index, of } = self.moment;
        if of > 1 && set.samples.len() >= MANY {
            return self.each_group_of_part(pixels, set, &mut take);
        }
        let at_once = if set.samples.len() < 8 { 8 } else { 1 };
        let (mut group, mut numbers) = (SampleGroup::default(), [PixelSampler::new((0, 0), 0); 8]);
        for (block, pixels) in pixels.chunks(at_once).enumerate() {
            // Grids use no random numbers.
            if self.random {
                for (numbers, pixel) in numbers.iter_mut().zip(pixels) {
                    *numbers = PixelSampler::new(*pixel, set.seed);
                }
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

    /// [`PixelTracer::each_group`] for many samples of a pixel, of which few see this moment.
    #[inline(never)]
    fn each_group_of_part(&self, pixels: &[(u32, u32)], set: &SampleSet, take: &mut dyn FnMut(&SampleGroup)) {
        let part = TimePart::new(self.moment.index, self.moment.of);
        let mut group = SampleGroup::default();
        for (place, pixel) in (0..).zip(pixels) {
            let numbers = PixelSampler::new(*pixel, set.seed);
            part.each_sample(numbers, set.samples.clone(), |number| {
                if group.push(place, *pixel, number, numbers.sample(number)) {
                    take(&group);
                    group.clear();
                }
            });
        }
        take(&group);
    }
}

/// From so many samples of a pixel on, those of a moment are found faster by their numbers than by trying all.
const MANY: usize = 4;
