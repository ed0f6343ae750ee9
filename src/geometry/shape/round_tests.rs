//! Cylinders, cones and tori: hard cases, and reference solutions that do not use the formulas under test.

use super::{Cone, Cylinder, Geometric, OneRay, ShapeHit, Surface, Torus};
use crate::base::math::exact::{Exact, Vector};
use crate::base::math::{DAffine3, DMat3, DVec2, DVec3, Ray, UNIT_ROUNDOFF};
use crate::geometry::bvh::TraversalRay;
use crate::testing::Random;

/// Rays per sweep.
const RAYS: u32 = if cfg!(debug_assertions) { 20_000 } else { 400_000 };

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// Around the y axis, up to `half` above and below the origin.
fn cylinder(radius: f64, half: f64, capped: bool) -> Cylinder {
    Cylinder::new(v(0.0, -half, 0.0), v(0.0, half, 0.0), radius, capped).expect("a cylinder")
}

/// With its tip at height 1 above the unit disk around the origin.
fn cone(top_radius: f64, capped: bool) -> Cone {
    Cone::new(DVec3::ZERO, DVec3::Y, 1.0, top_radius, capped).expect("a cone")
}

fn hit(shape: &impl Geometric, origin: DVec3, direction: DVec3) -> Option<f64> {
    shape.intersect_up_to(&TraversalRay::new(Ray { origin, direction }), f64::INFINITY).map(|hit| hit.t)
}

fn met(shape: &impl Geometric, origin: DVec3, direction: DVec3) -> (f64, Surface) {
    let ray = Ray { origin, direction };
    let at = shape.intersect_up_to(&TraversalRay::new(ray), f64::INFINITY).expect("a hit");
    (at.t, shape.surface_at(&ray, at))
}

/// All t at which the ray hits the shape. Each next search starts at a new origin slightly beyond the last hit.
fn all(shape: &impl Geometric, ray: Ray, step: f64) -> Vec<f64> {
    let mut found = Vec::new();
    let mut from = 0.0;
    while let Some(t) = hit(shape, ray.at(from), ray.direction) {
        from += t;
        found.push(from);
        from += step;
    }
    found
}

fn near(t: f64, expected: f64, units: f64) {
    assert!((t - expected).abs() <= units * UNIT_ROUNDOFF * expected.abs(), "{t} instead of {expected}");
}

#[test]
fn int_07_rays_along_and_across_a_cylinder() {
    let (t, surface) = met(&cylinder(3.0, 2.0, true), DVec3::ZERO, DVec3::Y);
    assert_eq!((t, surface.normal), (2.0, DVec3::Y));
    let unit = cylinder(1.0, 1.0, true);
    let below = Ray { origin: v(0.5, -10.0, 0.0), direction: DVec3::Y };
    assert_eq!(all(&unit, below, 1e-9), [9.0, 11.0]);
    assert_eq!(hit(&unit, v(1.5, -10.0, 0.0), DVec3::Y), None);
    let (t, surface) = met(&unit, v(-5.0, 0.25, 0.0), DVec3::X);
    assert_eq!((t, surface.normal), (4.0, DVec3::NEG_X));
    assert!(unit.uv_at(surface.point, 0).is_finite());
    near(hit(&unit, v(0.5, -0.9, 0.0), v(1e-20, 1.0, 0.0)).expect("a hit"), 1.9, 4.0);
    near(hit(&unit, v(0.5, -0.9, 0.0), v(1e-3, 1.0, 0.0)).expect("a hit"), 1.9, 4.0);
}

