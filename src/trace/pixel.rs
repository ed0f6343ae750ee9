//! A pixel: its samples, and their mean.

use super::path::Paths;
use super::together::Sums;
use super::tracer::{Dice, Tracer, Work};
use super::{Moment, TraceSettings, guides, together, whitted};
use crate::bvh::Bvh;
use crate::camera::{Beam, Ray};
use crate::counters::Dropped;
use crate::film::{Extras, LayerId};
use crate::math::{DVec2, DVec3};
use crate::quality::Integrator;
use crate::sampling::{PixelSampler, Sampler, Use};
use crate::scene::{Primitive, Scene};
use std::ops::Range;

/// A frame's scene with all that its pixels have in common.
pub struct Pixels<'a> {
    pub settings: &'a TraceSettings,
    pub moment: Moment,
    tracer: Tracer<'a>,
    /// None for Whitted's integrator.
    paths: Option<Paths<'a>>,
    /// Whether samples are drawn at random; else they stand on a regular grid.
    pub random: bool,
    /// How many layers hold light.
    lights: usize,
    /// Where guides are recorded, if they are.
    guides: Option<LayerId>,
    /// Whether pixels are traced eight at a time.
    pub together: bool,
}

impl<'a> Pixels<'a> {
    pub fn new(scene: &'a Scene<'a>, bvh: &'a Bvh, settings: &'a TraceSettings, moment: Moment) -> Self {
        let quality = &settings.quality;
        let refractive_shadows = match quality.integrator {
            Integrator::Whitted => true,
            Integrator::Path(path) => path.refractive_shadows,
        };
        let lights = scene.weights.0.len();
        let mut tracer = Tracer::new(scene, bvh, quality, refractive_shadows);
        tracer.holdout = settings.extras.coverage_layer(lights);
        let paths = match quality.integrator {
            Integrator::Whitted => None,
            Integrator::Path(path) => Some(Paths::new(&tracer, path)),
        };
        let random = paths.is_some() || moment.of > 1 || calls_for_samples(scene, &tracer);
        let guides = settings.extras.guides_layer(lights);
        // Eight at a time only light is recorded.
        let together = !random && settings.extras == Extras::default() && together::suits(&tracer);
        Self { settings, moment, tracer, paths, random, lights, guides, together }
    }

    /// The same with samples drawn at random, whatever the scene calls for.
    pub fn sampled(scene: &'a Scene<'a>, bvh: &'a Bvh, settings: &'a TraceSettings, moment: Moment) -> Self {
        Self { random: true, together: false, ..Self::new(scene, bvh, settings, moment) }
    }

    /// Adds a pixel's layers to `sums`: the mean of its samples or, of several moments, this moment's part of
    /// it.
    pub fn trace(&self, pixel: (u32, u32), sums: &mut [DVec3], work: &mut Work) {
        let quality = &self.settings.quality;
        let samples = if self.random { quality.samples } else { quality.antialias * quality.antialias };
        self.add(pixel, 0..samples, quality.seed, sums, work);
        for sum in sums {
            *sum /= f64::from(samples);
        }
    }

    /// Adds some samples of a pixel to `sums` or, of several moments, those that fall on this one. Another seed gives
    /// independent ones.
    pub fn add(
        &self,
        pixel: (u32, u32),
        samples: Range<u32>,
        seed: u32,
        sums: &mut [DVec3],
        work: &mut Work,
    ) {
        let numbers = PixelSampler::new(pixel, seed).with(self.settings.quality.points);
        let Moment { index, of } = self.moment;
        for sample in samples {
            if of > 1 && numbers.part_of_time(sample, of) != index {
                continue;
            }
            let sampler = numbers.sample(sample);
            let (inside, lens) = self.place(sample, &sampler);
            self.sample(pixel, inside, lens, sampler, work);
            self.take(sums, work);
        }
    }

    /// Where in the unit square a sample lies before the filter spreads it, and where on the lens.
    fn place(&self, sample: u32, sampler: &Sampler) -> (DVec2, DVec2) {
        if self.random {
            let [x, y, u, v] = sampler.four(Use::Camera);
            return (DVec2::new(x, y), DVec2::new(u, v));
        }
        self.grid(sample)
    }

    /// [`Pixels::place`] on the regular grid.
    fn grid(&self, sample: u32) -> (DVec2, DVec2) {
        let n = self.settings.quality.antialias;
        let cell = DVec2::new(f64::from(sample % n), f64::from(sample / n));
        ((cell + DVec2::splat(0.5)) / f64::from(n), DVec2::ZERO)
    }

    /// [`Pixels::trace`] of up to eight pixels, whose layers are one after the other in `sums`.
    pub fn trace_together(&self, pixels: &[(u32, u32)], sums: &mut [DVec3], eight: &mut Sums) {
        let quality = &self.settings.quality;
        let samples = quality.antialias * quality.antialias;
        let limit = quality.clamp.map(f64::from);
        let layers = eight.layers.len();
        let last = pixels.last().copied().unwrap_or_default();
        let mut together = together::Pixels {
            size: self.settings.size,
            // Lanes without a pixel repeat the last one.
            pixels: std::array::from_fn(|lane| pixels.get(lane).copied().unwrap_or(last)),
            inside: DVec2::ZERO,
            wanted: 0xff >> (8 - pixels.len().min(8)),
        };
        for sample in 0..samples {
            together.inside = self.inside(self.grid(sample).0);
            together::follow(&self.tracer, &together, eight);
            for (index, layer) in eight.layers.iter_mut().enumerate() {
                let [r, g, b] = std::mem::replace(layer, [[0.0; 8]; 3]);
                for lane in 0..pixels.len() {
                    let sample = DVec3::new(r[lane], g[lane], b[lane]);
                    add(&mut sums[lane * layers + index], sample, limit, &mut eight.counts.dropped);
                }
            }
        }
        if samples > 1 {
            sums.iter_mut().for_each(|sum| *sum /= f64::from(samples));
        }
    }

