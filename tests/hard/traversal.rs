//! What trees may not lose. BVH-05 stands in `tests/integration/determinism.rs`, the closed forms of BVH-07 in
//! `tests/integration/radiance.rs`.

use crate::support::{Random, direction, few, geometry, placed, scan};
use kinora::appearance::material::MaterialBinding;
use kinora::base::math::{DAffine3, DVec3, Ray};
use kinora::geometry::bvh::TraversalRay;
use kinora::geometry::mesh::{self, MeshData, Normals, generate};
use kinora::geometry::shape::{Cuboid, Cylinder, Mesh, Rectangle, Shape, Sphere, Triangle};
use kinora::scene::top_level::Bvh;
use kinora::scene::{Finish, Geometry};
use rayon::prelude::*;
use std::sync::Arc;

/// Rays in the faces, edges and corners of a box, with zeros of both signs: 0 · ∞ is no number, and `min` and `max` of
/// it lose 32 of 36.
#[test]
fn bvh_01_rays_in_the_faces_of_a_box() {
    let cuboid = Shape::Cuboid(Cuboid { min: DVec3::ZERO, max: DVec3::ONE });
    let mesh = Shape::Mesh(Mesh {
        mesh: Arc::new(mesh::TriangleMesh::new(cube()).expect("a mesh")),
        normals: Normals::Flat,
    });
    for (shape, axis) in
        [cuboid, mesh].into_iter().flat_map(|shape| [0, 1, 2].map(|axis| (shape.clone(), axis)))
    {
        let geometry = geometry([shape]);
        let bvh = Bvh::build(&geometry);
        for (x, y) in [0.0, 0.5, 1.0].into_iter().flat_map(|x| [0.0, 0.5, 1.0].map(|y| (x, y))) {
            for (dx, dy) in [(0.0, 0.0), (-0.0, 0.0), (0.0, -0.0), (-0.0, -0.0)] {
                let turn = |a: f64, b: f64, c: f64| {
                    let mut v = DVec3::ZERO;
                    (v[axis], v[(axis + 1) % 3], v[(axis + 2) % 3]) = (a, b, c);
                    v
                };
                for along in [1.0, -1.0] {
                    let origin = turn(0.5 - 1.5 * along, x, y);
                    let probe = TraversalRay::new(Ray { origin, direction: turn(along, dx, dy) });
                    let hit = bvh.intersect_one(&geometry, &probe);
                    assert_eq!(hit.map(|hit| hit.at.t), Some(1.0), "{probe:?}");
                    assert!(bvh.occludes_one(&geometry, &probe, 2.0), "{probe:?}");
                }
            }
        }
    }
}

/// The unit cube as twelve triangles.
fn cube() -> MeshData {
    let positions =
        (0..8u32).map(|i| DVec3::from_array([0, 1, 2].map(|axis| f64::from(i >> axis & 1)))).collect();
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    MeshData { positions, triangles, ..MeshData::default() }
}

/// Flat leaves, met at their edges from afar: slabs whose far side is not widened by their rounding lose 3 %.
fn flat_leaves(count: u32) {
    (0..count.div_ceil(1000)).into_par_iter().for_each(|batch| {
        let mut random = Random(u64::from(batch));
        let mut rectangles = Vec::new();
        for _ in 0..1000 {
            let corner = (random.point(5.0) + 5.0).max(DVec3::ZERO);
            let axis = (3.0 * random.unit()) as usize % 3;
            let (mut u, mut v) = (DVec3::ZERO, DVec3::ZERO);
            (u[axis], v[(axis + 1) % 3]) = (random.unit() + 1e-9, random.unit() + 1e-9);
            rectangles.push(Rectangle { corner, u, v });
        }
        let geometry = geometry(rectangles.iter().map(|rectangle| Shape::Rectangle(*rectangle)));
        let bvh = Bvh::build(&geometry);
        for (index, &Rectangle { corner, u, v }) in (0..).zip(&rectangles) {
            let origin = random.point(100.0);
            let on_edge = random.unit() < 0.5;
            let aim =
                corner + u * if on_edge { random.unit().round() } else { random.unit() } + v * random.unit();
            let probe = TraversalRay::new(Ray { origin, direction: aim - origin });
            let Some(at) = geometry.primitives[index as usize].intersect_up_to(&probe, f64::INFINITY) else {
                continue;
            };
            let found = bvh.intersect_one(&geometry, &probe).expect("its leaf is entered");
            assert!(found.primitive == index || found.at.t <= at.t, "{probe:?}: {found:?} before {at:?}");
            assert!(bvh.occludes_one(&geometry, &probe, at.t.next_up()));
        }
    });
}