#[test]
fn int_08_both_caps_in_all_quadrants() {
    let (cylinder, cone) = (cylinder(1.0, 1.0, true), cone(0.0, true));
    for (x, z) in [(0.5, 0.25), (0.5, -0.25), (-0.5, 0.25), (-0.5, -0.25)] {
        let (above, below) = (v(x, 5.0, z), v(x, -5.0, z));
        let (t, surface) = met(&cylinder, above, DVec3::NEG_Y);
        assert_eq!((t, surface.normal), (4.0, DVec3::Y));
        let (t, surface) = met(&cylinder, below, DVec3::Y);
        assert_eq!((t, surface.normal), (4.0, DVec3::NEG_Y));
        let (t, surface) = met(&cone, below, DVec3::Y);
        assert_eq!((t, surface.normal), (5.0, DVec3::NEG_Y));
        near(met(&cone, above, DVec3::NEG_Y).0, 4.559_016_994_374_947, 4.0);
    }
}

#[test]
fn int_10_the_tip_the_mirrored_nappe_and_the_side_of_a_cone() {
    let cone = cone(0.0, true);
    let (t, surface) = met(&cone, v(0.0, 5.0, 0.0), DVec3::NEG_Y);
    assert_eq!(t, 4.0);
    assert!((surface.normal.length() - 1.0).abs() <= 8.0 * UNIT_ROUNDOFF);
    assert_eq!(hit(&cone, v(-5.0, 2.0, 0.0), DVec3::X), None);
    let (t, surface) = met(&cone, v(-5.0, 0.5, 0.2), DVec3::X);
    near(t, 4.541_742_430_504_416, 8.0);
    let normal = v(-0.21f64.sqrt() * 2.0, 1.0, 0.4) / 2f64.sqrt();
    let off = (surface.normal - normal).abs().max_element();
    assert!(off <= 8.0 * UNIT_ROUNDOFF, "{off:e}");
    let through = hit(&cone, v(0.0, 1.0, -3.0), DVec3::Z);
    assert!(through.is_none_or(|t| (t - 3.0).abs() <= 8.0 * UNIT_ROUNDOFF));
}

#[test]
fn caps_are_whole_from_inside_and_absent_from_open_shapes() {
    for (x, z) in [(0.5, 0.25), (0.5, -0.25), (-0.5, 0.25), (-0.5, -0.25), (0.0, 0.0)] {
        for direction in [DVec3::Y, DVec3::NEG_Y] {
            assert_eq!(hit(&cylinder(1.0, 1.0, true), v(x, 0.0, z), direction), Some(1.0));
            assert_eq!(hit(&cylinder(1.0, 1.0, false), v(x, 0.0, z), direction), None);
            assert_eq!(hit(&cylinder(1.0, 1.0, false), v(x, 0.0, z) - direction * 9.0, direction), None);
        }
        assert_eq!(hit(&cone(0.0, true), v(x, 0.25, z), DVec3::NEG_Y), Some(0.25));
        assert_eq!(hit(&cone(0.0, false), v(x, 0.25, z), DVec3::NEG_Y), None);
        assert_eq!(hit(&cone(0.75, true), v(x, 0.25, z), DVec3::Y), Some(0.75));
    }
    // Through the open end onto the inner side.
    let (t, surface) = met(&cylinder(1.0, 1.0, false), v(0.0, 3.0, 0.0), v(1.0, -2.5, 0.0));
    near(t, 1.0, 4.0);
    assert!((surface.point - v(1.0, 0.5, 0.0)).length() <= 8.0 * UNIT_ROUNDOFF);
}

