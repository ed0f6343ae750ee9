//! A pixel: its samples, and their mean.

use super::path::{Path, Paths};
use super::together::Sums;
use super::tracer::{Dice, Tracer, Work};
use super::wave::WAVE;
use super::{Moment, TraceSettings, guides, together, whitted};
use crate::bvh::Bvh;
use crate::camera::{Beam, Ray};
use crate::counters::{Counts, Dropped};
use crate::film::{Extras, LayerId, lit};
use crate::math::{DVec2, DVec3};
use crate::quality::Integrator;
use crate::sampling::{PixelSampler, Sampler, Use};
use crate::scene::{Primitive, Scene};
use crate::shape::Rays;
use crate::simd::{self, Lanes, Octo, dispatch};
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
        let random = moment.of > 1 || is_random(scene, quality.integrator);
        let guides = settings.extras.guides_layer(lights);
        // Eight at a time only light is recorded.
        let together = !random && settings.extras == Extras::default() && together::suits(&tracer);
        Self { settings, moment, tracer, paths, random, lights, guides, together, at_once: WAVE }
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
            (false, Some(_)) => Tracing::Paths(Work::new(WAVE, layers), Followed::default()),
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

    /// Many paths at once, of one pixel or several.
    fn trace_paths(
        &self,
        pixels: &[(u32, u32)],
        drawn: &Drawn,
        sums: &mut [DVec3],
        work: &mut Work,
        followed: &mut Followed,
    ) {
        let Some(integrator) = &self.paths else { return };
        let layers = work.layers.len() / WAVE;
        let samples = pixels.iter().enumerate();
        let samples = samples.flat_map(|(index, &pixel)| {
            self.samples(pixel, drawn).map(move |(_, sampler)| Wanted { index, pixel, sampler })
        });
        let mut samples = samples.peekable();
        let mut eight = Vec::with_capacity(8);
        while samples.peek().is_some() {
            while followed.pixels.len() < self.at_once && samples.peek().is_some() {
                eight.clear();
                eight.extend(samples.by_ref().take(self.at_once.min(8)));
                let rays = dispatch(Eyes { of: self, wanted: &eight });
                for (lane, Wanted { index, sampler, .. }) in eight.iter().enumerate() {
                    let place = followed.pixels.len();
                    work.first = place * layers;
                    let eye = self.seen_along(rays.one(lane), work);
                    followed.paths.push(Path::new(&self.tracer, eye, *sampler, work.first));
                    followed.pixels.push(*index);
                }
            }
            integrator.follow(&self.tracer, &mut followed.paths, work);
            self.take_all(sums, work, followed);
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

    /// Where in its pixel a sample lies that is at this place of the unit square.
    fn inside(&self, place: DVec2) -> DVec2 {
        let filter = &self.settings.filter;
        DVec2::new(filter.offset(place.x), filter.offset(place.y)) + DVec2::splat(0.5)
    }

    /// The ray from the eye along which a sample is seen.
    fn eye(&self, (x, y): (u32, u32), sample: u32, sampler: &Sampler, work: &mut Work) -> (Ray, Beam) {
        let (inside, lens) = self.place(sample, sampler);
        let (width, height) = (f64::from(self.settings.size.0), f64::from(self.settings.size.1));
        let at = DVec2::new(f64::from(x), f64::from(y)) + self.inside(inside);
        // Square pixels: both axes in units of half the picture's height, from its centre.
        let screen = DVec2::new(2.0 * at.x - width, height - 2.0 * at.y) / height;
        self.seen_along(self.tracer.scene.camera.ray(screen, lens), work)
    }

    /// A ray from the eye with its beam. What else than light is recorded is added to `work`.
    fn seen_along(&self, ray: Ray, work: &mut Work) -> (Ray, Beam) {
        let beam = self.tracer.scene.camera.beam(&ray, 2.0 / f64::from(self.settings.size.1));
        work.counts.rays.camera += 1;
        work.counts.evaluations.lens_samples += u64::from(self.tracer.scene.camera.lens.is_some());
        if let Some(first) = self.guides {
            guides::record(&self.tracer, (&ray, &beam), first, work);
        }
        (ray, beam)
    }

    /// Adds the samples of paths that have been followed to their pixels' sums.
    fn take_all(&self, sums: &mut [DVec3], work: &mut Work, followed: &mut Followed) {
        let layers = work.layers.len() / WAVE;
        for (index, samples) in followed.pixels.drain(..).zip(work.layers.chunks_exact_mut(layers)) {
            self.take(&mut sums[index * layers..][..layers], samples, &mut work.counts.dropped);
        }
        followed.paths.clear();
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

/// A sample that is wanted of one of several pixels.
struct Wanted {
    index: usize,
    pixel: (u32, u32),
    sampler: Sampler,
}

/// The rays from the eye of up to eight samples drawn at random.
struct Eyes<'a, 'b> {
    of: &'a Pixels<'b>,
    wanted: &'a [Wanted],
}

impl simd::Work for Eyes<'_, '_> {
    type Output = Rays;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Rays {
        let Self { of: Pixels { settings, tracer, .. }, wanted } = self;
        let last = wanted.len() - 1;
        let mut samplers = [wanted[last].sampler; 8];
        for (sampler, wanted) in samplers.iter_mut().zip(wanted) {
            *sampler = wanted.sampler;
        }
        let [mut x, mut y, u, v] = Sampler::four_together(&samplers, Use::Camera);
        for lane in 0..8 {
            let (left, top) = wanted[lane.min(last)].pixel;
            x[lane] = f64::from(left) + (settings.filter.offset(x[lane]) + 0.5);
            y[lane] = f64::from(top) + (settings.filter.offset(y[lane]) + 0.5);
        }
        let at = [Octo::load(&x), Octo::load(&y)];
        together::camera::rays::<L::Quad>(tracer.scene.camera, settings.size, at, &[u, v])
    }
}

/// Paths on their way, and the places of their pixels among those that are traced.
#[derive(Default)]
pub struct Followed {
    paths: Vec<Path>,
    pixels: Vec<usize>,
}

impl Tracing {
    pub fn counts(self) -> Counts {
        match self {
            Self::Together(eight) => eight.counts,
            Self::Rays(work) | Self::Paths(work, _) => work.counts,
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
