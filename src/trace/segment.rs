//! The segment stage: absorption of media and fog along the segments of paths.

use super::accumulate::Accumulator;
use super::context::{Queue, TraceContext};
use super::intersect::HitStream;
use super::medium::{MediaLists, OUTSIDE};
use super::stream::PathStream;
use crate::base::color::Rgb;
use crate::base::lanes::{Color, Level, Lookup, Mask, Real, Row, Select, SimdKernel, out_of_line};
use crate::base::math::{LaneRay, exp};
use crate::base::stats::Counts;
use crate::scene::top_level::NOTHING;

/// Attenuates the throughput of a wave's paths, and adds in-scattered light of fog.
pub struct AttenuateSegments<'a> {
    pub context: &'a TraceContext<'a>,
    pub paths: &'a mut PathStream,
    pub hits: &'a HitStream,
    pub media: &'a MediaLists,
    pub sums: &'a mut Accumulator,
    pub counts: &'a mut Counts,
}

impl SimdKernel for AttenuateSegments<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { context, paths, hits, media, sums, counts } = self;
        for first in (0..paths.len()).step_by(8) {
            let count = (paths.len() - first).min(8);
            let at = Lookup::run(first as u32, count);
            let active = L::Mask::from_bits(0xff >> (8 - count));
            let mut path = paths.gather::<L::F64>(&at);
            // The next of several surfaces in one place has a segment of length 0.
            let t = L::F64::gather(&hits.t, &at).max(path.t_start);
            let length = t - path.t_start;
            let passed = transmittance::<L::F64>(media, path.medium, length);
            if let Some(passed) = &passed {
                path.throughput.diffuse = path.throughput.diffuse * *passed;
                path.throughput.specular = path.throughput.specular * *passed;
            }
            if let Some(fog) = &context.fog {
                counts.evaluations.fog += count as u64;
                let segment = LaneRay { origin: path.ray.at(path.t_start), direction: path.ray.direction };
                let opacity = fog.opacity(&segment, length).to_f32();
                let surface = surfaces::<L>(context, hits, first, count);
                let in_scattered = Color::splat(fog.in_scattering.radiance) * opacity;
                let seen = path.throughput.specular * path.throughput.fog_transmittance;
                // Diffuse lighting ignores fog. On segments that end at an emitter or the sky, in-scattering is added
                // to the specular throughput only.
                let seen = Color::select(surface, path.throughput.at_surface(), seen);
                sums.add::<L::F64>(fog.in_scattering.layer, seen * in_scattered, active, path.slot);
                path.throughput.fog_transmittance =
                    path.throughput.fog_transmittance * (L::F32::splat(1.0) - opacity);
            }
            if passed.is_some() || context.fog.is_some() {
                paths.set_throughput(first, &path.throughput);
            }
        }
    }
}

/// Lanes whose path hits a surface, not a light or nothing.
#[inline(always)]
fn surfaces<L: Level>(context: &TraceContext, hits: &HitStream, first: usize, count: usize) -> L::Mask {
    let mut bits = 0;
    for lane in 0..count {
        let (primitive, part) = (hits.primitive[first + lane], hits.part[first + lane]);
        let surface = primitive != NOTHING && matches!(context.route(primitive, part).0, Queue::Surface(_));
        bits |= u32::from(surface) << lane;
    }
    L::Mask::from_bits(bits)
}

out_of_line! {
    /// The transmittance of the media along segments of these lengths. `None` if no medium absorbs.
    pub fn transmittance<'k, F>(media: &'k MediaLists, inside: F::U32, length: F) -> Option<Color<F::F32>> {
        let (inside, none) = (inside.to_array(), F::splat(0.0).to_array());
        let (mut absorption, mut absorbs) = ([none; 3], false);
        for lane in 0..F::LANES {
            if inside[lane] != OUTSIDE {
                let medium = media.medium(inside[lane]);
                absorbs |= medium.absorption != Rgb::ZERO;
                for (row, value) in absorption.iter_mut().zip(medium.absorption.to_array()) {
                    row[lane] = f64::from(value);
                }
            }
        }
        if !absorbs {
            return None;
        }
        let [r, g, b] = absorption;
        Some(Color {
            r: left(F::from_array(r), length),
            g: left(F::from_array(g), length),
            b: left(F::from_array(b), length),
        })
    }
}

/// The transmittance of one channel.
#[inline(always)]
fn left<F: Real>(absorption: F, length: F) -> F::F32 {
    // An infinite segment without absorption would give 0 · ∞.
    let zero = F::splat(0.0);
    F::select(absorption.eq(zero), F::splat(1.0), exp(-(absorption * length))).to_f32()
}