#[test]
fn parts_and_coordinates() {
    let cylinder = cylinder(2.0, 1.0, true);
    let uv = |origin: DVec3, direction: DVec3| {
        let ray = Ray { origin, direction };
        let at = cylinder.intersect_up_to(&TraversalRay::new(ray), f64::INFINITY).expect("a hit");
        (at.part, cylinder.uv_at(cylinder.surface_at(&ray, at).point, at.part))
    };
    assert_eq!(uv(v(9.0, 0.5, 0.0), DVec3::NEG_X), (0, DVec2::new(0.5, 0.75)));
    assert_eq!(uv(v(0.0, -0.5, 9.0), DVec3::NEG_Z), (0, DVec2::new(0.25, 0.25)));
    assert_eq!(uv(v(1.0, 9.0, 1.0), DVec3::NEG_Y), (2, DVec2::new(0.75, 0.25)));
    assert_eq!(uv(v(1.0, -9.0, 1.0), DVec3::Y), (1, DVec2::new(0.75, 0.75)));
    let torus = Torus::new(DVec3::ZERO, DVec3::Y, 1.0, 0.25);
    assert_eq!(torus.uv_at(v(1.25, 0.0, 0.0), 0), DVec2::new(0.5, 0.5));
    assert_eq!(torus.uv_at(v(0.0, 0.25, 1.0), 0), DVec2::new(0.25, 0.75));
}

#[test]
fn int_18_a_torus_along_an_axis() {
    let torus = Torus::new(DVec3::ZERO, DVec3::Z, 1.0, 0.25);
    let across = all(&torus, Ray { origin: v(5.0, 0.0, 0.0), direction: DVec3::NEG_X }, 1e-9);
    let through = all(&torus, Ray { origin: v(0.0, 1.0, 20.0), direction: DVec3::NEG_Z }, 1e-9);
    let same = |found: &[f64], expected: &[f64]| {
        assert_eq!(found.len(), expected.len(), "{found:?}");
        found.iter().zip(expected).for_each(|(&t, &expected)| near(t, expected, 8.0));
    };
    same(&across, &[3.75, 4.25, 5.75, 6.25]);
    same(&through, &[19.75, 20.25]);
    assert_eq!(hit(&torus, v(0.0, 0.0, 20.0), DVec3::NEG_Z), None);
}

/// The signed distance from a torus around the z axis.
fn torus_distance(p: DVec3, major: f64, minor: f64) -> f64 {
    libm::hypot(libm::hypot(p.x, p.y) - major, p.z) - minor
}

/// Where the ray first comes within `resolution` of a torus around the z axis, before `end`. Steps as long as the
/// distance cannot pass through the surface (sphere tracing, Hart 1996).
fn traced(ray: Ray, (major, minor): (f64, f64), resolution: f64, (start, end): (f64, f64)) -> Option<f64> {
    let mut t = start;
    while t < end {
        let distance = torus_distance(ray.at(t), major, minor).abs();
        if distance < resolution {
            return Some(t);
        }
        t += distance;
    }
    None
}

#[test]
fn int_18_tori_from_far_away() {
    let (major, minor) = (1.0, 0.25);
    let torus = Torus::new(DVec3::ZERO, DVec3::Z, major, minor);
    let mut random = Random(18);
    let mut worst = 0.0f64;
    for distance in [5.0, 20.0, 100.0, 1000.0] {
        for _ in 0..3000 {
            let origin = random.direction() * distance;
            let turn = random.direction().with_z(0.0).normalize();
            let aim = turn * major + random.direction() * (0.23 * random.unit());
            let direction = (aim - origin).normalize();
            let ray = Ray { origin, direction };
            let t = hit(&torus, origin, direction).expect("no ray is missed");
            // From a closer origin, so that the reference's own rounding is relative to the size of the torus.
            let shift = distance - 3.0;
            let closer = Ray { origin: ray.at(shift), direction };
            let expected =
                traced(closer, (major, minor), 1e-13, (0.0, 9.0)).expect("the oracle's hit") + shift;
            worst = worst.max((t - expected).abs());
        }
    }
    assert!(worst <= 1e-8, "{worst:e}");
}

