//! A tile of several frames.

use super::super::pixels::PixelTracer;
use super::super::{BLOCK, Tile};
use super::FramePose;
use super::samples::SharedSamples;
use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::base::stats::Counts;
use crate::scene::movers::FrameMask;
use std::collections::HashMap;

/// The most samples that are kept at once, unless a block of pixels has more.
const MAX_SAMPLES: usize = 1 << 16;

/// Traces tiles of frames that share paths.
pub struct TileTracer<'a> {
    poses: &'a [FramePose<'a>],
    /// Without movers.
    shared: PixelTracer<'a>,
    /// One for each pose.
    whole: Vec<PixelTracer<'a>>,
    /// All frames, and the number of moments of those that have several.
    all: FrameMask,
    moments: u32,
    held: Vec<usize>,
}

impl<'a> TileTracer<'a> {
    pub fn new(poses: &'a [FramePose<'a>], shared: PixelTracer<'a>, whole: Vec<PixelTracer<'a>>) -> Self {
        let all = poses.iter().fold(0, |all, pose| all | 1 << pose.frame);
        let moments = poses.iter().map(|pose| pose.moment.of).max().unwrap_or(1);
        let held = shared.held();
        Self { poses, shared, whole, all, moments, held }
    }

    /// The pixels of a tile, frame after frame. If `shares` is false, every frame is traced whole.
    pub fn trace(&self, tile: &Tile, shares: bool) -> (Vec<Rgb>, Counts) {
        let (pixels, layers, mut counts) = (tile.pixels(), self.shared.layers(), Counts::default());
        let mut sums: Vec<Vec<DVec3>> = vec![Vec::new(); self.poses.len()];
        if shares {
            let block = (BLOCK.0 * BLOCK.1) as usize;
            let at_once = (MAX_SAMPLES / self.shared.count() as usize / block).max(1) * block;
            for pixels in pixels.chunks(at_once) {
                self.share(pixels, &mut sums, &mut counts);
            }
        }
        let samples = f64::from(self.shared.count());
        for (whole, sums) in self.whole.iter().zip(&mut sums) {
            if !shares {
                sums.resize(pixels.len() * layers, DVec3::ZERO);
                counts += whole.trace(&pixels, sums);
            } else if samples > 1.0 {
                sums.iter_mut().for_each(|sum| *sum /= samples);
            }
        }
        (self.developed(&sums, pixels.len()), counts)
    }

    /// Appends the sums of pixels of every pose, from shared samples.
    fn share(&self, pixels: &[(u32, u32)], sums: &mut [Vec<DVec3>], counts: &mut Counts) {
        let samples = SharedSamples::trace(&self.shared, pixels, (self.all, self.moments), counts);
        let mut still: HashMap<Option<u32>, (Vec<DVec3>, u64)> = HashMap::new();
        for ((pose, whole), sums) in self.poses.iter().zip(&self.whole).zip(sums) {
            let moment = pose.pose().moment;
            let (own, count) = still.entry(moment).or_insert_with(|| {
                let dropped = &mut counts.dropped;
                (samples.sums(whole, moment, dropped), samples.len_at(moment))
            });
            let before = sums.len();
            sums.extend_from_slice(own);
            let again = samples.retrace(whole, (1 << pose.frame, moment), counts);
            samples.replace(whole, moment, &again, &mut sums[before..], &mut counts.dropped);
            counts.paths.retraced += again.len() as u64;
            counts.paths.reused += *count - again.len() as u64;
        }
    }

    /// Adds the moments of each frame, and keeps the layers that films hold.
    fn developed(&self, sums: &[Vec<DVec3>], pixels: usize) -> Vec<Rgb> {
        let layers = self.shared.layers();
        let mut data = Vec::new();
        let poses: Vec<_> = self.poses.iter().zip(sums).collect();
        for moments in poses.chunk_by(|a, b| a.0.frame == b.0.frame) {
            for at in (0..pixels).flat_map(|pixel| self.held.iter().map(move |layer| pixel * layers + layer))
            {
                let sum = match moments {
                    [(_, only)] => only[at],
                    several => several.iter().fold(DVec3::ZERO, |sum, (_, one)| sum + one[at]),
                };
                data.push(sum.as_vec3());
            }
        }
        data
    }
}
