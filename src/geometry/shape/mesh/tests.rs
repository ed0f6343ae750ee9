//! Meshes as shapes: hits, surfaces and samples.

use super::Mesh;
use crate::base::color::Rgb;
use crate::base::lanes::tests::on_all_levels;
use crate::base::lanes::{Level, Mask, Row, SimdKernel, dispatch};
use crate::base::math::{DVec2, DVec3, Ray};
use crate::geometry::bvh::{CLEARANCE, Stack, TraversalRay};
use crate::geometry::mesh::{self, Corners, MeshData, Normals, generate};
use crate::geometry::shape::part_search::{every_part, nearest_part_on};
use crate::geometry::shape::{Geometric, LaneHit, OneRay, RayInterval, ShapeHit, Surface, Triangle};
use crate::testing::{Random, eight_rays};
use glam::Vec3;
use std::sync::Arc;

fn shape(parts: MeshData, normals: Normals) -> Mesh {
    Mesh::new(Arc::new(mesh::TriangleMesh::new(parts).expect("a mesh")), normals)
}

fn triangle() -> MeshData {
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    MeshData { positions, triangles: vec![[0, 1, 2]], ..MeshData::default() }
}

/// The hits of a ray with all triangles of the mesh, one by one.
fn crossed(mesh: &Mesh, ray: &TraversalRay, t_max: f64) -> Vec<ShapeHit> {
    let hit = |part: u32| {
        let triangle = Triangle { corners: mesh.mesh.corners(part) };
        triangle.intersect_up_to(ray, t_max).map(|hit| ShapeHit::of_part(hit.t, part))
    };
    (0..mesh.mesh.triangles().len() as u32).filter_map(hit).collect()
}

/// The hits within bounds, found in the tree.
fn every_hit(mesh: &Mesh, ray: &TraversalRay, within: RayInterval<f64>) -> Vec<ShapeHit> {
    let mut all = Vec::new();
    every_part(mesh, ray, within, &mut |hit| all.push(hit));
    all.sort_by_key(|hit| hit.part);
    all.dedup();
    all
}

fn down(x: f64, y: f64) -> Ray {
    Ray { origin: DVec3::new(x, y, 1.0), direction: DVec3::NEG_Z }
}

/// Rays find the nearest triangle of all in the tree. Returns how many of them hit.
fn hits_of_every_triangle(mesh: &Mesh, rays: usize) -> usize {
    let mut random = Random(3);
    let mut hits = 0;
    for _ in 0..rays {
        let origin = random.point(3.0);
        let ray = TraversalRay::new(Ray { origin, direction: random.point(1.0) - origin });
        let each = crossed(mesh, &ray, f64::INFINITY);
        let nearest = each.iter().copied().min_by(|a, b| a.t.total_cmp(&b.t).then(a.part.cmp(&b.part)));
        let found = || {
            let nearest = mesh.intersect_up_to(&ray, f64::INFINITY);
            (
                nearest,
                mesh.occludes_up_to(&ray, f64::INFINITY),
                every_hit(mesh, &ray, RayInterval::up_to(f64::INFINITY)),
            )
        };
        for (level, found) in on_all_levels(found) {
            assert_eq!(found, (nearest, nearest.is_some(), each.clone()), "{level:?}");
        }
        if let Some(ShapeHit { t, .. }) = nearest {
            hits += 1;
            assert_eq!(mesh.intersect_up_to(&ray, t), None, "nothing lies before the nearest");
            assert!(!mesh.occludes_up_to(&ray, t) && mesh.occludes_up_to(&ray, t.next_up()));
        }
    }
    hits
}

#[test]
fn the_tree_finds_what_every_triangle_finds() {
    let hits = hits_of_every_triangle(&shape(generate::displaced_sphere(3, 7), Normals::Flat), 3000);
    assert!(hits > 500, "{hits}");
}