/// Random lines, thick and thin tubes, origins outside, in the hole and inside the tube, against sphere tracing.
#[test]
fn tori_equal_sphere_tracing() {
    let mut random = Random(19);
    let mut hits = 0;
    for minor in [0.9, 0.5, 0.25, 0.05, 1e-3] {
        let torus = Torus::new(DVec3::ZERO, DVec3::Z, 1.0, minor);
        for _ in 0..RAYS / 20 {
            let origin = random.point(2.0);
            let turn = random.direction().with_z(0.0).normalize();
            let aim = turn + random.direction() * (1.2 * minor * random.unit());
            let ray = Ray { origin, direction: (aim - origin).normalize() };
            let oracle = traced(ray, (1.0, minor), 1e-12, (0.0, 9.0));
            let found = hit(&torus, ray.origin, ray.direction);
            let Some(expected) = oracle else {
                assert_eq!(found, None, "{minor} {ray:?}");
                continue;
            };
            // At grazing angles, the distance is within 1e-12 over a length of about 1e-6.
            let cosine = slope(ray, expected, minor);
            if cosine > 1e-3 {
                let off = (found.expect("a hit") - expected).abs();
                assert!(off <= 2e-12 / cosine, "{minor} {ray:?}: {off:e}");
                hits += 1;
            }
        }
    }
    assert!(hits > RAYS / 20);
}

/// The rate at which the ray approaches or leaves the torus around the z axis at t.
fn slope(ray: Ray, t: f64, minor: f64) -> f64 {
    let p = ray.at(t);
    let ring = p.with_z(0.0).normalize();
    ((p - ring) / minor).dot(ray.direction).abs()
}

#[test]
fn int_21_extreme_sizes() {
    for (size, distance) in [(1e-20, 1e-18), (1e18, 3e18)] {
        let eye = DVec3::X * distance;
        let cylinder = cylinder(size, size, true);
        let torus = Torus::new(DVec3::ZERO, DVec3::Y, 0.75 * size, 0.25 * size);
        let cone = Cone::new(DVec3::NEG_Y * size, DVec3::Y * size, 2.0 * size, 0.0, true).expect("a cone");
        let relative = |t: Option<f64>| t.expect("a hit") / (distance - size) - 1.0;
        for off in
            [hit(&cylinder, eye, DVec3::NEG_X), hit(&torus, eye, DVec3::NEG_X), hit(&cone, eye, DVec3::NEG_X)]
        {
            assert!(relative(off).abs() <= 1e-9, "{off:?} at {size}");
        }
    }
}

/// The distance of a point from the surface of a cone or cylinder around the y axis from -1 to 1.
fn frustum_distance(p: DVec3, bottom: f64, top: f64) -> f64 {
    let from_axis = libm::hypot(p.x, p.z);
    let lean = 0.5 * (top - bottom);
    let side = (from_axis - 0.5 * (top + bottom) - lean * p.y) / libm::hypot(1.0, lean);
    // The solid is the intersection: the outermost of its three sides counts.
    side.max(p.y.abs() - 1.0)
}

/// Random lines against bisection. Along a line through a convex solid, the distance has one minimum, found by golden
/// section. It crosses zero once on either side.
#[test]
fn cones_and_cylinders_equal_bisection() {
    let mut random = Random(20);
    for (bottom, top) in [(1.0, 1.0), (1.0, 0.0), (1.0, 0.3), (0.2, 1.5), (1e-3, 1e-3), (1.0, 1.0 - 1e-9)] {
        let cone = Cone::new(DVec3::NEG_Y, DVec3::Y, bottom, top, true).expect("a cone");
        let distance = |p: DVec3| frustum_distance(p, bottom, top);
        for _ in 0..RAYS / 20 {
            let origin = random.point(3.0);
            let aim = v(0.0, 2.0 * random.unit() - 1.0, 0.0) + random.point(0.7 * bottom).with_y(0.0);
            let ray = Ray { origin, direction: (aim - origin).normalize() };
            let f = |t: f64| distance(ray.at(t));
            let expected = first_crossing(f);
            let found = hit(&cone, ray.origin, ray.direction);
            let Some(t) = expected else {
                assert!(found.is_none_or(|t| f(t).abs() < 1e-14), "{bottom} {top} {ray:?} {found:?}");
                continue;
            };
            // Except grazing rays, whose depth is below the resolution of the search.
            let Some(found) = found else { panic!("{bottom} {top} {ray:?}: missed at {t}") };
            let off = f(found).abs();
            assert!(off <= 16.0 * UNIT_ROUNDOFF * 6.0, "{bottom} {top} {ray:?}: {off:e}");
            assert!((found - t).abs() < 1e-6, "{bottom} {top} {ray:?}: {found} {t}");
        }
    }
}

