//! A tile of several frames.

use super::super::pixels::PixelTracer;
use super::super::{BLOCK, Tile};
use super::FramePose;
use super::gain::{MIN_GAIN, gains, work_alone};
use super::samples::{SharedSamples, StillSums};
use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::base::stats::Counts;
use crate::scene::movers::FrameMask;
use std::collections::HashMap;

/// How much a thread keeps at once, and when pixels are traced together.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Values of samples, one for each layer, unless one sample for each pixel of a block has more.
    pub values: usize,
    /// Sums, one for each pose, pixel and layer, unless a block of pixels has more.
    pub sums: usize,
    /// The gain below which they are not, and the number of frames for which each stands.
    pub gain: f64,
    pub times: f64,
}

impl Limits {
    /// Whether frames that shared the paths so far gained enough.
    pub fn allow(&self, counts: &Counts) -> bool {
        gains(counts, self.times, self.gain)
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self { values: 1 << 16, sums: 1 << 18, gain: MIN_GAIN, times: 1.0 }
    }
}

/// Pixels whose rays are traced together.
const PIXELS: usize = (BLOCK.0 * BLOCK.1) as usize;

/// Pixels in the middle of a tile that show whether sharing pays there.
const TRIED: usize = 2 * PIXELS;

/// A tile whose pixels were traced together for all frames, as far as that pays.
pub struct SharedTile {
    /// The pixels that were traced together.
    pub pixels: Vec<(u32, u32)>,
    /// The layers of these pixels, for each frame.
    pub data: Vec<Vec<Rgb>>,
    /// The other pixels, which are less work frame by frame.
    pub rest: Vec<(u32, u32)>,
    pub counts: Counts,
}

/// The pixels of a tile, block by block, from its middle on: a mover that is seen somewhere in a tile is most often seen in
/// its middle.
pub fn in_order(tile: &Tile) -> Vec<(u32, u32)> {
    let mut pixels = tile.pixels();
    let blocks = pixels.len() / PIXELS;
    // The block in the middle of the middle row.
    let in_row = tile.columns.len().div_ceil(BLOCK.0 as usize);
    let middle = blocks / 2 + in_row / 2;
    if middle < blocks {
        pixels.rotate_left(middle * PIXELS);
    }
    pixels
}

/// Traces tiles of frames that share paths.
pub struct TileTracer<'a> {
    poses: &'a [FramePose<'a>],
    /// Without movers.
    shared: PixelTracer<'a>,
    /// One for each pose.
    whole: Vec<PixelTracer<'a>>,
    /// All frames and their number, and the number of moments of those that have several.
    all: FrameMask,
    frames: usize,
    moments: u32,
    held: Vec<usize>,
    limits: Limits,
}

