//! Meshes as scenes see them: closed under any placement, the same from every file format, shaded on the right side.

use crate::support::{Random, geometry, sequence, sequence_in, shoot, shoot_all, shoot_extra};
use kinora::appearance::material::MaterialBinding;
use kinora::base::color::Rgb;
use kinora::base::files::Root;
use kinora::base::math::{DAffine3, DVec3, Ray, UNIT_ROUNDOFF};
use kinora::film::AovSet;
use kinora::geometry::bvh::TraversalRay;
use kinora::geometry::mesh::{self, Corners, MeshData, Normals, generate};
use kinora::geometry::shape::{Mesh, OneRay, Shape};
use kinora::import::{self, LoadProgress, obj, ply};
use kinora::scene::top_level::Bvh;
use kinora::scene::{Finish, Geometry, Primitive};
use kinora::sequence::load;
use std::fs::{self, File};
use std::path::Path;
use std::sync::Arc;

/// Rays per configuration.
const RAYS: u32 = if cfg!(debug_assertions) { 10_000 } else { 200_000 };

fn shape(parts: MeshData, normals: Normals) -> Shape {
    let mesh = mesh::TriangleMesh::new(parts).unwrap_or_else(|error| panic!("{error}"));
    Shape::Mesh(Mesh::new(Arc::new(mesh), normals))
}

fn alone(shape: Shape, to_world: DAffine3) -> Geometry {
    let mut geometry = Geometry::default();
    geometry.push(&shape, to_world, Finish::Material(MaterialBinding::One(0)));
    geometry
}

/// Rays from inside that find no way out of a unit icosphere, whose positions are changed by `baked` first and
/// which is then placed by `to_world`.
fn leaks(baked: impl Fn(DVec3) -> DVec3, to_world: DAffine3, rays: u32) -> u32 {
    let mut parts = generate::icosphere(5);
    assert_eq!(parts.triangles.len(), 20_480);
    parts.positions.iter_mut().for_each(|position| *position = baked(*position));
    let in_world = |p: DVec3| to_world.transform_point3(p);
    let (positions, triangles) = (parts.positions.clone(), parts.triangles.clone());
    let geometry = alone(shape(parts, Normals::Flat), to_world);
    let bvh = Bvh::build(&geometry);
    let mut random = Random(12);
    let mut leaks = 0;
    for ray in 0..rays {
        let origin = in_world(baked(random.point(0.17)));
        let [a, b, _] = triangles[(random.unit() * triangles.len() as f64) as usize];
        let [a, b] = [a, b].map(|vertex| in_world(positions[vertex as usize]));
        let aim = if ray % 2 == 0 { a } else { a + (b - a) * random.unit() };
        let direction = if ray % 4 < 2 { aim - origin } else { (aim - origin).normalize() };
        let probe = TraversalRay::new(Ray { origin, direction });
        leaks += u32::from(bvh.intersect_one(&geometry, &probe).is_none());
        leaks += u32::from(!bvh.occludes_one(&geometry, &probe, f64::INFINITY));
    }
    leaks
}

/// Scales and offsets that positions have in the file (INT-12).
const BAKED: [(f64, f64); 4] = [(1.0, 0.0), (1.0, 100.0), (1.0, 1e4), (1000.0, 0.0)];

fn assert_watertight(rays: u32) {
    for (scale, offset) in BAKED {
        let center = DVec3::new(1.0, 0.7, -0.3) * offset;
        let leaks = leaks(|p| center + p * scale, DAffine3::IDENTITY, rays);
        assert_eq!(leaks, 0, "scale {scale}, offset {offset}");
    }
    let turn = DAffine3::from_axis_angle(DVec3::new(0.6, 0.64, 0.48), 1.0);
    let uneven = DAffine3::from_scale(DVec3::new(2.0, -1.0, 0.25));
    let away = DAffine3::from_translation(DVec3::new(1.0, 0.7, -0.3) * 1e4);
    for placement in [turn, turn * uneven, away * turn * uneven * turn] {
        assert_eq!(leaks(|p| p, placement, rays), 0, "{placement:?}");
    }
}

#[test]
fn int_12_no_ray_leaks_out_of_a_closed_mesh() {
    assert_watertight(RAYS);
}