    /// Where in its pixel a sample lies that is at this place of the unit square.
    fn inside(&self, place: DVec2) -> DVec2 {
        let filter = &self.settings.filter;
        DVec2::new(filter.offset(place.x), filter.offset(place.y)) + DVec2::splat(0.5)
    }

    fn ray(&self, (x, y): (u32, u32), inside: DVec2, lens: DVec2) -> (Ray, Beam) {
        let (width, height) = (f64::from(self.settings.size.0), f64::from(self.settings.size.1));
        let at = DVec2::new(f64::from(x), f64::from(y)) + self.inside(inside);
        // Square pixels: both axes in units of half the picture's height, from its centre.
        let screen = DVec2::new(2.0 * at.x - width, height - 2.0 * at.y) / height;
        let camera = self.tracer.scene.camera;
        let ray = camera.ray(screen, lens);
        (ray, camera.beam(&ray, 2.0 / height))
    }

    fn sample(&self, pixel: (u32, u32), inside: DVec2, lens: DVec2, sampler: Sampler, work: &mut Work) {
        let (ray, beam) = self.ray(pixel, inside, lens);
        work.counts.rays.camera += 1;
        if let Some(first) = self.guides {
            guides::record(&self.tracer, (&ray, &beam), first, work);
        }
        let dice = Dice { sampler, surface: 0 };
        match &self.paths {
            None => whitted::follow(&self.tracer, (ray, beam), dice, work),
            Some(paths) => paths.follow(&self.tracer, (ray, beam), dice, work),
        }
    }

    /// Adds the sample in hand to the sums, but for what is no light.
    fn take(&self, sums: &mut [DVec3], work: &mut Work) {
        let limit = self.settings.quality.clamp.map(f64::from);
        let (lights, extras) = sums.split_at_mut(self.lights);
        let (sampled_lights, sampled_extras) = work.layers.split_at_mut(self.lights);
        for (sum, sample) in extras.iter_mut().zip(sampled_extras) {
            *sum += std::mem::take(sample);
        }
        for (sum, sample) in lights.iter_mut().zip(sampled_lights) {
            add(sum, std::mem::take(sample), limit, &mut work.counts.dropped);
        }
    }
}

/// Adds a sample of a layer to a sum. What is no light is left out and counted: one such number would spoil the pixel.
/// Among the samples that are averaged it counts as black.
fn add(sum: &mut DVec3, sample: DVec3, limit: Option<f64>, dropped: &mut Dropped) {
    if sample.is_finite() && sample.min_element() >= 0.0 {
        *sum += limit.map_or(sample, |limit| sample.min(DVec3::splat(limit)));
    } else {
        count(sample, dropped);
    }
}

fn count(sample: DVec3, dropped: &mut Dropped) {
    if sample.is_nan() {
        dropped.undefined += 1;
    } else if !sample.is_finite() {
        dropped.infinite += 1;
    } else {
        dropped.negative += 1;
    }
}

/// Whether anything in the scene has to be sampled even where rays branch.
fn calls_for_samples(scene: &Scene, tracer: &Tracer) -> bool {
    let rough = || {
        let mut materials = scene.geometry.primitives.iter().flat_map(Primitive::materials);
        materials.any(|index| scene.shading.materials[index as usize].is_rough())
    };
    let area = || tracer.lights.iter().any(|(_, light)| light.source.is_sampled());
    scene.camera.lens.is_some() || area() || rough()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    /// Samples that are no light, one in a thousand of each kind: counted by their cause, and no pixel is spoilt. Tested
    /// after averaging, one NaN takes the whole pixel with it.
    #[test]
    fn sa_08_what_is_no_light_is_dropped_and_counted() {
        const SAMPLES: u32 = 1_000_000;
        let bad = [f64::NAN, f64::INFINITY, -1.0, 1e30];
        for limit in [None, Some(10.0)] {
            let (mut random, mut sum, mut dropped) = (Random(8), DVec3::ZERO, Dropped::default());
            let mut injected = [0u64; 4];
            for k in 0..SAMPLES {
                let kind = (1000.0 * random.unit()) as usize;
                let mut sample = DVec3::splat(0.5);
                if kind < 4 {
                    injected[kind] += 1;
                    // In any of the channels.
                    sample[k as usize % 3] = bad[kind];
                }
                add(&mut sum, sample, limit, &mut dropped);
            }
            let [undefined, infinite, negative, bright] = injected;
            assert!(injected.iter().all(|count| *count > 800));
            assert_eq!(dropped, Dropped { undefined, infinite, negative });
            assert!(sum.is_finite());
            let kept = f64::from(SAMPLES) - (undefined + infinite + negative) as f64;
            let expected = 3.0 * 0.5 * kept + bright as f64 * (limit.unwrap_or(bad[3]) - 0.5);
            assert!((sum.element_sum() / expected - 1.0).abs() < 1e-9, "{sum} with {limit:?}");
        }
        let mut dropped = Dropped::default();
        for sample in [
            DVec3::new(f64::NAN, f64::INFINITY, -1.0),
            DVec3::new(0.0, f64::NEG_INFINITY, 0.0),
            DVec3::new(0.0, -0.0, -1e-300),
        ] {
            add(&mut DVec3::ZERO.clone(), sample, None, &mut dropped);
        }
        assert_eq!(dropped, Dropped { undefined: 1, infinite: 1, negative: 1 });
    }
}