/// The first t in 0..9 at which `f`, which has one minimum, crosses zero. None if the minimum is above -1e-9.
fn first_crossing(f: impl Fn(f64) -> f64) -> Option<f64> {
    let (mut low, mut high) = (0.0, 9.0);
    for _ in 0..80 {
        let (a, b) = (low + 0.382 * (high - low), low + 0.618 * (high - low));
        if f(a) < f(b) { high = b } else { low = a }
    }
    if f(low) >= -1e-9 {
        return None;
    }
    let (mut outside, mut inside) = if f(0.0) < 0.0 { (9.0, 0.0) } else { (0.0, low) };
    for _ in 0..70 {
        let middle = 0.5 * (inside + outside);
        if f(middle) < 0.0 { inside = middle } else { outside = middle }
    }
    Some(0.5 * (inside + outside))
}

/// Hits and surface points of cones of any slope are accurate everywhere, also at the tip of a flat cone, where its
/// sides hardly differ. The reference is the quadratic around the tip in twice the precision.
#[test]
fn flat_and_steep_cones_are_hit_where_they_are() {
    let mut random = Random(21);
    for (radius, height) in
        [(1e9, 0.85), (1e9, -0.85), (1e5, 1.0), (30.0, 1.0), (1.0, 1.0), (1e-3, 1.0), (1e-3, 1e6)]
    {
        let tip = v(0.0, height, 0.0);
        let cone = Cone::new(DVec3::ZERO, tip, radius, 0.0, true).expect("a cone");
        let size = radius + height.abs();
        let (mut worst_t, mut worst_point) = (0.0f64, 0.0f64);
        for _ in 0..RAYS / 4 {
            // From just beside the tip, where the cone is wider than its rounding, to the rim; seen from above.
            let least = 1024.0 * UNIT_ROUNDOFF * size / radius;
            let share =
                if random.unit() < 0.5 { least * libm::exp(20.0 * random.unit()) } else { random.unit() };
            let share = share.clamp(least, 0.95);
            let aim = v(radius * share, height * (1.0 - share), 0.0);
            let aim = DAffine3::from_rotation_y(7.0 * random.unit()).transform_point3(aim);
            let origin =
                aim + (random.direction() + v(0.0, height.signum(), 0.0)) * (3.0 + 10.0 * random.unit());
            let ray = Ray { origin, direction: (aim - origin).normalize() };
            let Some(at) = cone.intersect_up_to(&TraversalRay::new(ray), f64::INFINITY) else { continue };
            let surface = cone.surface_at(&ray, at);
            if surface.normal.dot(ray.direction) > -0.1 || surface.normal.y * height.signum() <= 0.0 {
                continue;
            }
            let t = tip_quadratic(ray, tip, radius / height);
            let way = origin.length() + at.t;
            worst_t = worst_t.max((at.t - t).abs() * -surface.normal.dot(ray.direction) / (way + size));
            worst_point = worst_point.max((ray.at(at.t) - surface.point).length() / (way + size));
        }
        let [t, point] = [worst_t, worst_point].map(|worst| worst / UNIT_ROUNDOFF);
        assert!(
            t <= 8.0 && point <= 32.0,
            "radius {radius}, height {height}: t off by {t} u, points by {point} u"
        );
    }
}