/// Across corners, edges and faces, along segments about as short as the error bounds of their points: so both sides of
/// an edge are found where a ray enters a mesh.
#[test]
fn short_segments_find_all_triangles_that_they_cross() {
    let mesh = shape(generate::displaced_sphere(3, 7), Normals::Flat);
    let (mut random, mut shared) = (Random(4), 0);
    for part in 0..mesh.mesh.triangles().len() as u32 {
        let [a, b, c] = mesh.mesh.corners(part);
        for point in [a, 0.5 * (a + b), 0.25 * a + 0.75 * c, (a + b + c) / 3.0] {
            for out in [(b - a).cross(c - a).normalize(), random.point(1.0).normalize()] {
                let (from, to) = (point + 2e-15 * out, point - 2e-15 * out);
                let scale = (1u64 << 48) as f64;
                let ray = TraversalRay::new(Ray { origin: from, direction: (to - from) * scale });
                let each = crossed(&mesh, &ray, 1.0 / scale);
                shared += usize::from(each.len() > 1);
                for (level, found) in
                    on_all_levels(|| every_hit(&mesh, &ray, RayInterval::up_to(1.0 / scale)))
                {
                    assert_eq!(found, each, "{level:?}");
                }
            }
        }
    }
    assert!(shared > 1000, "{shared}");
}

/// Two parallel squares of side 2 with this gap between them.
fn sheets(gap: f64) -> MeshData {
    let corners = [0.0, gap]
        .map(|z| [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec3::new(x, y, z)));
    let triangles = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
    MeshData { positions: corners.concat(), triangles, ..MeshData::default() }
}

struct Isolating<'a>(&'a Mesh, &'a TraversalRay);

impl SimdKernel for Isolating<'_> {
    type Output = Option<ShapeHit>;

    #[inline(always)]
    fn run<L: Level>(self) -> Option<ShapeHit> {
        let mut stack = Stack::default();
        stack.isolates = true;
        nearest_part_on::<L>(self.0, self.1, RayInterval::up_to(f64::INFINITY), Some(&mut stack))
    }
}

/// The first hit of a ray, by a search that shows whether it is isolated.
fn isolating(mesh: &Mesh, ray: &TraversalRay) -> Option<ShapeHit> {
    dispatch(Isolating(mesh, ray))
}

/// Segments through isolated hits, in any direction and as long as these must be clear, cross no other triangle. Hits
/// of sheets so close to each other, and of edges, are not isolated; nearly all others of a sphere are.
#[test]
fn isolated_hits_have_no_other_triangle_nearby() {
    let kinds = [
        (generate::displaced_sphere(3, 7), 0.9..1.0),
        // Farther apart than they are wide: otherwise, the line of an oblique ray leaves it open.
        (sheets(5.0), 0.5..1.0),
        (sheets(1e-9), 0.0..0.01),
        (sheets(1e-12), 0.0..0.01),
        (sheets(1e-15), 0.0..0.01),
        (sheets(0.0), 0.0..0.01),
    ];
    let mut random = Random(6);
    for (data, expected) in kinds {
        let mesh = shape(data, Normals::Flat);
        let reach = CLEARANCE * mesh.mesh.tree().space().size;
        let (mut hits, mut isolated) = (0.0, 0.0);
        for _ in 0..3000 {
            let origin = random.point(3.0);
            let ray = TraversalRay::new(Ray { origin, direction: random.point(1.0) - origin });
            let found = on_all_levels(|| isolating(&mesh, &ray));
            let flags: Vec<bool> = found.iter().filter_map(|(_, hit)| Some((*hit)?.isolated)).collect();
            let Some((_, Some(hit))) = found.into_iter().next() else { continue };
            assert!(flags.iter().all(|flag| *flag == hit.isolated), "{flags:?}");
            hits += 1.0;
            if !hit.isolated {
                continue;
            }
            isolated += 1.0;
            let at = ray.ray.at(hit.t);
            for _ in 0..4 {
                let way = random.direction();
                let across = TraversalRay::new(Ray { origin: at - way * reach, direction: way });
                let all = crossed(&mesh, &across, 2.0 * reach);
                assert!(all.iter().all(|other| other.part == hit.part), "{hit:?} {all:?}");
            }
        }
        assert!(
            hits > 100.0 && expected.contains(&(isolated / hits)),
            "{isolated} of {hits}: not {expected:?}"
        );
    }
}