#[test]
#[ignore = "takes a minute: the full number of rays of INT-12; cargo test --release -- --ignored int_12"]
fn int_12_no_ray_of_ten_million_leaks_out_of_a_closed_mesh() {
    assert_watertight(10_000_000);
}

/// A mesh is hit where its triangles are hit one by one.
#[test]
fn a_mesh_is_the_sum_of_its_triangles() {
    let parts = generate::displaced_sphere(3, 4);
    let corners = |triangle: &[u32; 3]| triangle.map(|vertex| parts.positions[vertex as usize]);
    let triangle = |corners| Shape::Triangle(kinora::geometry::shape::Triangle { corners });
    let loose = parts.triangles.iter().map(|t| triangle(corners(t)));
    let loose = geometry(loose);
    let whole = alone(shape(parts, Normals::Flat), DAffine3::IDENTITY);
    let (loose_bvh, whole_bvh) = (Bvh::build(&loose), Bvh::build(&whole));
    let mut random = Random(6);
    for _ in 0..RAYS {
        let origin = random.point(3.0);
        let ray = Ray { origin, direction: random.point(1.2) - origin };
        let probe = TraversalRay::new(ray);
        let (one, other) = (loose_bvh.intersect_one(&loose, &probe), whole_bvh.intersect_one(&whole, &probe));
        assert_eq!(one.map(|hit| (hit.at.t, hit.primitive)), other.map(|hit| (hit.at.t, hit.at.part)));
        let (Some(one), Some(other)) = (one, other) else { continue };
        let loose_surface = loose.primitives[one.primitive as usize].surface_at(&ray, one.at);
        assert_eq!(loose_surface, whole.primitives[0].surface_at(&ray, other.at));
    }
}

/// The same mesh from an OBJ file and a PLY file, and in memory.
#[test]
fn file_formats_do_not_show() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let mut parts = generate::displaced_sphere(3, 2);
    parts.positions.iter_mut().for_each(|position| *position /= 3.0);
    let normals = parts.positions.iter().map(|position| position.as_vec3()).collect();
    parts.normals = Some(Corners::per_vertex(normals));
    let path = |name: &str| folder.path().join(name);
    obj::write(File::create(path("a.obj")).expect("a file"), &parts).expect("a disk");
    ply::write(File::create(path("a.ply")).expect("a file"), &parts).expect("a disk");
    let read = |name: &str| {
        let mesh = import::load(&path(name), &Root::anywhere(), &LoadProgress::default())
            .unwrap_or_else(|error| panic!("{error}"));
        Shape::Mesh(Mesh::new(Arc::new(mesh), Normals::File))
    };
    let shapes = [read("a.obj"), read("a.ply"), shape(parts, Normals::File)];
    let mut random = Random(7);
    let mut hits = 0;
    for _ in 0..1000 {
        let origin = random.point(2.0);
        let ray = Ray { origin, direction: random.point(0.3) - origin };
        let printed = shapes.each_ref().map(|shape| {
            let at = shape.intersect_up_to(&TraversalRay::new(ray), f64::INFINITY)?;
            let surface = shape.surface_at(&ray, at);
            Some((at, surface, shape.uv_at(surface.point, at.part), shape.color(surface.point, at.part)))
        });
        assert!(printed[0] == printed[1] && printed[1] == printed[2], "{printed:?}");
        hits += u32::from(printed[0].is_some());
    }
    assert!(hits > 500, "{hits}");
}