impl<'a> TileTracer<'a> {
    pub fn new(
        poses: &'a [FramePose<'a>],
        shared: PixelTracer<'a>,
        whole: Vec<PixelTracer<'a>>,
        limits: Limits,
    ) -> Self {
        let all = poses.iter().fold(0, |all, pose| all | 1 << pose.frame);
        let frames = poses.last().map_or(0, |last| last.frame + 1);
        let moments = poses.iter().map(|pose| pose.moment.of).max().unwrap_or(1);
        let held = shared.held();
        Self { poses, shared, whole, all, frames, moments, held, limits }
    }

    /// Traces the pixels of a tile for all frames together, as far as that pays: first a few of them, then the others.
    pub fn share_tile(&self, tile: &Tile) -> SharedTile {
        let (mut pixels, mut counts) = (in_order(tile), Counts::default());
        let mut films: Vec<Vec<DVec3>> = vec![Vec::new(); self.frames];
        let samples = f64::from(self.shared.count());
        let mut done = 0;
        while done < pixels.len() && self.limits.allow(&counts) {
            let at_once = self.pixels_at_once();
            let part = if done == 0 { TRIED.min(at_once) } else { at_once };
            let part = &pixels[done..pixels.len().min(done + part)];
            let first = done * self.shared.layers();
            done += part.len();
            films.iter_mut().for_each(|film| film.resize(done * self.shared.layers(), DVec3::ZERO));
            for (pose, mut sums) in self.poses.iter().zip(self.share(part, &mut counts)) {
                if samples > 1.0 {
                    sums.iter_mut().for_each(|sum| *sum /= samples);
                }
                pose.add(&sums, &mut films[pose.frame][first..]);
            }
        }
        let data = films.iter().map(|film| self.held(film)).collect();
        counts.paths.all += self.frames as u64 * self.paths(done);
        let rest = pixels.split_off(done);
        SharedTile { pixels, data, rest, counts }
    }

    /// Some pixels of one frame, which is traced whole.
    pub fn trace_whole(&self, pixels: &[(u32, u32)], frame: usize) -> (Vec<Rgb>, Counts) {
        let mut counts = Counts::default();
        let mut film = vec![DVec3::ZERO; pixels.len() * self.shared.layers()];
        let mut sums = film.clone();
        for (pose, whole) in self.poses.iter().zip(&self.whole).filter(|(pose, _)| pose.frame == frame) {
            sums.fill(DVec3::ZERO);
            counts += whole.trace(pixels, &mut sums);
            pose.add(&sums, &mut film);
        }
        counts.paths.whole += self.paths(pixels.len());
        counts.paths.all += self.paths(pixels.len());
        (self.held(&film), counts)
    }

    /// The layers of pixels that films hold.
    fn held(&self, data: &[DVec3]) -> Vec<Rgb> {
        let pixels = data.chunks(self.shared.layers().max(1));
        pixels.flat_map(|pixel| self.held.iter().map(|&layer| pixel[layer].as_vec3())).collect()
    }

    /// The number of paths of a frame in some pixels.
    fn paths(&self, pixels: usize) -> u64 {
        pixels as u64 * u64::from(self.shared.count())
    }

    /// The number of pixels whose samples and sums fit into memory, in whole blocks.
    fn pixels_at_once(&self) -> usize {
        let layers = self.shared.layers().max(1);
        let values = layers * self.shared.count() as usize;
        let sums = layers * self.poses.len();
        let fitting = (self.limits.values / values.max(1)).min(self.limits.sums / sums.max(1));
        (fitting / PIXELS).max(1) * PIXELS
    }

    /// The number of samples of each pixel of a block that fit into memory.
    fn samples_at_once(&self) -> usize {
        (self.limits.values / self.shared.layers().max(1) / PIXELS).max(1)
    }

    /// The sums of pixels of every pose, from shared samples.
    fn share(&self, pixels: &[(u32, u32)], counts: &mut Counts) -> Vec<Vec<DVec3>> {
        let zero = vec![DVec3::ZERO; pixels.len() * self.shared.layers()];
        let mut sums = vec![zero.clone(); self.poses.len()];
        let mut still: HashMap<Option<u32>, StillSums> = HashMap::new();
        let count = self.shared.count();
        let at_once = if pixels.len() > PIXELS { count as usize } else { self.samples_at_once() };
        for first in (0..count).step_by(at_once) {
            let numbers = first..count.min(first.saturating_add(at_once as u32));
            let size = (self.all, self.moments);
            let before = counts.paths;
            let samples = SharedSamples::trace(&self.shared, (pixels, numbers), size, counts);
            counts.paths.once += samples.frames.len() as u64;
            for ((pose, whole), sums) in self.poses.iter().zip(&self.whole).zip(&mut sums) {
                let moment = pose.pose().moment;
                let still = still.entry(moment).or_insert_with(|| StillSums::new(&zero));
                still.add((whole, moment), &samples, &mut counts.dropped);
                let again = samples.retrace(whole, (1 << pose.frame, moment), counts);
                samples.add_to((whole, moment), &again, still, sums, &mut counts.dropped);
                counts.paths.retraced += again.len() as u64;
            }
            let paths = &mut counts.paths;
            let still = paths.still_work - before.still_work;
            let again = paths.retraced_work - before.retraced_work;
            let (frames, samples) = (self.frames as u64, samples.frames.len() as u64);
            let retraced = paths.retraced - before.retraced;
            paths.alone_work += work_alone((still, again), frames, samples, retraced);
        }
        sums
    }
}
