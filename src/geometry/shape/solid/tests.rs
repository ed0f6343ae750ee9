use super::solid_rays::SolidRays;
use super::*;
use crate::base::math::Ray;
use crate::geometry::bvh::TraversalRay;
use crate::geometry::mesh::{MeshData, Normals, TriangleMesh, generate};
use crate::geometry::shape::{
    Cuboid, Cylinder, OneRay, Particles, PreparedRay, Rectangle, ShapeHit, Sphere, Torus,
};
use crate::testing::Random;
use std::sync::Arc;

/// Rays per sweep; the ignored test traces more.
const RAYS: u32 = 20_000;

fn sphere(center: DVec3, radius: f64) -> Shape {
    Shape::Sphere(Sphere { center, radius })
}

fn cube(min: [f64; 3], max: [f64; 3]) -> Shape {
    Shape::Cuboid(Cuboid { min: min.into(), max: max.into() })
}

fn plane(point: DVec3, normal: DVec3) -> Plane {
    Plane { point, normal: normal.normalize() }
}

/// Each hit along a ray: its t, and whether the ray enters there.
fn hits(solid: &Solid, origin: DVec3, direction: DVec3) -> Vec<(f64, bool)> {
    let ray = Ray { origin, direction };
    let enters = |at: &ShapeHit| solid.surface_at(&ray, *at).normal.dot(direction) < 0.0;
    let prepared = PreparedRay::<f64>::splat(&TraversalRay::new(ray));
    let found = solid.hits(&SolidRays::new(&prepared), true);
    found.of(0).iter().map(|at| (at.t, enters(at))).collect()
}

/// A mesh of several boxes; those from `turned` on are wound inwards.
fn boxes(corners: &[([f64; 3], [f64; 3])], turned: usize) -> Shape {
    let mut data = MeshData::default();
    for (number, (min, max)) in corners.iter().enumerate() {
        let first = data.positions.len() as u32;
        let corner =
            |at: u32| DVec3::from_array([0, 1, 2].map(|axis| [min, max][(at >> axis) as usize & 1][axis]));
        data.positions.extend((0..8).map(corner));
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let halves = faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
        let wound = halves.map(|[a, b, c]| if number < turned { [a, b, c] } else { [a, c, b] });
        data.triangles.extend(wound.map(|corners: [u32; 3]| corners.map(|corner| first + corner)));
    }
    Shape::Mesh(Mesh::new(Arc::new(TriangleMesh::new(data).expect("a mesh")), Normals::Flat))
}

fn icosphere() -> Shape {
    let mesh = TriangleMesh::new(generate::icosphere(2)).expect("a mesh");
    Shape::Mesh(Mesh::new(Arc::new(mesh), Normals::Smooth))
}

fn hard_cases() -> Vec<Solid> {
    let ball = sphere(DVec3::ZERO, 1.0);
    let block = cube([-1.0; 3], [1.0; 3]);
    let rod = Shape::Cylinder(Cylinder::new(DVec3::NEG_Y, DVec3::Y, 0.5, true).expect("a length"));
    vec![
        Solid::cut(&ball, [plane(DVec3::ZERO, DVec3::X)]),
        // Three planes through one corner, and two of them through an edge of the block.
        Solid::cut(
            &block,
            [plane(DVec3::ZERO, DVec3::X), plane(DVec3::ZERO, DVec3::Y), plane(DVec3::ZERO, DVec3::Z)],
        ),
        Solid::cut(
            &block,
            [plane(DVec3::ONE, DVec3::new(1.0, 1.0, 0.0)), plane(DVec3::X, DVec3::new(1.0, -1.0, 0.0))],
        ),
        Solid::cut(
            &Shape::Torus(Torus::new(DVec3::ZERO, DVec3::Y, 0.7, 0.3)),
            [plane(DVec3::ZERO, DVec3::ONE)],
        ),
        // Ends of the rod lie in faces of the block.
        Solid::new(Operation::Difference, vec![block.clone(), rod.clone()]),
        Solid::new(Operation::Union, vec![block.clone(), rod]),
        // A face of one lies in a face of the other, and half of it is shared.
        Solid::new(
            Operation::Union,
            vec![cube([-1.0; 3], [0.0, 1.0, 1.0]), cube([0.0, -1.0, -1.0], [1.0, 0.5, 1.0])],
        ),
        Solid::new(Operation::Difference, vec![block.clone(), cube([0.0, 0.0, -1.0], [1.0; 3])]),
        // Spheres that touch from outside, and from inside.
        Solid::new(Operation::Union, vec![sphere(DVec3::X * -0.5, 0.5), sphere(DVec3::X * 0.5, 0.5)]),
        Solid::new(Operation::Difference, vec![ball.clone(), sphere(DVec3::X * 0.5, 0.5)]),
        Solid::new(Operation::Intersection, vec![block.clone(), sphere(DVec3::ZERO, 1.2)]),
        // Meshes: rays meet their corners, edges and diagonals. Shells overlap, and one leaves a hollow.
        Solid::cut(&boxes(&[([-1.0; 3], [1.0; 3])], 1), [plane(DVec3::ZERO, DVec3::X)]),
        Solid::cut(
            &boxes(&[([-1.0; 3], [0.5; 3]), ([-0.5; 3], [1.0; 3])], 2),
            [plane(DVec3::ZERO, DVec3::X)],
        ),
        Solid::cut(
            &boxes(&[([-1.0; 3], [1.0; 3]), ([-0.5; 3], [0.5; 3])], 1),
            [plane(DVec3::ZERO, DVec3::X)],
        ),
        // Spheres that overlap, that touch, and one within another.
        Solid::cut(
            &Shape::Particles(Particles::still(
                [(0.0, 0.6), (0.5, 0.4), (-0.9, 0.3), (0.1, 0.2)]
                    .map(|(x, radius)| Sphere { center: DVec3::X * x, radius })
                    .to_vec(),
            )),
            [plane(DVec3::ZERO, DVec3::Y)],
        ),
        Solid::cut(&icosphere(), [plane(DVec3::ZERO, DVec3::X), plane(DVec3::ZERO, DVec3::ONE)]),
        Solid::new(Operation::Difference, vec![block, icosphere()]),
    ]
}

