//! Samples of pixels as paths, of which many are followed at once.

use super::eye::{Eyes, Wanted};
use super::{Drawn, Pixels};
use crate::math::DVec3;
use crate::simd::dispatch;
use crate::trace::path::Path;
use crate::trace::tracer::Work;

/// Paths, those on their way first, and the places of their pixels among those that are traced.
#[derive(Default)]
pub struct Followed {
    paths: Vec<Path>,
    pixels: Vec<usize>,
}

impl Pixels<'_> {
    /// Many paths at once, of one pixel or several.
    pub(super) fn trace_paths(
        &self,
        pixels: &[(u32, u32)],
        drawn: &Drawn,
        sums: &mut [DVec3],
        work: &mut Work,
        followed: &mut Followed,
    ) {
        let Some(integrator) = &self.paths else { return };
        let layers = self.layers();
        let samples = pixels.iter().enumerate();
        let samples = samples.flat_map(|(index, &pixel)| {
            self.samples(pixel, drawn).map(move |(_, sampler)| Wanted { index, pixel, sampler })
        });
        let mut samples = samples.peekable();
        let mut eight = Vec::with_capacity(8);
        while samples.peek().is_some() {
            while followed.pixels.len() < self.at_once && samples.peek().is_some() {
                eight.clear();
                let room = self.at_once - followed.pixels.len();
                eight.extend(samples.by_ref().take(room.min(8)));
                let rays = dispatch(Eyes { of: self, wanted: &eight });
                for (lane, Wanted { index, sampler, .. }) in eight.iter().enumerate() {
                    let place = followed.pixels.len();
                    if place == followed.paths.len() {
                        followed.paths.push(Path::new(rays.one(lane), *sampler));
                    }
                    work.first = place * layers;
                    let path = &mut followed.paths[place];
                    path.begin(&self.tracer, rays.one(lane), *sampler, work.first);
                    path.beam = self.seen_along(&path.ray, work);
                    followed.pixels.push(*index);
                }
            }
            let paths = &mut followed.paths[..followed.pixels.len()];
            integrator.follow(&self.tracer, paths, work);
            self.take_all(sums, work, followed);
        }
    }

    /// Adds the samples of paths that have been followed to their pixels' sums.
    fn take_all(&self, sums: &mut [DVec3], work: &mut Work, followed: &mut Followed) {
        let layers = self.layers();
        for (index, samples) in followed.pixels.drain(..).zip(work.layers.chunks_exact_mut(layers)) {
            self.take(&mut sums[index * layers..][..layers], samples, &mut work.counts.dropped);
        }
    }
}