/// Rays along an edge between two faces, and within the error of one, hit nothing that is isolated.
#[test]
fn hits_of_edges_are_not_isolated() {
    let mesh = shape(generate::displaced_sphere(2, 3), Normals::Flat);
    let (mut random, mut hits) = (Random(8), 0);
    for part in 0..mesh.mesh.triangles().len() as u32 {
        let [a, b, _] = mesh.mesh.corners(part);
        for _ in 0..4 {
            let point = a + (b - a) * random.unit();
            let origin = point * 3.0 + random.point(0.1);
            let ray = TraversalRay::new(Ray { origin, direction: point - origin });
            if let Some(hit) = isolating(&mesh, &ray).filter(|hit| (hit.t - 1.0).abs() < 1e-9) {
                hits += 1;
                assert!(!hit.isolated, "{hit:?}");
            }
        }
    }
    assert!(hits > 500, "{hits}");
}

/// From nearby, and from far away, where rays start near the tree instead; behind a minimum of t.
#[test]
fn rays_find_every_triangle_behind_a_minimum() {
    let mesh = shape(generate::displaced_sphere(3, 7), Normals::Flat);
    let (mut random, mut behind) = (Random(5), 0);
    for distance in [2.0, 10.0, 1e3, 1e6] {
        for _ in 0..300 {
            let origin = distance * random.point(1.0).normalize();
            let ray = TraversalRay::new(Ray { origin, direction: random.point(0.5) - origin });
            let each = crossed(&mesh, &ray, f64::INFINITY);
            let min = each.iter().map(|hit| hit.t).fold(f64::INFINITY, f64::min).next_up();
            let wanted: Vec<ShapeHit> = each.iter().copied().filter(|hit| min < hit.t).collect();
            let mut found = every_hit(&mesh, &ray, RayInterval { min, max: f64::INFINITY });
            found.retain(|hit| min < hit.t);
            assert_eq!(found, wanted);
            assert_eq!(every_hit(&mesh, &ray, RayInterval::up_to(f64::INFINITY)), each);
            behind += wanted.len();
        }
    }
    assert!(behind > 100, "{behind}");
}

/// A mesh that was refitted step by step: as it bends and flies away, and as long triangles, which are in several
/// leaves, become short and long again.
#[test]
fn a_refitted_tree_finds_what_every_triangle_finds() {
    let mut bent = mesh::TriangleMesh::new(generate::displaced_sphere(3, 7)).expect("a mesh");
    for step in 1..=3 {
        let mut data = generate::displaced_sphere(3, 7);
        for position in &mut data.positions {
            *position += DVec3::new(0.1 * f64::from(step) * libm::sin(3.0 * position.y), 0.0, 0.2);
        }
        bent = mesh::TriangleMesh::after(data, Some(&bent)).expect("a mesh");
    }
    let hits = hits_of_every_triangle(&Mesh::new(Arc::new(bent), Normals::Flat), 1000);
    assert!(hits > 100, "{hits}");

    let long = |length: f64| {
        let mut random = Random(9);
        let corners = |_| {
            let (at, along) = (random.point(0.5), random.point(1.0) * length);
            [at, at + along, at + 0.5 * along + random.point(0.05)]
        };
        let positions: Vec<DVec3> = (0..300).flat_map(corners).collect();
        let triangles = (0..300).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        MeshData { positions, triangles, ..MeshData::default() }
    };
    let mut shown = shape(long(1.0), Normals::Flat);
    for length in [0.9, 0.2, 1.0] {
        let mesh = mesh::TriangleMesh::after(long(length), Some(&shown.mesh)).expect("a mesh");
        shown = Mesh::new(Arc::new(mesh), Normals::Flat);
        let hits = hits_of_every_triangle(&shown, 300);
        assert!(hits > 10, "{hits}");
    }
}

