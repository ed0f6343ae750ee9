//! Scene → Film: rays in parallel, sums in one fixed order.

mod shade;
mod spawn;
#[cfg(test)]
mod round_tests;
#[cfg(test)]
mod tests;
mod whitted;

use crate::bvh::Bvh;
use crate::color::Rgb;
use crate::counters::{Meter, RayCounts};
use crate::film::Film;
use crate::math::{DVec2, DVec3};
use crate::scene::Scene;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};
use whitted::Whitted;

/// What tracing needs to know besides the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TraceSettings {
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Samples per pixel along each axis of a regular grid.
    pub antialias: u32,
    /// Longest chain of mirror reflections.
    pub bounces: u32,
}

/// Side of the square tiles that a thread finishes one after the other: rays of neighbours meet the same
/// nodes and primitives.
const TILE: u32 = 8;

/// Traces one frame. The film and the counts are the same for any number of threads.
pub fn trace(scene: &Scene, bvh: &Bvh, settings: &TraceSettings, meter: &Meter) -> (Film, RayCounts) {
    let (width, height) = settings.size;
    let mut film = Film::new(width, height, scene.weights.0.clone());
    let layers = film.layers();
    let band_len = (width * TILE) as usize * layers;
    let bands = height.div_ceil(TILE);
    let done = AtomicU32::new(0);
    let integrator = Whitted::new(scene, bvh, settings.bounces);
    let counts = film.data.par_chunks_mut(band_len).enumerate().map(|(band, data)| {
        let top = band as u32 * TILE;
        let frame = Window { settings, rows: top..height.min(top + TILE) };
        let counts = frame.trace(&integrator, layers, data);
        meter.rays.fetch_add(counts.total(), Relaxed);
        let done = done.fetch_add(1, Relaxed) + 1;
        meter.thousandths.store((u64::from(done) * 1000 / u64::from(bands)) as u32, Relaxed);
        counts
    });
    let counts = counts.reduce(RayCounts::default, |mut a, b| {
        a += b;
        a
    });
    (film, counts)
}

/// A band of the picture's rows.
struct Window<'a> {
    settings: &'a TraceSettings,
    rows: Range<u32>,
}

impl Window<'_> {
    /// Fills the band's pixels, tile by tile. `data` is the film's part for the band.
    fn trace(&self, integrator: &Whitted, layers: usize, data: &mut [Rgb]) -> RayCounts {
        let width = self.settings.size.0;
        let mut counts = RayCounts::default();
        let mut sums = vec![DVec3::ZERO; layers];
        for left in (0..width).step_by(TILE as usize) {
            for y in self.rows.clone() {
                for x in left..width.min(left + TILE) {
                    let at = ((y - self.rows.start) * width + x) as usize * layers;
                    self.pixel(integrator, (x, y), &mut sums, &mut counts);
                    for (layer, sum) in data[at..at + layers].iter_mut().zip(&mut sums) {
                        *layer = std::mem::take(sum).as_vec3();
                    }
                }
            }
        }
        counts
    }

    /// Adds the mean of a pixel's samples to `sums`, one per layer.
    fn pixel(&self, integrator: &Whitted, (x, y): (u32, u32), sums: &mut [DVec3], counts: &mut RayCounts) {
        let n = self.settings.antialias;
        let (width, height) = (f64::from(self.settings.size.0), f64::from(self.settings.size.1));
        for sample in 0..n * n {
            let inside = DVec2::new(f64::from(sample % n), f64::from(sample / n)) + DVec2::splat(0.5);
            let at = DVec2::new(f64::from(x), f64::from(y)) + inside / f64::from(n);
            // Square pixels: both axes in units of half the picture's height, from its centre.
            let screen = DVec2::new(2.0 * at.x - width, height - 2.0 * at.y) / height;
            integrator.sample(screen, sums, counts);
        }
        let samples = f64::from(n * n);
        for sum in sums {
            *sum /= samples;
        }
    }
}