#[test]
fn bvh_02_flat_leaves_are_not_lost() {
    flat_leaves(few(2_000_000));
}

#[test]
#[ignore = "takes seconds: all rectangles of BVH-02; cargo test --release -- --ignored bvh_02"]
fn bvh_02_flat_leaves_are_not_lost_in_full() {
    flat_leaves(2_000_000);
}

/// Rays for a scene in the cube from -1 to 1, half of them along an axis or through one of its vertices.
fn rays(seed: u64, count: u32, vertices: &[DVec3]) -> Vec<TraversalRay> {
    let mut random = Random(seed);
    let ray = |k: u32| {
        let origin = random.point(2.0);
        let vertex = vertices[(random.unit() * vertices.len() as f64) as usize];
        let (origin, direction) = match k % 4 {
            0 => {
                let mut axis = DVec3::ZERO;
                axis[(3.0 * random.unit()) as usize % 3] = if random.unit() < 0.5 { 1.0 } else { -1.0 };
                (vertex - axis * 3.0, axis)
            }
            1 => (origin, vertex - origin),
            _ => (origin, random.point(1.0) - origin),
        };
        TraversalRay::new(Ray { origin, direction })
    };
    (0..count).map(ray).filter(|probe| probe.ray.direction != DVec3::ZERO).collect()
}

/// A mesh alone in its own tree against its triangles one by one.
fn mesh_equals_scan(parts: MeshData, seed: u64, count: u32) {
    let triangles: Vec<_> = parts
        .triangles
        .iter()
        .map(|t| Triangle { corners: t.map(|vertex| parts.positions[vertex as usize]) })
        .collect();
    let each = geometry(triangles.into_iter().map(Shape::Triangle));
    let probes = rays(seed, count, &parts.positions);
    let mesh =
        Mesh { mesh: Arc::new(mesh::TriangleMesh::new(parts).expect("a mesh")), normals: Normals::Flat };
    let whole = geometry([Shape::Mesh(mesh)]);
    let (bvh, loose) = (Bvh::build(&whole), Bvh::build(&each));
    let met = probes.par_iter().filter(|probe| {
        let expected = scan(&each, &loose, probe);
        assert_eq!(loose.intersect_one(&each, probe), expected, "{probe:?}");
        let found = bvh.intersect_one(&whole, probe).map(|hit| (hit.at.t, hit.at.part));
        assert_eq!(found, expected.map(|hit| (hit.at.t, hit.primitive)), "{probe:?}");
        found.is_some()
    });
    assert!(met.count() > probes.len() / 20);
}