/// XF-01: both normals turn with the inverse transpose, also when mirrored, and stay on one side.
#[test]
fn xf_01_normals_of_placed_meshes_are_perpendicular() {
    let s = 0.5_f64.sqrt();
    let shear = DAffine3::from_mat3(kinora::base::math::DMat3::from_cols(
        DVec3::X,
        DVec3::new(1.0, 1.0, 0.0),
        DVec3::Z,
    ));
    for (map, normal, expected) in [
        (DAffine3::from_scale(DVec3::new(2.0, 1.0, 1.0)), DVec3::new(s, s, 0.0), DVec3::new(1.0, 2.0, 0.0)),
        (DAffine3::from_scale(DVec3::new(1.0, 1.0, 0.1)), DVec3::new(0.0, s, s), DVec3::new(0.0, 0.1, 1.0)),
        (shear, DVec3::Y, DVec3::Y),
        (shear, DVec3::X, DVec3::new(1.0, -1.0, 0.0)),
        (DAffine3::from_scale(DVec3::new(-2.0, 1.0, 1.0)), DVec3::new(s, s, 0.0), DVec3::new(-1.0, 2.0, 0.0)),
        (DAffine3::from_scale(DVec3::splat(-1.0)), DVec3::Y, DVec3::NEG_Y),
    ] {
        // A triangle across the normal, counter-clockwise seen from its tip.
        let (u, v) = normal.any_orthonormal_pair();
        let mut positions = vec![normal - u - v, normal + u - v, normal + v];
        if (positions[1] - positions[0]).cross(positions[2] - positions[0]).dot(normal) < 0.0 {
            positions.swap(0, 1);
        }
        let normals = Some(Corners::per_vertex(vec![normal.as_vec3(); 3]));
        let parts = MeshData { positions, triangles: vec![[0, 1, 2]], normals, ..MeshData::default() };
        let placed =
            Primitive::new(&shape(parts, Normals::File), map, Finish::Material(MaterialBinding::One(0)))
                .expect("a primitive");
        let target = map.transform_point3(normal);
        let ray = Ray { origin: target * 3.0, direction: -target };
        let at = placed.intersect_up_to(&TraversalRay::new(ray), f64::INFINITY).expect("a hit");
        let surface = placed.surface_at(&ray, at);
        let expected = expected.normalize();
        assert!((surface.normal - expected).length() <= 16.0 * UNIT_ROUNDOFF, "{}", surface.normal);
        // Corners' normals are f32.
        assert!((surface.shading - expected).length() <= 1e-6, "{}", surface.shading);
    }
}

/// An uneven scale may turn a shading normal past the horizon of its surface; it is kept on the surface's side.
#[test]
fn placed_shading_normals_stay_on_their_side() {
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::NEG_Z];
    let steep = DVec3::new(1.0, 0.1, 0.0).normalize();
    let normals = Some(Corners::per_vertex(vec![steep.as_vec3(); 3]));
    let parts = MeshData { positions, triangles: vec![[0, 1, 2]], normals, ..MeshData::default() };
    let shape = shape(parts, Normals::File);
    for turn in 0..36 {
        let map = DAffine3::from_scale(DVec3::new(5.0, 0.2, 1.0))
            * DAffine3::from_axis_angle(DVec3::Z, f64::from(turn).to_radians() * 10.0);
        let placed =
            Primitive::new(&shape, map, Finish::Material(MaterialBinding::One(0))).expect("a primitive");
        let target = map.transform_point3(DVec3::new(0.25, 0.0, -0.25));
        for side in [1.0, -1.0] {
            let direction = map.transform_vector3(DVec3::Y) * side;
            let ray = Ray { origin: target - direction, direction };
            let at = placed.intersect_up_to(&TraversalRay::new(ray), f64::INFINITY).expect("a hit");
            let surface = placed.surface_at(&ray, at);
            assert!(surface.shading.dot(surface.normal) >= 0.0, "turn {turn}");
        }
    }
}

fn sequence_with(folder: &Path, objects: &str) -> Result<kinora::sequence::Sequence, String> {
    let path = folder.join("scene.ron");
    fs::write(&path, format!("(objects: {{ {objects} }})")).expect("the folder is writable");
    load(&path).map_err(|error| error.to_string())
}

#[test]
fn files_are_found_beside_the_sequence_and_read_once() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    fs::create_dir(folder.path().join("models")).expect("the folder is writable");
    let file = File::create(folder.path().join("models/ball.ply")).expect("a file");
    ply::write(file, &generate::icosphere(1)).expect("a disk");
    let objects = "\"a\": (shape: Mesh(\"models/ball.ply\")), \
                   \"b\": (shape: Mesh(file: \"./models/ball.ply\", normals: Smooth)), \
                   \"c\": (shape: Mesh(\"models/../models/ball.ply\"))";
    let sequence = sequence_with(folder.path(), objects).unwrap_or_else(|error| panic!("{error}"));
    let meshes: Vec<_> = sequence.objects.iter().map(|object| object.value.shape.clone()).collect();
    let [Shape::Mesh(a), Shape::Mesh(b), Shape::Mesh(c)] = &meshes[..] else { panic!("{meshes:?}") };
    assert!(Arc::ptr_eq(&a.mesh, &b.mesh) && a == c && a != b);
    assert_eq!((a.normals, b.normals), (Normals::Flat, Normals::Smooth));
    assert_eq!(sequence.meshes().len(), 1);
    assert_eq!(sequence.notes(), [""; 0]);
}

