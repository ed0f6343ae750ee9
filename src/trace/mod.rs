//! Scene → Film: traces pixels in parallel and sums their samples in a fixed order.
//!
//! In: a packed scene at a moment, its tree, settings.
//! Out: films of linear radiance per pixel and layer, counts, and error estimates.
//! May use: `scene`, `sequence::quality`, and the rooms above `sequence`.

mod accumulate;
mod adaptive;
mod aov;
mod bsdf;
mod coincident;
mod context;
mod emitter;
mod escape;
mod camera_rays;
mod columns;
mod interaction;
mod interface;
mod intersect;
mod light;
mod marks;
mod materials;
mod medium;
mod path;
mod path_queue;
mod path_reuse;
mod pixels;
mod pilot;
mod primary_hits;
mod progressive;
#[cfg(test)]
mod random_scene;
#[cfg(test)]
mod round_tests;
mod scratch_pool;
mod segment;
mod settings;
mod shade;
mod shade_queue;
mod shadow;
mod shadow_stream;
pub mod spawn;
mod stream;
mod sums;
#[cfg(test)]
mod tests;
mod textures;
mod transmittance;
mod view_reuse;
mod wavefront;
mod whitted;

pub use adaptive::{AdaptiveFrame, MIN_SAMPLES, Weightings, allocation, bytes_of_pixel};
pub use context::is_random;
pub use path_reuse::{
    BYTES_PER_POSE, FramePose, MAX_FRAMES, PathObstacle, SharedFrames, sharing_pays, sharing_would_pay,
};
pub use pilot::{BlockError, PilotBlocks};
pub use primary_hits::PrimaryHits;
pub use progressive::{ProgressiveFilm, Refinement, StageEnd, rays_of_pixel, rays_per_sample};
pub use settings::{Moment, TraceSettings};
pub use view_reuse::{MAX_VIEWS, SamplePlan, SharedViews, View, bytes_of_sums, trace_views};

use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::base::stats::{Counts, ProgressMeter};
use crate::film::Film;
use crate::scene::Scene;
use crate::scene::top_level::Bvh;
use pixels::PixelTracer;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};
use tracing::trace_span;

/// The side of the square tiles, in pixels. A thread films one tile at a time.
const TILE: u32 = 16;

/// The maximum number of tiles, or of other parts of a picture, in a Rayon job. By default, Rayon splits a list into a few
/// jobs per thread, and an idle thread takes whole jobs only. So one thread could trace several difficult tiles at the end
/// while the others wait.
const ONE_EACH: usize = 1;

/// Columns and rows of the pixel blocks whose rays are traced together.
const BLOCK: (u32, u32) = (4, 2);

/// Traces one frame, in all layers that are not dark. The film and the counts are the same for any number of threads.
#[warn(missing_docs)]
pub fn trace(scene: &Scene, bvh: &Bvh, settings: &TraceSettings, meter: &ProgressMeter) -> (Film, Counts) {
    trace_weighted(scene, bvh, settings, &[scene.weights.0.clone()].into(), meter)
}

/// Traces a film that is displayed with each of the weightings `shown`. A noise target holds for each of them.
pub fn trace_weighted(
    scene: &Scene,
    bvh: &Bvh,
    settings: &TraceSettings,
    shown: &Weightings,
    meter: &ProgressMeter,
) -> (Film, Counts) {
    let (width, height) = settings.size;
    let mut film = Film::with_aovs(width, height, scene.weights.0.clone(), settings.aovs);
    let pixels = PixelTracer::new(scene, bvh, settings, Moment::ONLY);
    if let Some(target) = settings.quality.noise.filter(|_| pixels.random) {
        return adaptive::trace(scene, bvh, settings, (target, shown), meter);
    }
    let store = |layer: &mut Rgb, sum: DVec3| *layer = sum.as_vec3();
    let counts = in_tiles(&pixels, film.data_mut(), meter, store);
    (film, counts)
}

/// Adds the samples of one moment of the shutter to `sums`, which become a film once all moments are added. `sums` has
/// the layers of every pixel that a [`Film`] has.
pub fn trace_moment(
    scene: &Scene,
    bvh: &Bvh,
    settings: &TraceSettings,
    moment: Moment,
    sums: &mut [DVec3],
    meter: &ProgressMeter,
) -> Counts {
    let pixels = PixelTracer::new(scene, bvh, settings, moment);
    in_tiles(&pixels, sums, meter, |layer, sum| *layer += sum)
}

/// Traces all pixels. `store` writes each sum into `data`.
fn in_tiles<T: Send>(
    pixels: &PixelTracer,
    data: &mut [T],
    meter: &ProgressMeter,
    store: impl Fn(&mut T, DVec3) + Sync,
) -> Counts {
    let (width, height) = pixels.context.settings.size;
    let tiles = height.div_ceil(TILE) * width.div_ceil(TILE);
    let (done, moment, held) = (AtomicU32::new(0), pixels.moment, pixels.held());
    let bands = data.par_chunks_mut((width * TILE) as usize * held.len()).enumerate();
    let bands = bands.with_max_len(ONE_EACH);
    let counts = bands.map(|(band, data)| {
        let top = band as u32 * TILE;
        let rows = top..height.min(top + TILE);
        let lefts = (0..width.div_ceil(TILE)).into_par_iter().with_max_len(ONE_EACH);
        let lefts = lefts.map(|column| column * TILE);
        let traced = lefts.map(|left| {
            let _span = trace_span!("tile", x = left, y = top).entered();
            let tile = Tile { columns: left..width.min(left + TILE), rows: rows.clone() };
            let (places, mut sums) = (tile.pixels(), Vec::new());
            sums.resize(places.len() * pixels.layers(), DVec3::ZERO);
            let counts = pixels.trace(&places, &mut sums);
            meter.rays.fetch_add(counts.rays.total(), Relaxed);
            let done = u64::from(done.fetch_add(1, Relaxed) + 1);
            let done = u64::from(moment.index) * u64::from(tiles) + done;
            meter.show(done, u64::from(tiles) * u64::from(moment.of));
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

/// A rectangle of pixels.
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