/// A ray from outside, to points of edges and corners among others.
fn ray(random: &mut Random) -> Ray {
    let target = match (random.unit() * 4.0) as u32 {
        0 => (random.point(1.5) * 2.0).round() * 0.5,
        1 => DVec3::new(random.unit() - 0.5, 0.0, 0.0),
        _ => random.point(1.0),
    };
    let direction = match (random.unit() * 4.0) as u32 {
        0 => DVec3::X,
        1 => DVec3::new(1.0, -1.0, 0.0),
        _ => random.direction(),
    };
    Ray { origin: target - direction * 5.0, direction }
}

/// Every ray leaves as often as it enters, in turn, and at last. Half of the rays begin outside, others anywhere.
fn count_leaks(solid: &Solid, rays: u32) -> usize {
    let mut random = Random(7);
    let leaks = |number: &u32| {
        let Ray { mut origin, direction } = ray(&mut random);
        let begins_outside = number.is_multiple_of(2);
        if !begins_outside {
            origin += direction * (5.0 - (random.unit() * 5.0).round() * 0.25);
        }
        let turns = hits(solid, origin, direction);
        let alternate =
            turns.iter().rev().enumerate().all(|(number, (_, enters))| *enters == (number % 2 == 1));
        !alternate || begins_outside && !turns.len().is_multiple_of(2)
    };
    (0..rays).filter(leaks).count()
}

#[test]
fn rays_enter_and_leave_in_turn() {
    for (number, solid) in hard_cases().iter().enumerate() {
        assert_eq!(count_leaks(solid, RAYS), 0, "case {number}");
    }
}

#[test]
#[ignore = "takes ten seconds; cargo test --release --lib none_of_a_million_rays_leaks -- --ignored"]
fn none_of_a_million_rays_leaks() {
    for (number, solid) in hard_cases().iter().enumerate() {
        assert_eq!(count_leaks(solid, 1_000_000), 0, "case {number}");
    }
}

#[test]
fn hits_agree_with_the_points_inside() {
    let (center, radius) = (DVec3::new(0.3, 0.2, 0.1), 0.9);
    let parts = || vec![cube([-1.0; 3], [1.0; 3]), sphere(center, radius)];
    let mut random = Random(3);
    for operation in [Operation::Difference, Operation::Intersection, Operation::Union] {
        let solid = Solid::new(operation, parts());
        for _ in 0..RAYS {
            let Ray { origin, direction } = ray(&mut random);
            let (t, turns) = (random.unit() * 10.0, hits(&solid, origin, direction));
            let point = origin + direction * t;
            let in_cube = point.abs().max_element() - 1.0;
            let in_ball = (point - center).length() - radius;
            if in_cube.abs().min(in_ball.abs()) < 1e-9 {
                continue;
            }
            let (a, b) = (in_cube < 0.0, in_ball < 0.0);
            let expected = match operation {
                Operation::Difference => a && !b,
                Operation::Intersection => a && b,
                Operation::Union => a || b,
            };
            let crossed = turns.iter().filter(|(at, _)| *at < t).count();
            assert_eq!(crossed % 2 == 1, expected, "{operation:?} {point}");
        }
    }
}