/// Where a ray first hits the cone below a tip. The radius grows by `slope` per unit of distance below.
fn tip_quadratic(ray: Ray, tip: DVec3, slope: f64) -> f64 {
    let (o, d) = (Vector::from(ray.origin) - Vector::from(tip), Vector::from(ray.direction));
    let k = Exact::from(slope) * Exact::from(slope);
    let form = |a: Vector, b: Vector| a.0[0] * b.0[0] + a.0[2] * b.0[2] - k * a.0[1] * b.0[1];
    let (a, b, c) = (form(d, d), form(o, d), form(o, o));
    let root = (b * b - a * c).sqrt();
    let far = if b.value() > 0.0 { -(b + root) } else { root - b };
    let roots = [(far / a).value(), (c / far).value()];
    // On the nappe below the tip.
    let below = |t: &f64| (ray.at(*t).y - tip.y) * tip.y <= 0.0 && *t > 0.0;
    roots.into_iter().filter(below).fold(f64::INFINITY, f64::min)
}

/// Turned, mirrored and uniformly scaled shapes stay in their class, and transformed rays hit them at the same points.
#[test]
fn moved_shapes_are_hit_where_they_are() {
    let mut random = Random(21);
    let cone = Cone::new(v(0.1, -0.4, 0.2), v(0.5, 0.7, -0.2), 1.1, 0.4, true).expect("a cone");
    let torus = Torus::new(v(0.3, -0.2, 0.1), v(0.48, 0.6, 0.64), 1.2, 0.4);
    for _ in 0..RAYS / 40 {
        let affine = DAffine3::from_translation(random.point(5.0))
            * DAffine3::from_axis_angle(random.direction(), 7.0 * random.unit())
            * DAffine3::from_scale(v(-0.7, 0.7, 0.7));
        let origin = random.point(4.0);
        let ray = Ray { origin, direction: random.point(1.0) - origin };
        moved_alike(&cone, &affine, ray);
        moved_alike(&torus, &affine, ray);
    }
    assert_eq!(cone.transformed(&DAffine3::from_scale(v(1.0, 1.0, 1.001))), None);
    assert_eq!(torus.transformed(&DAffine3::from_scale(v(1.0, 1.001, 1.0))), None);
}

fn moved_alike(shape: &impl Geometric, affine: &DAffine3, ray: Ray) {
    let moved = shape.transformed(affine).expect("stays in its class");
    let there = Ray {
        origin: affine.transform_point3(ray.origin),
        direction: affine.transform_vector3(ray.direction),
    };
    let here = shape.intersect_up_to(&TraversalRay::new(ray), f64::INFINITY);
    let hit = moved.intersect_up_to(&TraversalRay::new(there), f64::INFINITY);
    let (Some(a), Some(b)) = (here, hit) else {
        assert_eq!(here.is_some(), hit.is_some(), "{ray:?}");
        return;
    };
    let (a_surface, b_surface) = (shape.surface_at(&ray, a), moved.surface_at(&there, b));
    let cosine = a_surface.normal.dot(ray.direction.normalize()).abs();
    assert!((a.t - b.t).abs() <= 1e-13 / cosine && a.part == b.part, "{ray:?} {a:?} {b:?}");
    let normal = DMat3::from_cols(affine.x_axis, affine.y_axis, affine.z_axis) / 0.7 * a_surface.normal;
    assert!((normal - b_surface.normal).length() <= 1e-13 / cosine, "outwards, mirrored or not");
    let back = affine.inverse().transform_point3(b_surface.point);
    assert!((shape.uv_at(back, a.part) - shape.uv_at(a_surface.point, a.part)).length() <= 1e-12 / cosine);
    let bounds = moved.bounds().expect("finite");
    assert!(bounds.min.cmple(b_surface.point).all() && b_surface.point.cmple(bounds.max).all());
}