#[test]
fn faults_of_meshes_name_their_line() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("a disk");
    write("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n");
    write("b.obj", "mtllib b.mtl\nv 0 0 0\n");
    write("b.mtl", "newmtl x\nNs a lot\n");
    write("c.obj", "# nothing\n");
    for (name, expected) in [
        ("a.obj", "line 3: there is no vertex 3; the file has 2"),
        ("b.obj", "b.mtl, line 2: expected a finite number, found `Ns a lot`"),
        ("c.obj", "it has no triangles"),
        ("d.obj", "there is no such file"),
        (".", "meshes are read from .obj, .ply, .stl, .vtk, .vtp, .vtu, .pvtp and .pvtu files"),
    ] {
        let printed =
            sequence_with(folder.path(), &format!("\"a\": (shape: Mesh({name:?}))")).expect_err(name);
        assert!(
            printed.contains(expected) && printed.contains(&format!("cannot read the mesh {name:?}")),
            "{printed}"
        );
    }
}

#[test]
fn int_15_ignored_parts_are_reported() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\nf 2 2 2\n";
    fs::write(folder.path().join("a.obj"), text).expect("a disk");
    let sequence = sequence_with(folder.path(), "\"flat\": (shape: Mesh(\"a.obj\"))").expect("a sequence");
    assert_eq!(sequence.notes(), ["the mesh of `flat`: 2 triangles without an area left out"]);
}

/// INT-15: whatever a mesh is like, no pixel is without a colour.
#[test]
fn int_15_no_mesh_gives_nan_pixels() {
    let text = "(
        output: (size: (24, 24)), quality: (antialias: 1),
        camera: (position: (0.3, 0.3, 2), target: (0.3, 0.3, 0)),
        lights: { \"sun\": Point(position: (1, 2, 3)) },
        objects: { \"mesh\": (
            shape: Mesh(
                vertices: [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 1, 0), (2, 0, 0), (0, 0, 1e-21), (1e-21, 0, 0)],
                triangles: [(0, 1, 2), (2, 2, 2), (0, 1, 4), (0, 5, 6), (1, 2, 3), (0, 1, 5)],
                normals: [(0, 0, 1), (0, 0, -1), (1, 0, 0), (0, 0, 0), (1e-30, 0, 0), (1e30, 0, 0), (0, 0, 1)],
            ),
            material: (specular: 1, mirror: 0.5),
        ) },
    )";
    for shot in shoot_all(text) {
        assert!(shot.film.radiance().all(|radiance| radiance.is_finite()));
        assert!(shot.pixel(12, 12).max_element() > 0.0);
    }
}

/// A grid of points as a smooth mesh that is a sharp mirror.
fn smooth_mirror(across: u32, along: u32, point: impl Fn(f64, f64) -> [f64; 3]) -> String {
    let at = |k: u32, of: u32| f64::from(k) / f64::from(of);
    let points = (0..=along).flat_map(|y| (0..=across).map(move |x| (x, y)));
    let vertices: String = points
        .map(|(x, y)| point(at(x, across), at(y, along)))
        .map(|[x, y, z]| format!("({x:?}, {y:?}, {z:?}), "))
        .collect();
    let corner = |x: u32, y: u32| y * (across + 1) + x;
    let triangles: String = (0..along)
        .flat_map(|y| (0..across).map(move |x| (x, y)))
        .map(|(x, y)| [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)])
        .map(|[a, b, c, d]| format!("({a}, {b}, {c}), ({a}, {c}, {d}), "))
        .collect();
    format!(
        "objects: {{ \"mirror\": (shape: Mesh(vertices: [{vertices}], triangles: [{triangles}], normals: Smooth),
        material: Metal(color: 1)) }}"
    )
}

/// A ball of few facets, with poles along z.
fn mirror_ball() -> String {
    smooth_mirror(9, 6, |u, v| {
        let (turn, tilt) = (std::f64::consts::TAU * u, std::f64::consts::PI * v);
        let level = if v == 0.0 || v == 1.0 { 0.0 } else { libm::sin(tilt) };
        // The last column is the first one.
        let turn = if u == 1.0 { 0.0 } else { turn };
        [level * libm::cos(turn), level * libm::sin(turn), libm::cos(tilt)]
    })
}

