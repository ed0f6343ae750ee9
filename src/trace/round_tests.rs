//! Rays that walk through cylinders, cones and tori, from surface to surface. The number of crossings is even, also at
//! rims and tips (INT-09 of the hard cases), and no ray hits its own starting point (SELF-01).

use super::spawn::spawn_ray;
use crate::appearance::material::MaterialBinding;
use crate::base::math::{Angle, DAffine3, DMat3, DVec3, Ray, UNIT_ROUNDOFF, axis_angle, euler_xyz};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::{Cone, Cylinder, Shape, Surface, Torus};
use crate::scene::{Finish, Primitive};
use crate::testing::Random;

/// Rays per shape.
const RAYS: u32 = if cfg!(debug_assertions) { 30_000 } else { 300_000 };

fn cylinder(capped: bool) -> Shape {
    Shape::Cylinder(Cylinder::new(DVec3::NEG_Y, DVec3::Y, 1.0, capped).expect("a cylinder"))
}

fn cone(radius: f64, top_radius: f64) -> Shape {
    Shape::Cone(Cone::new(DVec3::ZERO, DVec3::Y, radius, top_radius, true).expect("a cone"))
}

fn torus(minor: f64) -> Shape {
    Shape::Torus(Torus::new(DVec3::ZERO, DVec3::Y, 1.0, minor))
}

fn placed(shape: Shape, to_world: DAffine3) -> Primitive {
    Primitive::new(&shape, to_world, Finish::Material(MaterialBinding::One(0))).expect("a primitive")
}

/// The surfaces that a ray hits, at most nine. Each ray starts on the surface before.
fn walk(primitive: &Primitive, ray: Ray) -> Vec<Surface> {
    let mut found: Vec<Surface> = Vec::new();
    let mut next = ray;
    while let Some(at) = primitive.intersect_up_to(&TraversalRay::new(next), f64::INFINITY) {
        let surface = primitive.surface_at(&next, at);
        next = spawn_ray(&surface, ray.direction);
        found.push(surface);
        if found.len() == 9 {
            break;
        }
    }
    found
}

/// A point of the unit circle around the y axis.
fn circle(random: &mut Random) -> DVec3 {
    let turn = Angle(360.0 * random.unit()).cos_sin();
    DVec3::new(turn.x, 0.0, turn.y)
}

/// Walks along rays from three distances. Half of them aim at the shape's rims or tip, which have these heights and
/// radii, and half at points inside. `to_world` moves both the shape and the rays. Returns the number of rays without
/// exactly none or two crossings.
fn walks(shape: Shape, rims: [(f64, f64); 2], to_world: DAffine3, rays: u32) -> u32 {
    let primitive = placed(shape, to_world);
    let size = rims[0].1.max(rims[1].1).max(1.0);
    let mut random = Random(9);
    let (mut odd, mut missed) = (0, 0);
    for ray in 0..rays {
        let origin = random.direction() * (size * [3.0, 100.0, 1e4][(ray / 4 % 3) as usize]);
        let between = random.unit();
        let inside = rims[0].0 * (1.0 - between) + rims[1].0 * between;
        let inner = rims[0].1 * (1.0 - between) + rims[1].1 * between;
        let (height, radius) = match ray % 4 {
            0 | 1 => rims[(ray % 4) as usize],
            _ => (inside, inner * random.unit() * 0.999),
        };
        let aim = circle(&mut random) * radius + DVec3::Y * height;
        let (origin, aim) = (to_world.transform_point3(origin), to_world.transform_point3(aim));
        let direction = if ray % 3 == 0 { aim - origin } else { (aim - origin).normalize() };
        let count = walk(&primitive, Ray { origin, direction }).len();
        odd += u32::from(count != 0 && count != 2);
        missed += u32::from(ray % 4 > 1 && count == 0);
    }
    assert_eq!(missed, 0, "rays at points inside that miss");
    odd
}

const CYLINDER_RIMS: [(f64, f64); 2] = [(-1.0, 1.0), (1.0, 1.0)];
const CONES: [(f64, f64); 8] =
    [(1.0, 0.0), (1.0, 0.4), (0.2, 1.3), (1e-2, 0.0), (1e3, 0.0), (1e6, 0.0), (1e6, 4e5), (1e3, 1e6)];