/// Samples come close to each side of the bounds.
#[test]
fn bounds_are_tight() {
    let axis = v(0.2, 0.9, -0.4).normalize();
    let center = v(3.0, -2.0, 7.0);
    tight(&Torus::new(center, axis, 2.0, 0.5));
    tight(&Cylinder::new(center, center + axis * 3.0, 0.7, true).expect("a cylinder"));
    tight(&Cone::new(center, center + axis * 3.0, 0.7, 0.0, true).expect("a cone"));
}

fn tight(shape: &impl Geometric) {
    let bounds = shape.bounds().expect("finite");
    let mut random = Random(22);
    let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for _ in 0..40_000 {
        let point: DVec3 = shape.sample_area(random.unit(), random.unit()).0.point.into();
        (min, max) = (min.min(point), max.max(point));
    }
    assert!(bounds.min.cmple(min).all() && max.cmple(bounds.max).all());
    let slack = (min - bounds.min).max(bounds.max - max).max_element();
    assert!(slack < 0.05, "{slack}");
}

/// Samples lie on the surface, and their density is uniform: the fractions of samples on each part and above a height
/// are known.
#[test]
fn samples_are_even_over_the_area() {
    let mut random = Random(23);
    let frustum = Cone::new(DVec3::NEG_Y, DVec3::Y, 1.0, 0.4, true).expect("a cone");
    let (mut side, mut above, mut top) = (0, 0, 0);
    let mut outer = 0;
    let torus = Torus::new(DVec3::ZERO, DVec3::Z, 1.0, 0.5);
    for _ in 0..100_000 {
        let (u, v) = (random.unit(), random.unit());
        let sample = Surface::from(frustum.sample_area(u, v).0);
        assert!(frustum_distance(sample.point, 1.0, 0.4).abs() <= 8.0 * UNIT_ROUNDOFF);
        let on_side = sample.normal.y.abs() < 0.9;
        side += u32::from(on_side);
        above += u32::from(on_side && sample.point.y > 0.0);
        top += u32::from(sample.normal.y > 0.9);
        let sample = Surface::from(torus.sample_area(u, v).0);
        assert!(torus_distance(sample.point, 1.0, 0.5).abs() <= 16.0 * UNIT_ROUNDOFF);
        outer += u32::from(libm::hypot(sample.point.x, sample.point.y) > 1.0);
    }
    let slant = libm::hypot(2.0, 0.6);
    let pi = std::f64::consts::PI;
    let area = pi * 1.4 * slant + pi * 1.16;
    assert!((frustum.area().expect("known") - area).abs() < 1e-14 * area);
    let close = |count: u32, share: f64| {
        let found = f64::from(count) / 100_000.0;
        assert!((found - share).abs() < 0.006, "{found} instead of {share}");
    };
    close(side, pi * 1.4 * slant / area);
    close(above, pi * 1.1 * 0.5 * slant / area);
    close(top, pi * 0.16 / area);
    // The outer half of the tube: (π/2 + r/R) / π of the area.
    close(outer, 0.5 + 0.5 / pi);
}

/// Surfaces are only requested at hits, but they are finite for any argument.
#[test]
fn surfaces_are_finite_everywhere() {
    let ray = Ray { origin: v(0.0, 5.0, 0.0), direction: DVec3::NEG_Y };
    for part in 0..3 {
        for t in [3.0, 4.0, 5.0, 6.0] {
            let at = ShapeHit::of_part(t, part);
            let needle = Cone::new(DVec3::ZERO, v(0.0, 1e6, 0.0), 1e-12, 0.0, true).expect("a cone");
            for surface in [cone(0.0, true).surface_at(&ray, at), needle.surface_at(&ray, at)] {
                assert!(
                    surface.point.is_finite() && surface.error.is_finite() && surface.normal.is_normalized()
                );
            }
        }
    }
    let torus = Torus::new(DVec3::ZERO, DVec3::Y, 1.0, 0.5);
    assert!(torus.surface_at(&ray, ShapeHit::at(5.0)).point.is_finite());
}
