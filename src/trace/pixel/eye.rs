//! Rays from the eye: where in a pixel and on the lens a sample lies, and what is seen along it.

use super::Pixels;
use crate::camera::{Beam, Ray};
use crate::math::DVec2;
use crate::sampling::{Sampler, Use};
use crate::shape::Rays;
use crate::simd::{self, Lanes, Octo};
use crate::trace::tracer::Work;
use crate::trace::{guides, together};

impl Pixels<'_> {
    /// Where in the unit square a sample lies before the filter spreads it, and where on the lens.
    pub(super) fn place(&self, sample: u32, sampler: &Sampler) -> (DVec2, DVec2) {
        if self.random {
            let [x, y, u, v] = sampler.four(Use::Camera);
            return (DVec2::new(x, y), DVec2::new(u, v));
        }
        self.grid(sample)
    }

    /// [`Pixels::place`] on the regular grid.
    pub(super) fn grid(&self, sample: u32) -> (DVec2, DVec2) {
        let n = self.settings.quality.antialias;
        let cell = DVec2::new(f64::from(sample % n), f64::from(sample / n));
        ((cell + DVec2::splat(0.5)) / f64::from(n), DVec2::ZERO)
    }

    /// Where in its pixel a sample lies that is at this place of the unit square.
    pub(super) fn inside(&self, place: DVec2) -> DVec2 {
        let filter = &self.settings.filter;
        DVec2::new(filter.offset(place.x), filter.offset(place.y)) + DVec2::splat(0.5)
    }

    /// The ray from the eye along which a sample is seen.
    pub(super) fn eye(
        &self,
        (x, y): (u32, u32),
        sample: u32,
        sampler: &Sampler,
        work: &mut Work,
    ) -> (Ray, Beam) {
        let (inside, lens) = self.place(sample, sampler);
        let (width, height) = (f64::from(self.settings.size.0), f64::from(self.settings.size.1));
        let at = DVec2::new(f64::from(x), f64::from(y)) + self.inside(inside);
        // Square pixels: both axes in units of half the picture's height, from its centre.
        let screen = DVec2::new(2.0 * at.x - width, height - 2.0 * at.y) / height;
        let ray = self.tracer.scene.camera.ray(screen, lens);
        (ray, self.seen_along(&ray, work))
    }

    /// The beam of a ray from the eye. What else than light is recorded is added to `work`.
    #[inline(always)]
    pub(super) fn seen_along(&self, ray: &Ray, work: &mut Work) -> Beam {
        let beam = self.tracer.scene.camera.beam(ray, 2.0 / f64::from(self.settings.size.1));
        work.counts.rays.camera += 1;
        work.counts.evaluations.lens_samples += u64::from(self.tracer.scene.camera.lens.is_some());
        if let Some(first) = self.guides {
            guides::record(&self.tracer, (ray, &beam), first, work);
        }
        beam
    }
}

/// A sample that is wanted of one of several pixels.
pub(super) struct Wanted {
    pub index: usize,
    pub pixel: (u32, u32),
    pub sampler: Sampler,
}

/// The rays from the eye of up to eight samples drawn at random.
pub(super) struct Eyes<'a, 'b> {
    pub of: &'a Pixels<'b>,
    pub wanted: &'a [Wanted],
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
