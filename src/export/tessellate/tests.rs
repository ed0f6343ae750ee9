//! Tests of meshes against the shapes that they stand for.

use super::*;
use crate::base::math::{Ray, UNIT_ROUNDOFF};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::{Cone, Cylinder, OneRay, Plane, Triangle};
use crate::testing::Random;
use std::collections::HashMap;

const TOLERANCE: f64 = 0.01;

/// The distance of a point from a surface.
type Distance = Box<dyn Fn(DVec3) -> f64>;

/// Closed shapes with the radius that the tolerance refers to, and the distance from their surface.
fn solids() -> Vec<(Shape, f64, Distance)> {
    let center = DVec3::new(0.3, -2.0, 1.5);
    let axis = DVec3::new(0.48, 0.6, 0.64);
    let along = move |point: DVec3| {
        let from = point - center;
        let height = from.dot(axis);
        ((from - axis * height).length(), height)
    };
    let sphere = Sphere { center, radius: 2.5 };
    let torus = Torus::new(center, axis, 3.0, 0.5);
    let cylinder = Cylinder::new(center, center + axis * 2.0, 0.7, true).expect("a cylinder");
    let cone = Cone::new(center, center + axis * 2.0, 1.5, 0.0, true).expect("a cone");
    // The distance from a convex solid of revolution, at points inside or on it.
    let inside = |distances: [f64; 3]| distances.into_iter().fold(f64::INFINITY, f64::min).abs();
    vec![
        (Shape::Sphere(sphere), 2.5, Box::new(move |p| ((p - center).length() - 2.5).abs())),
        (
            Shape::Torus(torus),
            0.5,
            Box::new(move |p| (libm::hypot(along(p).0 - 3.0, along(p).1) - 0.5).abs()),
        ),
        (
            Shape::Cylinder(cylinder),
            0.7,
            Box::new(move |p| inside([0.7 - along(p).0, along(p).1, 2.0 - along(p).1])),
        ),
        (
            Shape::Cone(cone),
            1.5,
            Box::new(move |p| {
                let (r, h) = along(p);
                inside([(1.5 * (1.0 - 0.5 * h) - r) * 0.8, h, f64::INFINITY])
            }),
        ),
    ]
}

#[test]
fn round_shapes_stay_within_the_tolerance() {
    let mut random = Random(5);
    for (shape, radius, distance) in solids() {
        let mesh = tessellated(&shape, TOLERANCE, 1.0).expect("a mesh");
        let mut worst = 0.0f64;
        for corners in mesh.groups.iter().flat_map(|(_, triangles)| triangles) {
            let corners = corners.map(|index| mesh.vertices[index as usize].position);
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            let edge = corners[0].lerp(corners[1], random.unit());
            for point in [middle, edge, corners[1].lerp(corners[2], 0.5), corners[2].lerp(corners[0], 0.5)] {
                worst = worst.max(distance(point));
            }
        }
        assert!(worst <= TOLERANCE * radius * (1.0 + 1e-9), "{shape:?}: {}", worst / radius);
        // The tolerance is used, not undercut by far.
        assert!(worst >= 0.3 * TOLERANCE * radius, "{shape:?}: {}", worst / radius);
    }
}

#[test]
fn corners_are_those_of_the_shape() {
    let shapes = solids().into_iter().map(|(shape, ..)| shape);
    let more = [
        Shape::Cuboid(Cuboid { min: DVec3::new(-1.0, 0.5, 2.0), max: DVec3::new(3.0, 1.0, 2.5) }),
        Shape::Disk(Disk { center: DVec3::ONE, normal: DVec3::new(0.0, 0.6, 0.8), radius: 2.0 }),
        Shape::Rectangle(Rectangle { corner: DVec3::ONE, u: DVec3::X * 2.0, v: DVec3::new(0.5, 1.0, 0.0) }),
    ];
    for shape in shapes.chain(more) {
        let mesh = tessellated(&shape, TOLERANCE, 1.0).expect("a mesh");
        for vertex in &mesh.vertices {
            assert!((vertex.normal.length() - 1.0).abs() < 8.0 * UNIT_ROUNDOFF);
        }
        let part_of = |center: DVec3, normal: DVec3| {
            let ray = Ray { origin: center + normal * 0.05, direction: -normal };
            shape.intersect_up_to(&TraversalRay::new(ray), f64::INFINITY)
        };
        for corners in mesh.groups.iter().flat_map(|(_, triangles)| triangles) {
            let [a, b, c] = corners.map(|index| mesh.vertices[index as usize]);
            let face = (b.position - a.position).cross(c.position - a.position);
            assert!(face.dot(a.normal + b.normal + c.normal) > 0.0, "{shape:?}");
            let (center, normal) = ((a.position + b.position + c.position) / 3.0, face.normalize());
            let Some(hit) = part_of(center, normal) else { continue };
            let part: u32 = hit.part;
            let uv = DVec2::from_array(shape.uv::<f64>((center + normal * (0.05 - hit.t)).into(), part));
            let expected = (a.uv + b.uv + c.uv) / 3.0;
            assert!((uv - expected).length() < 0.03, "{shape:?}: {uv} {expected}");
        }
    }
}

#[test]
fn closed_shapes_have_no_gaps() {
    for (shape, ..) in solids() {
        let mesh = tessellated(&shape, 0.05, 1.0).expect("a mesh");
        let mut edges: HashMap<[[i64; 3]; 2], i32> = HashMap::new();
        // Seams have two vertices at one place, up to rounding.
        let place =
            |index: u32| mesh.vertices[index as usize].position.to_array().map(|x| (x * 1e9).round() as i64);
        for triangle in mesh.groups.iter().flat_map(|(_, triangles)| triangles) {
            for (from, to) in [(0, 1), (1, 2), (2, 0)] {
                let (a, b) = (place(triangle[from]), place(triangle[to]));
                let (key, sign) = if a < b { ([a, b], 1) } else { ([b, a], -1) };
                *edges.entry(key).or_default() += sign;
            }
        }
        assert!(edges.values().all(|count| *count == 0), "{shape:?}");
    }
}

#[test]
fn triangles_and_planes_are_as_large_as_they_are() {
    let triangle = Triangle { corners: [DVec3::ZERO, DVec3::X, DVec3::Y] };
    let mesh = tessellated(&Shape::Triangle(triangle), TOLERANCE, 1.0).expect("a mesh");
    assert_eq!(mesh.vertices[2].position, DVec3::Y);
    let plane = Plane { point: DVec3::ONE, normal: DVec3::Y };
    let mesh = tessellated(&Shape::Plane(plane), TOLERANCE, 10.0).expect("a mesh");
    let corner = &mesh.vertices[0];
    assert_eq!((corner.position, corner.uv), (DVec3::new(-9.0, 1.0, 11.0), DVec2::new(-10.0, -10.0)));
    assert_eq!(tessellated(&Shape::Group, TOLERANCE, 1.0), None);
}
