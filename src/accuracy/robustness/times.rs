//! The time of a call of each method, on the scene's own rays.

use super::judge::ORIGIN_METHODS;
use super::rays::SceneRays;
use super::textbook::{TextbookNumber, TextbookShape};
use crate::accuracy::hard_cases::number::Vector3;
use crate::accuracy::hard_cases::{Method, Verdict, method};
use crate::base::math::{DAffine3, Ray};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::{Shape, Surface, Triangle};
use crate::scene::Primitive;
use crate::trace::spawn::spawn_ray;

/// The largest number of timed rays: few enough to stay in the processor's cache.
const TIMED: u32 = 256;
/// Rounds in which each method is timed once.
const ROUNDS: usize = 7;

/// A test of one shape.
#[derive(Clone)]
struct Test {
    ray: Ray,
    target: (u32, u32),
    surface: Surface,
}

type Timed = Option<Box<dyn Method>>;

/// Nanoseconds of a test of one shape by each method of the hard cases, and of each method of choosing a ray's origin.
pub fn times(rays: &SceneRays, size: (u32, u32)) -> ([f64; 4], [Option<f64>; ORIGIN_METHODS.len()]) {
    let tests = tests(rays, size);
    if tests.is_empty() {
        return ([0.0; 4], [None; ORIGIN_METHODS.len()]);
    }
    let f32s = || cast::<f32>(rays, &tests);
    let [textbook, stable] = [false, true].map(|stable| {
        let call = move |(shape, o, d): &(TextbookShape<f32>, Vector3<f32>, Vector3<f32>)| match stable {
            true => shape.stable(*o, *d),
            false => shape.hit(*o, *d, 0.0),
        };
        method(f32s(), call, |_, _| Verdict::RIGHT)
    });
    let wide =
        method(cast::<f64>(rays, &tests), |(shape, o, d)| shape.hit(*o, *d, 0.0), |_, _| Verdict::RIGHT);
    let ours: Vec<(Primitive, TraversalRay)> = tests.iter().filter_map(|test| alone(rays, test)).collect();
    let ours = method(
        ours,
        |(primitive, probe)| primitive.intersect_up_to(probe, f64::INFINITY),
        |_, _| Verdict::RIGHT,
    );
    let starts: Vec<Surface> = tests.iter().map(|test| test.surface).collect();
    let starts = method(starts, |surface| spawn_ray(surface, surface.normal), |_, _| Verdict::RIGHT);
    let [a, b, c, d, start] = medians([textbook, wide, stable, ours, starts]);
    let mut begins = [None; ORIGIN_METHODS.len()];
    if let Some(last) = begins.last_mut() {
        *last = Some(start);
    }
    ([a, b, c, d], begins)
}

fn medians(methods: [Timed; 5]) -> [f64; 5] {
    let mut all: [Vec<f64>; 5] = Default::default();
    for _ in 0..ROUNDS {
        for (times, way) in all.iter_mut().zip(&methods) {
            times.extend(way.as_ref().map(|way| way.time()));
        }
    }
    all.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times.get(times.len() / 2).copied().unwrap_or(0.0)
    })
}

/// Camera rays from all over the picture, each with its hit.
fn tests(rays: &SceneRays, size: (u32, u32)) -> Vec<Test> {
    let pixels = size.0 * size.1;
    let step = pixels.div_ceil(TIMED).max(1);
    // An odd step, so that the pixels are not all in few columns.
    let places = (0..pixels).step_by((step | 1) as usize);
    let test = |pixel: u32| {
        let ray = rays.camera_ray((pixel % size.0, pixel / size.0), size);
        let hit = rays.closest_hit(&ray)?;
        Some(Test { ray, target: hit.target, surface: hit.surface })
    };
    places.filter_map(test).collect()
}

fn cast<R: TextbookNumber>(
    rays: &SceneRays,
    tests: &[Test],
) -> Vec<(TextbookShape<R>, Vector3<R>, Vector3<R>)> {
    let one = |test: &Test| {
        let shape = TextbookShape::new(rays.primitive(test.target.0), test.target.1)?;
        Some((shape, Vector3::of(test.ray.origin), Vector3::of(test.ray.direction)))
    };
    tests.iter().filter_map(one).collect()
}

/// Kinora's primitive, or a single triangle of a mesh.
fn alone(rays: &SceneRays, test: &Test) -> Option<(Primitive, TraversalRay)> {
    let primitive = rays.primitive(test.target.0);
    let probe = TraversalRay::new(test.ray);
    let Shape::Mesh(mesh) = &primitive.shape else { return Some((primitive.clone(), probe)) };
    let triangle = Shape::Triangle(Triangle { corners: mesh.mesh.corners(test.target.1) });
    let to_world = primitive.transform.as_ref().map_or(DAffine3::IDENTITY, |transform| transform.to_world);
    Some((Primitive::new(&triangle, to_world, primitive.finish)?, probe))
}
