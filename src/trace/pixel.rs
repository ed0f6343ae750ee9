//! A pixel: its samples, and their mean.

mod eye;
mod sums;
mod waves;

use super::path::Paths;
use super::together::Sums;
use super::tracer::{Dice, Tracer, Work};
use super::wave::at_once;
use super::{Moment, TraceSettings, together, whitted};
use crate::bvh::Bvh;
use crate::counters::{Counts, Dropped};
use crate::film::{Extras, LayerId, lit};
use crate::math::{DVec2, DVec3};
use crate::quality::Integrator;
use crate::sampling::{PixelSampler, Sampler};
use crate::scene::{Primitive, Scene};
use std::ops::Range;
use sums::add;
use waves::Followed;

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
    /// Paths that are followed at once, at most.
    at_once: usize,
}

/// Some of a pixel's samples. Another seed gives independent ones.
#[derive(Clone, Debug)]
pub struct Drawn {
    pub samples: Range<u32>,
    pub seed: u32,
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
        let at_once = at_once(lights + settings.extras.layers());
        let random = moment.of > 1 || is_random(scene, quality.integrator);
        let guides = settings.extras.guides_layer(lights);
        // Eight at a time only light is recorded.
        let together = !random && settings.extras == Extras::default() && together::suits(&tracer);
        Self { settings, moment, tracer, paths, random, lights, guides, together, at_once }
    }

    /// The same with samples drawn at random, whatever the scene calls for.
    pub fn sampled(scene: &'a Scene<'a>, bvh: &'a Bvh, settings: &'a TraceSettings, moment: Moment) -> Self {
        Self { random: true, together: false, ..Self::new(scene, bvh, settings, moment) }
    }

    /// Follows every path by itself.
    #[cfg(test)]
    pub fn one_by_one(&mut self) {
        self.at_once = 1;
        self.paths.iter_mut().for_each(Paths::one_by_one);
    }

    /// How many layers are traced, dark ones among them.
    pub fn layers(&self) -> usize {
        self.lights + self.settings.extras.layers()
    }

    /// Those of them that a film holds.
    pub fn held(&self) -> Vec<usize> {
        let lit = lit(&self.tracer.scene.weights.0).map(LayerId::index);
        lit.chain(self.lights..self.layers()).collect()
    }

    /// What a thread needs to trace pixels.
    pub fn start(&self) -> Tracing {
        let layers = self.layers();
        match (self.together, &self.paths) {
            (true, _) => Tracing::Together(Sums::new(layers)),
            (false, Some(_)) => Tracing::Paths(Work::new(self.at_once, layers), Followed::default()),
            (false, None) => Tracing::Rays(Work::new(1, layers)),
        }
    }

    /// Adds pixels' layers, one pixel after the other, to `sums`: the means of their samples or, of several moments, this
    /// moment's part of them. Neighbours should follow each other.
    pub fn trace(&self, pixels: &[(u32, u32)], sums: &mut [DVec3], tracing: &mut Tracing) {
        if let Tracing::Together(eight) = tracing {
            let layers = eight.layers.len();
            for (pixels, sums) in pixels.chunks(8).zip(sums.chunks_mut(8 * layers)) {
                self.trace_together(pixels, sums, eight);
            }
            return;
        }
        self.add(pixels, &self.all(), sums, tracing);
        let samples = f64::from(self.count());
        sums.iter_mut().for_each(|sum| *sum /= samples);
    }

    /// Adds some of the pixels' samples to `sums` or, of several moments, those that fall on this one.
    pub fn add(&self, pixels: &[(u32, u32)], drawn: &Drawn, sums: &mut [DVec3], tracing: &mut Tracing) {
        match tracing {
            // Without chance there is no part of the samples.
            Tracing::Together(_) => {}
            Tracing::Paths(work, paths) => self.trace_paths(pixels, drawn, sums, work, paths),
            Tracing::Rays(work) => {
                let layers = work.layers.len();
                for (&pixel, sums) in pixels.iter().zip(sums.chunks_exact_mut(layers)) {
                    for (sample, sampler) in self.samples(pixel, drawn) {
                        let eye = self.eye(pixel, sample, &sampler, work);
                        whitted::follow(&self.tracer, eye, Dice { sampler, surface: 0 }, work);
                        self.take(sums, &mut work.layers, &mut work.counts.dropped);
                    }
                }
            }
        }
    }

    /// All samples of the quality.
    fn all(&self) -> Drawn {
        Drawn { samples: 0..self.count(), seed: self.settings.quality.seed }
    }

    /// How many samples a pixel has.
    fn count(&self) -> u32 {
        let quality = &self.settings.quality;
        if self.random { quality.samples } else { quality.antialias * quality.antialias }
    }

    /// The pixel's samples at this moment, by their numbers.
    fn samples(&self, pixel: (u32, u32), drawn: &Drawn) -> impl Iterator<Item = (u32, Sampler)> + use<> {
        let numbers = PixelSampler::new(pixel, drawn.seed).with(self.settings.quality.points);
        let Moment { index, of } = self.moment;
        let now = move |sample: &u32| of == 1 || numbers.part_of_time(*sample, of) == index;
        drawn.samples.clone().filter(now).map(move |sample| (sample, numbers.sample(sample)))
    }

    /// [`Pixels::trace`] of up to eight pixels.
    fn trace_together(&self, pixels: &[(u32, u32)], sums: &mut [DVec3], eight: &mut Sums) {
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

    /// Adds a sample's layers to a pixel's sums, but for what is no light, and leaves nothing of them.
    fn take(&self, sums: &mut [DVec3], sample: &mut [DVec3], dropped: &mut Dropped) {
        let limit = self.settings.quality.clamp.map(f64::from);
        let (lights, extras) = sums.split_at_mut(self.lights);
        let (sampled_lights, sampled_extras) = sample.split_at_mut(self.lights);
        for (sum, sample) in extras.iter_mut().zip(sampled_extras) {
            *sum += std::mem::take(sample);
        }
        for (sum, sample) in lights.iter_mut().zip(sampled_lights) {
            add(sum, std::mem::take(sample), limit, dropped);
        }
    }
}

/// What a thread traces pixels with.
pub enum Tracing {
    Together(Sums),
    Rays(Work),
    Paths(Work, Followed),
}

impl Tracing {
    pub fn counts(self) -> Counts {
        match self {
            Self::Together(eight) => eight.counts,
            Self::Rays(work) | Self::Paths(work, _) => work.counts,
        }
    }
}

/// Whether samples of one moment of the scene are drawn at random: along paths, and where a lens, a light with an area
/// or a rough surface has to be sampled.
pub fn is_random(scene: &Scene, integrator: Integrator) -> bool {
    let rough = || {
        let mut materials = scene.geometry.primitives.iter().flat_map(Primitive::materials);
        materials.any(|index| scene.shading.materials[index as usize].is_rough())
    };
    let area = || scene.lights().any(|(_, light)| light.source.is_sampled());
    integrator.looks_for_lights() || scene.camera.lens.is_some() || area() || rough()
}