fn trees_equal_scans(count: u32) {
    // A tree is built anew when things move: as they stand, and after a step of an animation.
    for step in [0.0, 1.0] {
        let moved = |mut parts: MeshData| {
            let turn = DAffine3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.1 * step);
            parts
                .positions
                .iter_mut()
                .for_each(|p| *p = turn.transform_point3(*p) + DVec3::X * (0.01 * step));
            parts
        };
        mesh_equals_scan(moved(generate::icosphere(5)), 1, count);
        mesh_equals_scan(moved(soup(10_000)), 2, count);
        mesh_equals_scan(moved(grid(40)), 3, count);
        let mut random = Random(4);
        let mut geometry = Geometry::default();
        let mut middles = Vec::new();
        for k in 0..200 {
            let p = random.point(1.0);
            let shape = if k % 2 == 0 {
                Shape::Sphere(Sphere { center: p, radius: 0.02 + 0.1 * random.unit() })
            } else {
                let to = p + random.point(0.3);
                Shape::Cylinder(
                    Cylinder::new(p, to, 0.02 + 0.1 * random.unit(), k % 4 == 1).expect("a length"),
                )
            };
            let turn = DAffine3::from_axis_angle(direction(&mut random), 0.1 * step);
            geometry.push(&shape, turn, Finish::Material(MaterialBinding::One(0)));
            middles.push(p);
        }
        let bvh = Bvh::build(&geometry);
        rays(5, count, &middles).par_iter().for_each(|probe| {
            assert_eq!(bvh.intersect_one(&geometry, probe), scan(&geometry, &bvh, probe), "{probe:?}");
        });
    }
}

/// Small triangles all over a cube.
fn soup(count: u32) -> MeshData {
    let mut random = Random(8);
    let corners = (0..count).flat_map(|_| {
        let p = random.point(1.0);
        [p, p + random.point(0.1), p + random.point(0.1)]
    });
    let positions: Vec<_> = corners.collect();
    MeshData {
        positions,
        triangles: (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect(),
        ..MeshData::default()
    }
}

/// Squares side by side in a plane across y.
fn grid(side: u32) -> MeshData {
    let at = |i: u32| f64::from(i) / f64::from(side) * 2.0 - 1.0;
    let row = side + 1;
    let positions = (0..row * row).map(|k| DVec3::new(at(k % row), 0.0, at(k / row))).collect();
    let triangles = (0..side * side).flat_map(|k| {
        let a = k / side * row + k % side;
        [[a, a + 1, a + row], [a + 1, a + row + 1, a + row]]
    });
    MeshData { positions, triangles: triangles.collect(), ..MeshData::default() }
}

#[test]
fn bvh_03_trees_equal_linear_scans() {
    trees_equal_scans(if cfg!(debug_assertions) { 20 } else { 500 });
}

#[test]
#[ignore = "takes a minute: all rays of BVH-03; cargo test --release -- --ignored bvh_03"]
fn bvh_03_trees_equal_linear_scans_in_full() {
    trees_equal_scans(125_000);
}

/// Whether anything lies before t_max is whether the nearest does.
#[test]
fn bvh_07_any_hit_is_the_nearest_hit_before_its_end() {
    let mut random = Random(9);
    let spheres = (0..60).map(|_| Shape::Sphere(Sphere { center: random.point(1.0), radius: 0.1 }));
    let mesh =
        Mesh { mesh: Arc::new(mesh::TriangleMesh::new(soup(500)).expect("a mesh")), normals: Normals::Flat };
    let geometry = geometry(spheres.collect::<Vec<_>>().into_iter().chain([Shape::Mesh(mesh)]));
    let bvh = Bvh::build(&geometry);
    for probe in rays(6, few(1_000_000), &[DVec3::ZERO, DVec3::ONE]) {
        let nearest = bvh.intersect_one(&geometry, &probe).map(|hit| hit.at.t);
        let t = nearest.unwrap_or(1.0);
        for t_max in [3.0 * random.unit(), t, t.next_up(), t.next_down(), f64::INFINITY] {
            let before = nearest.is_some_and(|t| t < t_max);
            assert_eq!(bvh.occludes_one(&geometry, &probe, t_max), before, "{probe:?} {t_max}");
        }
    }
    // An occluder 10^5 away, for light from infinitely far.
    let far = placed(&Shape::Sphere(Sphere { center: DVec3::Y * 1e5, radius: 1.0 }), DAffine3::IDENTITY);
    assert!(
        far.occludes_up_to(
            &TraversalRay::new(Ray { origin: DVec3::ZERO, direction: DVec3::Y }),
            f64::INFINITY
        )
    );
}