/// Where shells overlap, whichever way they are wound, the mesh is one solid, and a shell in another wound against it
/// leaves a hollow.
#[test]
fn cut_meshes_are_solid_where_their_shells_are() {
    let right = plane(DVec3::Y * 0.25, DVec3::Y);
    let along = |mesh: &Shape| {
        let solid = Solid::cut(mesh, [right]);
        hits(&solid, DVec3::new(-5.0, 0.1, 0.2), DVec3::X).into_iter().map(|(t, _)| t).collect::<Vec<_>>()
    };
    let down = |mesh: &Shape| {
        let solid = Solid::cut(mesh, [right]);
        hits(&solid, DVec3::new(0.1, 5.0, 0.2), DVec3::NEG_Y).into_iter().map(|(t, _)| t).collect::<Vec<_>>()
    };
    let overlapping = [([-1.0; 3], [0.5; 3]), ([-0.5; 3], [1.0; 3])];
    let nested = [([-1.0; 3], [1.0; 3]), ([-0.5; 3], [0.5; 3])];
    for turned in [0, 2] {
        assert_eq!(along(&boxes(&overlapping, turned)), [4.0, 6.0]);
        assert_eq!(down(&boxes(&overlapping, turned)), [4.75, 6.0]);
        assert_eq!(along(&boxes(&nested, turned)), [4.0, 6.0]);
    }
    assert_eq!(along(&boxes(&nested, 1)), [4.0, 4.5, 5.5, 6.0]);
    assert_eq!(down(&boxes(&nested, 1)), [5.5, 6.0]);
}

#[test]
fn faces_that_coincide_leave_no_sheet() {
    // Taken away is exactly one half, so that three of its faces lie in faces of the block.
    let solid =
        Solid::new(Operation::Difference, vec![cube([-1.0; 3], [1.0; 3]), cube([0.0, -1.0, -1.0], [1.0; 3])]);
    assert_eq!(hits(&solid, DVec3::new(5.0, 0.2, 0.3), DVec3::NEG_X), [(5.0, true), (6.0, false)]);
    assert_eq!(hits(&solid, DVec3::new(0.5, 5.0, 0.3), DVec3::NEG_Y).len(), 0);
    // Glued together, the face between two blocks vanishes.
    let glued = Solid::new(
        Operation::Union,
        vec![cube([-1.0; 3], [0.0, 1.0, 1.0]), cube([0.0, -1.0, -1.0], [1.0; 3])],
    );
    assert_eq!(hits(&glued, DVec3::new(5.0, 0.2, 0.3), DVec3::NEG_X), [(4.0, true), (6.0, false)]);
}

#[test]
fn cuts_show_caps_of_solids_only() {
    let half = Solid::cut(&sphere(DVec3::ZERO, 1.0), [plane(DVec3::ZERO, DVec3::X)]);
    let ray = Ray { origin: DVec3::new(5.0, 0.5, 0.0), direction: DVec3::NEG_X };
    let at = half.intersect_up_to(&TraversalRay::new(ray), f64::INFINITY).expect("a hit");
    assert_eq!((at.t, half.is_cap(at.part)), (5.0, true));
    assert_eq!(half.surface_at(&ray, at).normal, DVec3::X);
    // From inside, the ray leaves through the cap.
    assert_eq!(hits(&half, DVec3::new(-0.5, 0.0, 0.0), DVec3::X), [(0.5, false)]);
    let sheet = Shape::Rectangle(Rectangle {
        corner: DVec3::new(-1.0, 0.0, -1.0),
        u: DVec3::X * 2.0,
        v: DVec3::Z * 2.0,
    });
    let sheet = Solid::cut(&sheet, [plane(DVec3::ZERO, DVec3::X)]);
    assert_eq!(hits(&sheet, DVec3::new(0.5, 1.0, 0.0), DVec3::NEG_Y).len(), 0);
    assert_eq!(hits(&sheet, DVec3::new(-0.5, 1.0, 0.0), DVec3::NEG_Y).len(), 1);
    assert_eq!(hits(&sheet, DVec3::new(5.0, 0.0, 0.5), DVec3::NEG_X).len(), 0);
}
