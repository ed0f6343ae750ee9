//! What the ways of paths to what they meet leave of the light: absorption in media, and fog.

use super::accumulate::Accumulator;
use super::context::{Queue, TraceContext};
use super::intersect::Hits;
use super::medium::{MediaLists, OUTSIDE};
use super::stream::PathStream;
use crate::base::color::Rgb;
use crate::base::lanes::{Color, Level, Lookup, Mask, Real, Row, Select, SimdKernel, out_of_line};
use crate::base::math::{LaneRay, exp};
use crate::base::stats::Counts;
use crate::scene::top_level::NOTHING;

/// Dims the throughput of a wave's paths.
pub struct Segments<'a> {
    pub context: &'a TraceContext<'a>,
    pub paths: &'a mut PathStream,
    pub hits: &'a Hits,
    pub media: &'a MediaLists,
    pub sums: &'a mut Accumulator,
    pub counts: &'a mut Counts,
}

impl SimdKernel for Segments<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { context, paths, hits, media, sums, counts } = self;
        for first in (0..paths.len()).step_by(8) {
            let count = (paths.len() - first).min(8);
            let at = Lookup::run(first as u32, count);
            let there = L::Mask::from_bits(0xff >> (8 - count));
            let mut path = paths.gather::<L::F64>(&at);
            // What is met as one of several surfaces in a place has no way to it.
            let t = L::F64::gather(&hits.t, &at).max(path.after);
            let length = t - path.after;
            let passed = transmittance::<L::F64>(media, path.medium, length);
            if let Some(passed) = &passed {
                path.throughput.diffuse = path.throughput.diffuse * *passed;
                path.throughput.specular = path.throughput.specular * *passed;
            }
            if let Some(fog) = &context.fog {
                counts.evaluations.fog += count as u64;
                let way = LaneRay { origin: path.ray.at(path.after), direction: path.ray.direction };
                let opacity = fog.opacity(&way, length).to_f32();
                let surface = surfaces::<L>(context, hits, first, count);
                let glow = Color::splat(fog.glow.radiance) * opacity;
                let seen = path.throughput.specular * path.throughput.clear;
                // What a surface gathers comes through no fog: a way to what shines by itself glows for the other
                // part alone.
                let seen = Color::select(surface, path.throughput.lit(), seen);
                sums.add::<L::F64>(fog.glow.layer, seen * glow, there, path.slot);
                path.throughput.clear = path.throughput.clear * (L::F32::splat(1.0) - opacity);
            }
            if passed.is_some() || context.fog.is_some() {
                paths.set_throughput(first, &path.throughput);
            }
        }
    }
}

/// Lanes in which a path has met a surface, not a light or nothing.
#[inline(always)]
fn surfaces<L: Level>(context: &TraceContext, hits: &Hits, first: usize, count: usize) -> L::Mask {
    let mut bits = 0;
    for lane in 0..count {
        let (primitive, part) = (hits.primitive[first + lane], hits.part[first + lane]);
        let surface = primitive != NOTHING && matches!(context.route(primitive, part).0, Queue::Surface(_));
        bits |= u32::from(surface) << lane;
    }
    L::Mask::from_bits(bits)
}

out_of_line! {
    /// The shares of light that media leave on segments of these lengths; none if all of it is left everywhere.
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

/// The share that is left after a way.
#[inline(always)]
fn left<F: Real>(absorption: F, length: F) -> F::F32 {
    // A way without end through what absorbs nothing: 0 · ∞ would be no number.
    let zero = F::splat(0.0);
    F::select(absorption.eq(zero), F::splat(1.0), exp(-(absorption * length))).to_f32()
}
