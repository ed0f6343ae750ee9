//! Scene → Film: rays in parallel, sums in one fixed order.

mod accumulate;
mod adaptive;
mod aov;
mod bsdf;
mod coincident;
mod context;
mod emitter;
mod escape;
mod generate;
mod interaction;
mod interface;
mod intersect;
mod light;
mod materials;
mod medium;
mod path;
mod pixels;
mod probe;
#[cfg(test)]
mod random_scene;
#[cfg(test)]
mod round_tests;
mod segment;
mod shade;
mod shadow;
mod shadow_stream;
pub mod spawn;
mod stream;
mod sums;
#[cfg(test)]
mod tests;
mod textures;
mod transmit;
mod wavefront;
mod whitted;

pub use adaptive::{LEAST_SAMPLES, Rounds, Weightings, bytes_of_pixel};
pub use context::is_random;
pub use probe::{BlockError, Probe};

use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::base::stats::{Counts, Meter};
use crate::film::filter::FilterSampler;
use crate::film::{Extras, Film};
use crate::scene::Scene;
use crate::scene::top_level::Bvh;
use crate::sequence::quality::Quality;
use pixels::Pixels;
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

/// Side of the square tiles that a thread finishes at a time.
const TILE: u32 = 16;

/// Columns and rows of pixels whose rays are traced together.
const BLOCK: (u32, u32) = (4, 2);

/// Traces one frame: the layers that are not dark. The film and the counts are the same for any number of threads.
pub fn trace(scene: &Scene, bvh: &Bvh, settings: &TraceSettings, meter: &Meter) -> (Film, Counts) {
    trace_shown(scene, bvh, settings, &[scene.weights.0.clone()].into(), meter)
}

/// The same of a film that is shown with any of these weights: where an error is asked for, it holds for each of them.
pub fn trace_shown(
    scene: &Scene,
    bvh: &Bvh,
    settings: &TraceSettings,
    shown: &Weightings,
    meter: &Meter,
) -> (Film, Counts) {
    let (width, height) = settings.size;
    let mut film = Film::with_extras(width, height, scene.weights.0.clone(), settings.extras);
    let pixels = Pixels::new(scene, bvh, settings, Moment::ONLY);
    if let Some(target) = settings.quality.noise.filter(|_| pixels.random) {
        return adaptive::trace(scene, bvh, settings, (target, shown), meter);
    }
    let store = |layer: &mut Rgb, sum: DVec3| *layer = sum.as_vec3();
    let counts = in_tiles(&pixels, film.data_mut(), meter, store);
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
    in_tiles(&pixels, sums, meter, |layer, sum| *layer += sum)
}

/// Traces all pixels into `data`, by `store`.
fn in_tiles<T: Send>(
    pixels: &Pixels,
    data: &mut [T],
    meter: &Meter,
    store: impl Fn(&mut T, DVec3) + Sync,
) -> Counts {
    let (width, height) = pixels.context.settings.size;
    let tiles = height.div_ceil(TILE) * width.div_ceil(TILE);
    let (done, moment, held) = (AtomicU32::new(0), pixels.moment, pixels.held());
    let bands = data.par_chunks_mut((width * TILE) as usize * held.len()).enumerate();
    let counts = bands.map(|(band, data)| {
        let top = band as u32 * TILE;
        let rows = top..height.min(top + TILE);
        let lefts = (0..width.div_ceil(TILE)).into_par_iter().map(|column| column * TILE);
        let traced = lefts.map(|left| {
            let tile = Tile { columns: left..width.min(left + TILE), rows: rows.clone() };
            let (places, mut sums) = (tile.pixels(), Vec::new());
            sums.resize(places.len() * pixels.layers(), DVec3::ZERO);
            let counts = pixels.trace(&places, &mut sums);
            meter.rays.fetch_add(counts.rays.total(), Relaxed);
            let done = u64::from(done.fetch_add(1, Relaxed) + 1);
            let share = (u64::from(moment.index) * u64::from(tiles) + done) * 1000;
            meter.thousandths.store((share / (u64::from(tiles) * u64::from(moment.of))) as u32, Relaxed);
            (places, sums, counts)
        });
        let mut all = Counts::default();
        for (places, sums, counts) in traced.collect::<Vec<_>>() {
            for (&(x, y), sums) in places.iter().zip(sums.chunks_exact(pixels.layers())) {
                let at = ((y - top) * width + x) as usize * held.len();
                for (layer, &index) in data[at..].iter_mut().zip(&held) {
                    store(layer, sums[index]);
                }
            }
            all += counts;
        }
        all
    });
    counts.reduce(Counts::default, |mut a, b| {
        a += b;
        a
    })
}

/// A part of the picture.
struct Tile {
    columns: Range<u32>,
    rows: Range<u32>,
}

impl Tile {
    /// Its pixels, block by block.
    fn pixels(&self) -> Vec<(u32, u32)> {
        let mut pixels = Vec::with_capacity(self.columns.len() * self.rows.len());
        for top in self.rows.clone().step_by(BLOCK.1 as usize) {
            for left in self.columns.clone().step_by(BLOCK.0 as usize) {
                for y in top..self.rows.end.min(top + BLOCK.1) {
                    pixels.extend((left..self.columns.end.min(left + BLOCK.0)).map(|x| (x, y)));
                }
            }
        }
        pixels
    }
}