/// Coordinates are interpolated, not normalised, and mean the same at every point (SH-14).
#[test]
fn sh_14_texture_coordinates_are_interpolated() {
    let with = |uvs: [(f64, f64); 3]| {
        let uvs = uvs.map(|(u, v)| DVec2::new(u, v)).to_vec();
        shape(MeshData { uvs: Some(Corners::per_vertex(uvs)), ..triangle() }, Normals::Flat)
    };
    let third = 1.0 / 3.0;
    let ulps = |a: DVec2, b: DVec2| (a - b).abs().max_element() / (0.5 * f64::EPSILON);
    let uv = with([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]).uv_at(DVec3::new(third, third, 0.0), 0);
    assert!(ulps(uv, DVec2::splat(third)) <= 4.0, "{uv}");
    let uv = with([(0.0, 0.0), (4.0, 0.0), (0.0, 4.0)]).uv_at(DVec3::new(0.5, 0.25, 0.0), 0);
    assert!(ulps(uv, DVec2::new(2.0, 1.0)) <= 4.0, "{uv}");
    let without = shape(triangle(), Normals::Flat);
    assert_eq!(without.uv_at(DVec3::new(0.5, 0.25, 0.0), 0), DVec2::new(0.5, 0.25));
}

#[test]
fn vertex_colours_are_interpolated() {
    let colors = vec![Rgb::X, Rgb::Y, Rgb::Z];
    let mesh = shape(MeshData { colors, ..triangle() }, Normals::Flat);
    assert_eq!(mesh.color(DVec3::new(0.5, 0.25, 0.0), 0), Rgb::new(0.25, 0.5, 0.25));
    assert_eq!(shape(triangle(), Normals::Flat).color(DVec3::ZERO, 0), Rgb::ONE);
}

fn with_normals(normals: [Vec3; 3]) -> Mesh {
    shape(MeshData { normals: Some(Corners::per_vertex(normals.to_vec())), ..triangle() }, Normals::File)
}

/// INT-15 (f) and related cases: normals that cancel, are not finite, or are missing.
#[test]
fn int_15_the_geometric_normal_stands_in_for_one_without_a_direction() {
    let n = Vec3::new(0.3, 0.4, 0.866).normalize();
    for normals in [[n, -n, Vec3::X], [Vec3::ZERO; 3], [Vec3::NAN; 3], [Vec3::INFINITY; 3]] {
        let mesh = with_normals(normals);
        let at = mesh.intersect_up_to(&TraversalRay::new(down(0.5, 0.0)), f64::INFINITY).expect("a hit");
        let surface = mesh.surface_at(&down(0.5, 0.0), at);
        assert_eq!((surface.normal, surface.shading), (DVec3::Z, DVec3::Z));
    }
}

#[test]
fn shading_normals_stay_on_the_geometric_side() {
    let lean = Vec3::new(0.6, 0.0, 0.8);
    for normals in [[lean; 3], [-lean; 3], [lean * 1e-30; 3], [lean * 1e30; 3]] {
        let surface = with_normals(normals).surface_at(&down(0.2, 0.2), ShapeHit::at(1.0));
        assert!((surface.shading - DVec3::new(0.6, 0.0, 0.8)).length() < 1e-7, "{normals:?}");
        assert_eq!(surface.normal, DVec3::Z);
    }
}