/// A mirror that absorbs nothing looks like the even light around it, whatever its normals are.
#[test]
fn smooth_mirrors_lose_no_light() {
    let bowl = smooth_mirror(7, 7, |u, v| {
        let (x, y) = (2.0 * u - 1.0, 2.0 * v - 1.0);
        [x, y, 0.8 * (x * x + y * y)]
    });
    let waves = smooth_mirror(12, 12, |u, v| {
        let (x, y) = (2.0 * u - 1.0, 2.0 * v - 1.0);
        [x, y, 0.12 * libm::cos(9.0 * x) * libm::cos(7.0 * y)]
    });
    for mirror in [mirror_ball(), bowl, waves] {
        for integrator in ["Whitted", "Path(roulette: Off)"] {
            for eye in ["(0.3, 0.2, 4)", "(3.5, 0.5, 0.9)"] {
                let text = format!(
                    "(output: (size: (48, 48)), quality: (integrator: {integrator}, antialias: 1, samples: 1, bounces: 1000),
                    background: 1, camera: (position: {eye}, up: (0, 1, 0.1), projection: Orthographic(height: 2.2)), {mirror})"
                );
                let film = &shoot_all(&text)[0].film;
                let dark =
                    film.radiance().filter(|pixel| (*pixel - Rgb::ONE).abs().max_element() > 1e-5).count();
                assert_eq!(dark, 0, "{integrator} from {eye}: {dark} pixels lose light");
            }
        }
    }
}

/// What a smooth ball shows is what lies where its interpolated normals send the eye, up to its very rim.
#[test]
fn smooth_mirrors_reflect_by_interpolated_normals() {
    let text = format!(
        "(output: (size: (96, 96)), quality: (antialias: 1), background: Gradient(bottom: 0, top: 1, up: (0.3, 1, -0.2)),
        camera: (position: (0.3, 0.2, 4), projection: Orthographic(height: 2.2)), {})",
        mirror_ball()
    );
    let sequence = sequence(&text);
    let film =
        shoot_extra(&sequence, AovSet { coverage: false, features: true, guides: false, samples: false });
    let toward = -DVec3::new(0.3, 0.2, 4.0).normalize();
    let up = DVec3::new(0.3, 1.0, -0.2).normalize();
    let mut off = Vec::new();
    for pixel in 0..96 * 96 {
        let Some(seen) = film.features_at(pixel).filter(|seen| seen.depth.is_some()) else { continue };
        let normal = seen.normal.as_dvec3();
        // One that faces away is not used.
        if normal.dot(toward) >= 0.0 {
            continue;
        }
        let mirrored = toward - normal * (2.0 * normal.dot(toward));
        let expected = 0.5 * (mirrored.dot(up) + 1.0);
        let error = (f64::from(film.radiance_at(pixel).x) - expected).abs();
        if error > 1e-5 {
            off.push(error);
        }
    }
    assert!(
        off.is_empty(),
        "{} pixels are off by up to {}",
        off.len(),
        off.iter().fold(0.0, |a: f64, b| a.max(*b))
    );
}

/// Rays that hit meshes of different sizes share a row of lanes.
#[test]
fn meshes_of_different_sizes_are_seen_together() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("a folder");
    for (name, subdivisions) in [("small.ply", 0), ("large.ply", 4)] {
        let file = File::create(folder.path().join(name)).expect("a file");
        ply::write(file, &generate::icosphere(subdivisions)).expect("a disk");
    }
    let seen = |material: &str| {
        let text = format!(
            "(output: (size: (64, 64)), quality: (antialias: 1, bounces: 4), ambient: 1, \
             camera: (position: (0, 0, 9)), materials: {{ \"m\": {material} }}, objects: {{ \
             \"a\": (shape: Mesh(\"small.ply\"), translation: (0.3, 0, 0), material: \"m\"), \
             \"b\": (shape: Mesh(\"large.ply\"), translation: (-0.3, 0.4, 0), material: \"m\") }})"
        );
        let sequence = sequence_in(folder.path(), &text);
        shoot(&sequence, [0]).remove(0).film.radiance().filter(|radiance| radiance.x > 0.0).count()
    };
    assert!(seen("(ambient: 1)") > 300);
    assert!(seen("(ambient: 0.3, transparency: 0.5)") > 300);
}
