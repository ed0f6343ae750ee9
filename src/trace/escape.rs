//! Paths that meet nothing any more, eight at a time: what the sky sends to them.
//!
//! Every number is that of [`Tracer::add_sky`], lane by lane.

use super::path::Path;
use super::tracer::{Tracer, Work};
use crate::color::Rgb;
use crate::environment::Environment;
use crate::simd::{self, Lanes, Rows, dispatch};

/// Adds the sky's light to paths, places of which among all are given, where it is only met and never asked for.
pub fn add_sky(tracer: &Tracer, paths: &[Path], places: &[u32], work: &mut Work) {
    let Some(environment) = tracer.environment else { return };
    dispatch(Escape { environment, paths, places, work });
}

struct Escape<'a> {
    environment: &'a Environment,
    paths: &'a [Path],
    places: &'a [u32],
    work: &'a mut Work,
}

impl simd::Work for Escape<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { environment, paths, places, work } = self;
        for places in places.chunks(8) {
            let mut directions = Rows::ZERO;
            for (lane, place) in places.iter().enumerate() {
                directions.set(lane, paths[*place as usize].ray.direction);
            }
            let [r, g, b] = environment.radiance_of_eight::<L>(&directions);
            for (lane, place) in places.iter().enumerate() {
                let path = &paths[*place as usize];
                work.first = path.first;
                let radiance = Rgb::new(r[lane], g[lane], b[lane]);
                work.add(environment.layer, path.throughput.shining() * radiance);
            }
        }
    }
}
