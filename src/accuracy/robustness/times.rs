//! What each way takes of a call, on the scene's own rays.

use super::bodies::{Body, Textbook};
use super::judge::START_NAMES;
use super::rays::Scenery;
use crate::accuracy::hard_cases::real::V;
use crate::accuracy::hard_cases::{Verdict, Way, way};
use crate::base::math::{DAffine3, Ray};
use crate::geometry::bvh::Probe;
use crate::geometry::shape::{Shape, Surface, Triangle};
use crate::scene::Primitive;
use crate::trace::spawn::spawn_ray;

/// Rays that are timed: so few that they stay in the processor's cache.
const TIMED: u32 = 256;
/// Rounds in which each way is timed once.
const ROUNDS: usize = 7;

/// A test of one shape.
#[derive(Clone)]
struct Test {
    ray: Ray,
    target: (u32, u32),
    surface: Surface,
}

type Timed = Option<Box<dyn Way>>;

/// Nanoseconds of a test of one shape by the ways of hard cases, and of a start by those of starting rays.
pub fn times(scenery: &Scenery, size: (u32, u32)) -> ([f64; 4], [Option<f64>; START_NAMES.len()]) {
    let tests = tests(scenery, size);
    if tests.is_empty() {
        return ([0.0; 4], [None; START_NAMES.len()]);
    }
    let f32s = || cast::<f32>(scenery, &tests);
    let [textbook, stable] = [false, true].map(|stable| {
        let call = move |(body, o, d): &(Body<f32>, V<f32>, V<f32>)| match stable {
            true => body.stable(*o, *d),
            false => body.hit(*o, *d, 0.0),
        };
        way(f32s(), call, |_, _| Verdict::RIGHT)
    });
    let wide = way(cast::<f64>(scenery, &tests), |(body, o, d)| body.hit(*o, *d, 0.0), |_, _| Verdict::RIGHT);
    let ours: Vec<(Primitive, Probe)> = tests.iter().filter_map(|test| alone(scenery, test)).collect();
    let ours = way(ours, |(primitive, probe)| primitive.hit(probe, f64::INFINITY), |_, _| Verdict::RIGHT);
    let starts: Vec<Surface> = tests.iter().map(|test| test.surface).collect();
    let starts = way(starts, |surface| spawn_ray(surface, surface.normal), |_, _| Verdict::RIGHT);
    let [a, b, c, d, start] = medians([textbook, wide, stable, ours, starts]);
    let mut begins = [None; START_NAMES.len()];
    if let Some(last) = begins.last_mut() {
        *last = Some(start);
    }
    ([a, b, c, d], begins)
}

fn medians(ways: [Timed; 5]) -> [f64; 5] {
    let mut all: [Vec<f64>; 5] = Default::default();
    for _ in 0..ROUNDS {
        for (times, way) in all.iter_mut().zip(&ways) {
            times.extend(way.as_ref().map(|way| way.time()));
        }
    }
    all.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times.get(times.len() / 2).copied().unwrap_or(0.0)
    })
}

/// Camera rays all over the picture, each with what it meets.
fn tests(scenery: &Scenery, size: (u32, u32)) -> Vec<Test> {
    let pixels = size.0 * size.1;
    let step = pixels.div_ceil(TIMED).max(1);
    // No divisor of the width, so that they do not stand in columns.
    let places = (0..pixels).step_by((step | 1) as usize);
    let test = |pixel: u32| {
        let ray = scenery.camera_ray((pixel % size.0, pixel / size.0), size);
        let met = scenery.met(&ray)?;
        Some(Test { ray, target: met.target, surface: met.surface })
    };
    places.filter_map(test).collect()
}

fn cast<R: Textbook>(scenery: &Scenery, tests: &[Test]) -> Vec<(Body<R>, V<R>, V<R>)> {
    let one = |test: &Test| {
        let body = Body::new(scenery.primitive(test.target.0), test.target.1)?;
        Some((body, V::of(test.ray.origin), V::of(test.ray.direction)))
    };
    tests.iter().filter_map(one).collect()
}

/// Kinora's own, of a mesh the one triangle.
fn alone(scenery: &Scenery, test: &Test) -> Option<(Primitive, Probe)> {
    let primitive = scenery.primitive(test.target.0);
    let probe = Probe::new(test.ray);
    let Shape::Mesh(mesh) = &primitive.shape else { return Some((primitive.clone(), probe)) };
    let triangle = Shape::Triangle(Triangle { corners: mesh.mesh.corners(test.target.1) });
    let to_world = primitive.placement.as_ref().map_or(DAffine3::IDENTITY, |placement| placement.to_world);
    Some((Primitive::new(&triangle, to_world, primitive.finish)?, probe))
}