/// INT-15 (a) to (c) and (e).
#[test]
fn int_15_what_has_no_area_is_never_hit() {
    let p = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    let positions =
        vec![p(0.0, 0.0), p(1.0, 0.0), p(0.0, 1.0), p(2.0, 0.0), p(1.4e-21, 0.0), p(0.0, 1.4e-21)];
    let triangles = vec![[1, 1, 1], [0, 1, 3], [0, 4, 5], [0, 1, 2], [0, 1, 1]];
    let mesh = shape(MeshData { positions, triangles, ..MeshData::default() }, Normals::Flat);
    assert_eq!((mesh.mesh.skipped, mesh.mesh.triangles()), (4, &[[0, 1, 2]][..]));
    let edge_on = Ray { origin: DVec3::new(-1.0, 0.5, 0.0), direction: DVec3::X };
    assert_eq!(mesh.intersect_up_to(&TraversalRay::new(edge_on), f64::INFINITY), None);
    assert_eq!(mesh.intersect_up_to(&TraversalRay::new(down(1.5, 0.0)), f64::INFINITY), None);
}

#[test]
fn points_are_drawn_evenly() {
    let positions =
        vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(3.0, 0.0, 1.0), DVec3::new(0.0, 3.0, 1.0), DVec3::Z];
    let parts = MeshData { positions, triangles: vec![[0, 1, 2], [5, 3, 4]], ..MeshData::default() };
    let mesh = shape(parts, Normals::Flat);
    assert_eq!(mesh.area(), Some(5.0));
    let mut random = Random(5);
    let mut large = 0;
    for _ in 0..10_000 {
        let (surface, part) = mesh.sample_area(random.unit(), random.unit());
        let surface = Surface::from(surface);
        assert_eq!((surface.normal, part), (DVec3::Z, u32::from(surface.point.z == 1.0)));
        large += u32::from(surface.point.z == 1.0);
        assert!(surface.point.x + surface.point.y <= 1.0 + 2.0 * surface.point.z + 1e-12);
    }
    assert!((8850..9150).contains(&large), "{large} of 10,000 instead of nine tenths");
    for u in [0.0, 1.0 - f64::EPSILON] {
        assert!(DVec3::from(mesh.sample_area(u, u).0.point).is_finite());
    }
}

/// The surfaces at hits of eight rays with a mesh.
struct Eight<'a>(&'a Mesh, &'a [Ray; 8], &'a [ShapeHit; 8]);

impl SimdKernel for Eight<'_> {
    type Output = [Surface; 8];

    #[inline(always)]
    fn run<L: Level>(self) -> [Surface; 8] {
        let Self(mesh, rays, at) = self;
        let at = LaneHit::<L::F64> {
            t: L::F64::from_array(at.map(|at| at.t)),
            part: L::U32::from_array(at.map(|at| at.part)),
            coincident: L::Mask::splat(false),
            isolated: 0,
        };
        mesh.surface(&eight_rays::<L>(rays), at, 0.0).store()
    }
}

#[test]
fn eight_surfaces_are_those_of_each() {
    let mut random = Random(21);
    let mesh = Arc::new(mesh::TriangleMesh::new(generate::displaced_sphere(3, 5)).expect("a mesh"));
    let mut lifted = 0;
    for normals in [Normals::Smooth, Normals::Flat].into_iter().cycle().take(600) {
        let mesh = Mesh::new(mesh.clone(), normals);
        let rays: [Ray; 8] = std::array::from_fn(|_| {
            // From inside too, where the normals face away.
            let reach = if random.unit() < 0.3 { 0.2 } else { 3.0 };
            let origin = random.point(reach);
            Ray { origin, direction: (random.point(0.3) - origin).normalize() }
        });
        let at = rays.map(|ray| mesh.intersect_up_to(&TraversalRay::new(ray), f64::INFINITY));
        let Some(at) = at.into_iter().collect::<Option<Vec<_>>>() else { continue };
        let at = at.try_into().expect("eight");
        for (level, surfaces) in on_all_levels(|| dispatch(Eight(&mesh, &rays, &at))) {
            for lane in 0..8 {
                let one = mesh.surface_at(&rays[lane], at[lane]);
                assert_eq!(surfaces[lane], one, "{level:?}");
                lifted += usize::from(one.lift != DVec3::ZERO);
            }
        }
    }
    assert!(lifted > 1000, "{lifted}");
}