fn crossings_are_even(rays: u32) {
    let turned = DAffine3::from_mat3_translation(
        euler_xyz(Angle(30.0), Angle(40.0), Angle(0.0)) * 3.0,
        DVec3::new(7.0, -100.0, 30.0),
    );
    for to_world in [DAffine3::IDENTITY, turned, DAffine3::from_translation(DVec3::splat(1e6))] {
        assert_eq!(walks(cylinder(true), CYLINDER_RIMS, to_world, rays), 0, "cylinder {to_world}");
        for (radius, top) in CONES {
            let rims = [(0.0, radius), (1.0, top)];
            let odd = walks(cone(radius, top), rims, to_world, rays);
            assert_eq!(odd, 0, "cone of {radius} and {top} {to_world}");
        }
    }
}

#[test]
fn int_09_crossings_are_none_or_two() {
    crossings_are_even(RAYS);
}

#[test]
#[ignore = "takes ten seconds: the full number of rays of INT-09; cargo test --release -- --ignored int_09"]
fn int_09_crossings_of_a_million_rays() {
    crossings_are_even(1_000_000);
}

/// Rays at a rim hit the shape if they enter by more than the rounding of their origin.
#[test]
fn int_09_rays_at_rims_that_enter_hit() {
    let mut random = Random(10);
    for (shape, rim, inwards) in [
        (cylinder(true), 1.0, DVec3::new(-1.0, -1.0, 0.0)),
        (cylinder(true), -1.0, DVec3::new(-1.0, 1.0, 0.0)),
        (cone(1.0, 0.0), 0.0, DVec3::new(-1.0, 0.5, 0.0)),
    ] {
        let primitive = placed(shape, DAffine3::IDENTITY);
        for _ in 0..RAYS {
            let distance = [3.0, 100.0, 1e4][(3.0 * random.unit()) as usize];
            let out = circle(&mut random);
            let point = out + DVec3::Y * rim;
            // The ray aims below the rim by more than the rounding, in the plane of the axis.
            let depth = 16.0 * UNIT_ROUNDOFF * distance * (1.0 + 3.0 * random.unit());
            let aim = point + (out * -inwards.x.abs() + DVec3::Y * inwards.y) * depth;
            let origin = random.direction() * distance;
            let probe = TraversalRay::new(Ray { origin, direction: aim - origin });
            assert!(primitive.intersect_up_to(&probe, f64::INFINITY).is_some(), "{probe:?}");
        }
    }
}

#[test]
fn int_09_crossings_of_tori_are_even() {
    let uneven = DAffine3::from_mat3_translation(
        euler_xyz(Angle(30.0), Angle(40.0), Angle(0.0)) * DMat3::from_diagonal(DVec3::new(-2.0, 1.0, 0.5)),
        DVec3::new(7.0, -3.0, 4.0),
    );
    let mut random = Random(11);
    for (minor, to_world) in [0.9, 0.25, 0.01, 1e-4].into_iter().flat_map(|minor| {
        [(minor, DAffine3::IDENTITY), (minor, uneven), (minor, DAffine3::from_translation(DVec3::splat(1e3)))]
    }) {
        let primitive = placed(torus(minor), to_world);
        for ray in 0..RAYS / 4 {
            let origin = random.direction() * [3.0, 100.0, 1e4][(ray % 3) as usize];
            let aim = circle(&mut random) + random.direction() * (0.9 * minor * random.unit());
            let (origin, aim) = (to_world.transform_point3(origin), to_world.transform_point3(aim));
            let count = walk(&primitive, Ray { origin, direction: (aim - origin).normalize() }).len();
            assert!(count == 2 || count == 4, "{count} crossings: {minor} {to_world} {ray}");
        }
    }
}

/// Ellipses instead of circles, mirrored and sheared by uneven scales of turned shapes.
#[test]
fn int_09_crossings_of_unevenly_scaled_shapes_are_even() {
    let mut random = Random(12);
    let mut odd = 0;
    for shape in [cylinder(true), cone(1.0, 0.0), cone(1.0, 0.4)] {
        for _ in 0..20 {
            let scale = random.point(3.0);
            let to_world = DAffine3::from_mat3_translation(
                axis_angle(random.direction(), Angle(360.0 * random.unit())) * DMat3::from_diagonal(scale),
                random.point(10.0),
            );
            let primitive = placed(shape.clone(), to_world);
            for _ in 0..RAYS / 60 {
                let inside =
                    circle(&mut random) * (0.4 * random.unit()) + DVec3::Y * (0.1 + 0.4 * random.unit());
                let origin = inside + random.direction() * [3.0, 100.0, 1e4][(3.0 * random.unit()) as usize];
                let [origin, aim] = [origin, inside].map(|p| to_world.transform_point3(p));
                let count = walk(&primitive, Ray { origin, direction: aim - origin }).len();
                odd += u32::from(count != 2);
            }
        }
    }
    assert_eq!(odd, 0);
}

