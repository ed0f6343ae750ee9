//! Scene → Film: rays in parallel, sums in one fixed order.

mod adaptive;
mod escape;
mod guides;
mod lights;
mod luminaires;
mod media;
mod one_lobe;
mod passing;
mod path;
mod pixel;
mod place;
mod scatter;
mod shade;
pub mod spawn;
#[cfg(test)]
mod round_tests;
#[cfg(test)]
mod tests;
mod throughput;
mod together;
mod tracer;
mod wave;
mod whitted;
#[cfg(test)]
mod worlds;

use crate::bvh::Bvh;
use crate::color::Rgb;
use crate::counters::{Counts, Meter};
use crate::film::{Extras, Film};
use crate::filter::FilterSampler;
use crate::math::DVec3;
use crate::quality::Quality;
use crate::scene::Scene;
pub use adaptive::{LEAST_SAMPLES, Rounds, SETS};
use pixel::Pixels;
pub use pixel::is_random;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// What tracing needs to know besides the scene.
#[derive(Clone, Debug)]
pub struct TraceSettings {
    /// Width and height in pixels.
    pub size: (u32, u32),
    pub quality: Quality,
    /// Of the quality's filter.
    pub filter: FilterSampler,
    /// What films record besides light.
    pub extras: Extras,
}

/// One of the moments at which motion is looked at while the shutter is open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Moment {
    pub index: u32,
    /// 1 where nothing moves.
    pub of: u32,
}

impl Moment {
    pub const ONLY: Self = Self { index: 0, of: 1 };
}

/// Side of the square tiles that a thread finishes one after the other: rays of neighbours meet the same
/// nodes and primitives.
const TILE: u32 = 8;

/// Columns and rows of pixels whose rays are traced together.
const BLOCK: (u32, u32) = (4, 2);

/// Traces one frame: the layers that are not dark. The film and the counts are the same for any number of threads.
pub fn trace(scene: &Scene, bvh: &Bvh, settings: &TraceSettings, meter: &Meter) -> (Film, Counts) {
    let (width, height) = settings.size;
    let mut film = Film::with_extras(width, height, scene.weights.0.clone(), settings.extras);
    let pixels = Pixels::new(scene, bvh, settings, Moment::ONLY);
    if let Some(target) = settings.quality.noise.filter(|_| pixels.random) {
        return adaptive::trace(scene, bvh, settings, target, meter);
    }
    let store = |layer: &mut Rgb, sum: DVec3| *layer = sum.as_vec3();
    let counts = in_bands(&pixels, film.data_mut(), meter, store);
    (film, counts)
}

/// Adds what is seen at one moment of several to the sums that become a film: those samples of each pixel that
/// fall on the moment. `sums` holds the layers of every pixel that a [`Film`] does.
pub fn trace_moment(
    scene: &Scene,
    bvh: &Bvh,
    settings: &TraceSettings,
    moment: Moment,
    sums: &mut [DVec3],
    meter: &Meter,
) -> Counts {
    let pixels = Pixels::new(scene, bvh, settings, moment);
    in_bands(&pixels, sums, meter, |layer, sum| *layer += sum)
}

/// Traces all pixels into `data`, by `store`.
fn in_bands<T: Send>(
    pixels: &Pixels,
    data: &mut [T],
    meter: &Meter,
    store: impl Fn(&mut T, DVec3) + Sync,
) -> Counts {
    let (width, height) = pixels.settings.size;
    let bands = height.div_ceil(TILE);
    let done = AtomicU32::new(0);
    let moment = pixels.moment;
    let held = pixels.held();
    let counts = data.par_chunks_mut((width * TILE) as usize * held.len()).enumerate().map(|(band, data)| {
        let top = band as u32 * TILE;
        let window = Window { pixels, held: &held, rows: top..height.min(top + TILE) };
        let counts = window.trace(data, &store);
        meter.rays.fetch_add(counts.rays.total(), Relaxed);
        let done = u64::from(done.fetch_add(1, Relaxed) + 1);
        let share = (u64::from(moment.index) * u64::from(bands) + done) * 1000;
        meter.thousandths.store((share / (u64::from(bands) * u64::from(moment.of))) as u32, Relaxed);
        counts
    });
    counts.reduce(Counts::default, |mut a, b| {
        a += b;
        a
    })
}

/// A band of the picture's rows.
struct Window<'a> {
    pixels: &'a Pixels<'a>,
    /// Which of the layers that are traced the picture holds.
    held: &'a [usize],
    rows: Range<u32>,
}

impl Window<'_> {
    /// Traces the band's pixels, tile by tile. `data` is the picture's part for the band.
    fn trace<T>(&self, data: &mut [T], store: impl Fn(&mut T, DVec3)) -> Counts {
        let (width, layers) = (self.pixels.settings.size.0, self.pixels.layers());
        let mut tracing = self.pixels.start();
        let most = TILE as usize * self.rows.len();
        let mut sums = vec![DVec3::ZERO; most * layers];
        let mut tile = Vec::with_capacity(most);
        for left in (0..width).step_by(TILE as usize) {
            self.put_tile(left..width.min(left + TILE), &mut tile);
            self.pixels.trace(&tile, &mut sums[..tile.len() * layers], &mut tracing);
            for (&(x, y), sums) in tile.iter().zip(sums.chunks_exact_mut(layers)) {
                let at = ((y - self.rows.start) * width + x) as usize * self.held.len();
                for (layer, &index) in data[at..].iter_mut().zip(self.held) {
                    store(layer, sums[index]);
                }
                sums.fill(DVec3::ZERO);
            }
        }
        tracing.counts()
    }

    /// The pixels of some columns, block by block.
    fn put_tile(&self, columns: Range<u32>, tile: &mut Vec<(u32, u32)>) {
        tile.clear();
        for top in self.rows.clone().step_by(BLOCK.1 as usize) {
            for left in columns.clone().step_by(BLOCK.0 as usize) {
                for y in top..self.rows.end.min(top + BLOCK.1) {
                    for x in left..columns.end.min(left + BLOCK.0) {
                        tile.push((x, y));
                    }
                }
            }
        }
    }
}