/// From inside a convex shape, every ray leaves once. From inside the tube of a torus, it leaves once or three times.
#[test]
fn int_05_rays_that_start_inside_leave() {
    let mut random = Random(13);
    for (shape, counts) in [(cylinder(true), [1, 1]), (cone(1.0, 0.4), [1, 1]), (torus(0.5), [1, 3])] {
        let primitive = placed(shape.clone(), DAffine3::from_scale(DVec3::splat(0.3)));
        for _ in 0..RAYS {
            let origin = match shape {
                Shape::Torus(_) => circle(&mut random) + random.direction() * (0.499 * random.unit()),
                _ => circle(&mut random) * (0.6 * random.unit()) + DVec3::Y * (0.01 + 0.9 * random.unit()),
            };
            let ray = Ray { origin: origin * 0.3, direction: random.direction() };
            // Only points inside the cone: its radius at height y is 1 - 0.6 y.
            if matches!(shape, Shape::Cone(_)) && origin.with_y(0.0).length() >= 0.999 - 0.6 * origin.y {
                continue;
            }
            let count = walk(&primitive, ray).len();
            assert!(counts.contains(&count), "{count} crossings of {shape:?} from {origin}");
        }
    }
}

/// Sizes and distances from the origin of SELF-01.
fn each_place() -> impl Iterator<Item = (f64, DVec3)> {
    let away = DVec3::new(0.6, 0.64, 0.48);
    [1e-3, 1.0, 1e3, 1e6]
        .into_iter()
        .flat_map(move |size| [0.0, 10.0, 1e3, 1e4, 1e6].map(|at| (size, away * at)))
}

/// A torus shadows itself where it is hollow, but not within the ball that touches it from outside and reaches its
/// axis. So there is no shadow before 2·cos·(R - r).
#[test]
fn self_01_lit_tori_do_not_shadow_themselves() {
    for minor in [0.8, 0.25, 0.02] {
        for (size, middle) in each_place() {
            let turn = euler_xyz(Angle(30.0), Angle(40.0), Angle(0.0)) * size;
            let to_world = DAffine3::from_mat3_translation(turn, middle);
            // If the radius of the tube is near the resolution of its position, the tube is a line in floating point.
            if minor * size < 1e4 * UNIT_ROUNDOFF * middle.length() {
                continue;
            }
            assert_eq!(
                false_shadows(&torus(minor), to_world, size, 1.0 - minor),
                0,
                "{minor} {size} {middle}"
            );
        }
    }
}

fn false_shadows(shape: &Shape, to_world: DAffine3, size: f64, free: f64) -> usize {
    let primitive = placed(shape.clone(), to_world);
    let mut random = Random(14);
    let mut wrong = 0;
    for _ in 0..RAYS / 30 {
        let surface = Surface::from(primitive.shape.sample_area(random.unit(), random.unit()).0);
        let direction = random.direction();
        let cosine = surface.normal.dot(direction);
        let at = primitive.intersect_up_to(&TraversalRay::new(spawn_ray(&surface, direction)), f64::INFINITY);
        // Inwards, the ray leaves the tube. Outwards, nothing is near.
        let limit = if cosine < 0.0 { 0.0 } else { 1.9 * cosine * free * size };
        wrong += usize::from(cosine.abs() > 1e-3 && at.is_some_and(|at| at.t < limit));
        wrong += usize::from(cosine < -1e-3 && at.is_none());
    }
    wrong
}

/// Distances of ray origins from their surfaces, in units of u·(|c| + r), where r is the radius of a sphere around the
/// shape.
#[test]
fn self_01_rays_start_close_by() {
    let mut worst = [0.0f64; 4];
    for (i, (shape, radius)) in [
        (cylinder(true), 2f64.sqrt()),
        (cone(1.0, 0.0), 1.25f64.sqrt()),
        (torus(0.25), 1.25),
        (torus(0.02), 1.02),
    ]
    .into_iter()
    .enumerate()
    {
        for (size, middle) in each_place() {
            let turn = euler_xyz(Angle(30.0), Angle(40.0), Angle(0.0)) * size;
            let primitive = placed(shape.clone(), DAffine3::from_mat3_translation(turn, middle));
            let mut random = Random(15);
            for _ in 0..RAYS / 100 {
                let surface = Surface::from(primitive.shape.sample_area(random.unit(), random.unit()).0);
                let moved = spawn_ray(&surface, random.direction()).origin - surface.point;
                worst[i] = worst[i].max(moved.length() / (UNIT_ROUNDOFF * (middle.length() + radius * size)));
            }
        }
    }
    assert!(worst.iter().all(|&worst| worst <= 32.0), "{worst:?}");
}
