//! Where rays meet shapes. INT-07 to INT-10, INT-18 and part of INT-21 stand in `src/geometry/shape/round_tests.rs` and
//! `src/trace/round_tests.rs`, INT-13 in `src/geometry/shape/triangle.rs`, INT-15 with the meshes, INT-12 with them and in
//! `tests/integration`.

use crate::exact::{Exact, Vector, sphere_chord};
use crate::support::{Random, U, direction, disk_across, facing, few, geometry, hit, met, placed, shoot_all};
use kinora::base::math::{DAffine3, DVec3, Ray};
use kinora::geometry::shape::{Plane, Shape, Sphere};
use kinora::trace::spawn::spawn_ray;

fn sphere(center: DVec3, radius: f64) -> kinora::scene::Primitive {
    placed(&Shape::Sphere(Sphere { center, radius }), DAffine3::IDENTITY)
}

fn unit_sphere() -> kinora::scene::Primitive {
    sphere(DVec3::ZERO, 1.0)
}

fn near(found: f64, expected: f64, relative: f64) {
    let off = (found - expected).abs();
    assert!(off <= relative * expected.abs(), "{found:?} is off {expected:?} by {:e}", off / expected.abs());
}

/// Small spheres from afar. The textbook's b² - 4 a c loses the radius in the square of the distance: in f32 it misses
/// 24 % at 10^4, in f64 it is 75 times over the limit at 10^2.
fn far_small_spheres(rays: u32) {
    let unit = unit_sphere();
    let mut random = Random(7);
    for distance in [10.0, 1e2, 1e3, 1e4, 1e5] {
        let mut worst = 0.0f64;
        for ray in 0..2 * rays {
            let w = direction(&mut random);
            let inside = ray % 2 == 0;
            let aim = if inside {
                disk_across(&mut random, w, 0.0, 0.999)
            } else {
                disk_across(&mut random, w, 1.001, 1.05)
            };
            let (origin, d) = (w * distance, aim - w * distance);
            let chord = sphere_chord(DVec3::ZERO, 1.0, origin, d);
            // In f64 no ray of either kind is near enough to the limb to be in doubt.
            let found = hit(&unit, origin, d);
            assert_eq!(found.is_some(), chord.roots.is_some(), "{origin} {d}");
            let Some([expected, _]) = chord.roots else { continue };
            let l = chord.nearest.value();
            // In units of length: t counts lengths of the direction.
            let off = (Exact::from(found.expect("a hit").t) - expected).value().abs() * d.length();
            worst = worst.max(off / (2.0 * U * distance * (1.0 + l / ((1.0 - l) * (1.0 + l)).sqrt())));
        }
        assert!(worst <= 1.0, "{worst} of the limit at {distance}");
    }
}

#[test]
fn int_01_far_small_spheres() {
    far_small_spheres(few(200_000));
}

#[test]
#[ignore = "takes seconds: the full number of rays of INT-01; cargo test --release -- --ignored int_01"]
fn int_01_far_small_spheres_in_full() {
    far_small_spheres(200_000);
}

/// A ground sphere of the Earth's radius under the eye: c = |f|² - r² cancels (in f32, 2.47 instead of 2.5), (|f| - r)
/// (|f| + r) does not.
#[test]
fn int_03_the_ground_under_the_eye() {
    let radius = 6_371_000.0;
    let ground = sphere(DVec3::new(0.0, -radius, 0.0), radius);
    let eye = DVec3::new(0.0, 2.0, 0.0);
    let first = |d: DVec3| hit(&ground, eye, d).expect("the ground").t;
    near(first(DVec3::new(0.6, -0.8, 0.0)), 2.500_000_220_726_769_3, 1e-9);
    near(first(DVec3::new(0.9998, -0.02, 0.0)), 100.039_255_414_706_52, 1e-9);
    // The far root, from a point between both.
    let d = DVec3::new(0.6, -0.8, 0.0);
    near(hit(&ground, eye + d * 10.0, d).expect("the far side").t + 10.0, 10_193_600.699_999_78, 1e-9);
    let mut random = Random(3);
    for _ in 0..few(100_000) {
        let turn = kinora::base::math::Angle(-5.0 - 80.0 * random.unit()).cos_sin();
        let d = DVec3::new(turn.x, turn.y, 0.0);
        let chord = sphere_chord(DVec3::new(0.0, -radius, 0.0), radius, eye, d);
        near(first(d), chord.roots.expect("the ground")[0].value(), 1e-9);
    }
}

/// From inside every ray leaves once, and the side is told. A test for the near root alone fails always.
#[test]
fn int_05_rays_that_start_inside_a_sphere() {
    let unit = unit_sphere();
    let leave = |origin: DVec3, d: DVec3| {
        let (t, surface) = met(&unit, origin, d).expect("a ray from inside leaves");
        assert!(surface.normal.dot(d) > 0.0, "met from inside");
        assert!(facing(surface, d).normal.dot(d) < 0.0, "turned to the eye");
        let beyond = spawn_ray(&surface, d);
        assert_eq!(hit(&unit, beyond.origin, d), None, "once");
        t
    };
    near(leave(DVec3::new(0.3, -0.2, 0.1), DVec3::X), 0.674_679_434_480_896_4, 4.0 * U);
    let mut random = Random(5);
    for _ in 0..10_000 {
        let d = direction(&mut random);
        let exact = Exact::from(1.0) / Vector::from(d).length();
        near(leave(DVec3::ZERO, d), exact.value(), 4.0 * U);
    }
    let mut worst = 0.0f64;
    for _ in 0..few(100_000) {
        let (origin, d) = (direction(&mut random) * (1.0 - 1e-5), direction(&mut random));
        let expected = sphere_chord(DVec3::ZERO, 1.0, origin, d).roots.expect("inside")[1];
        if expected.value() < 1e-4 {
            continue;
        }
        let exit = (Vector::from(origin) + Vector::from(d).scaled(expected)).value();
        let off = (Exact::from(leave(origin, d)) - expected).value().abs();
        worst = worst.max(off / (8.0 * U * (1.0 + 1.0 / exit.dot(d).abs())));
    }
    assert!(worst <= 1.0, "{worst} of the limit");
}

/// Tangents, and rays that start on the surface: nothing but the sign of (|f| - r) settles which roots lie ahead.
#[test]
fn int_06_tangents_and_starts_on_the_surface() {
    let unit = unit_sphere();
    let beside = |y: f64| hit(&unit, DVec3::new(-10.0, y, 0.0), DVec3::X).map(|at| at.t);
    assert!(beside(1.0).is_none_or(|t| (t - 10.0).abs() < 1e-6));
    let off = beside(1.0 - libm::exp2(-24.0)).expect("a hit") - (10.0 - 3.452_669_778_56e-4);
    assert!(off.abs() <= 1e-12, "{off:e}");
    assert_eq!(beside(1.0 + libm::exp2(-23.0)), None);
    let (_, surface) = met(&unit, DVec3::X * 3.0, DVec3::NEG_X).expect("a hit");
    assert_eq!(surface.point, DVec3::X);
    let from = |d: DVec3| hit(&unit, spawn_ray(&surface, d).origin, d).map(|at| at.t);
    assert_eq!((from(DVec3::X), from(DVec3::Y)), (None, None));
    let back = from(DVec3::NEG_X).expect("the far side");
    assert!((back - 2.0).abs() <= 8.0 * U, "{} u", (back - 2.0) / U);
}

/// Points of the ground up to 10^7 away: nothing multiplies 0 by infinity, and what is known of a point is told.
#[test]
fn int_17_points_of_the_horizon() {
    let ground = placed(&Shape::Plane(Plane { point: DVec3::ZERO, normal: DVec3::Y }), DAffine3::IDENTITY);
    let eye = DVec3::new(0.0, 1.7, 0.0);
    let mut random = Random(17);
    for distance in [1e2, 1e3, 1e4, 1e5, 1e6, 1e7] {
        for _ in 0..1000 {
            let turn = kinora::base::math::Angle(360.0 * random.unit()).cos_sin() * distance;
            let d = (DVec3::new(turn.x, 0.0, turn.y) - eye).normalize();
            let (t, surface) = met(&ground, eye, d).expect("the ground");
            // The oracle: the same ray in twice the precision.
            let exact = Exact::from(1.7) / -Exact::from(d.y);
            let point = (Vector::from(eye) + Vector::from(d).scaled(exact)).value();
            let off = (surface.point - point).length();
            assert!(off <= 2.0 * U * t, "{off:e} at {distance}");
            assert_eq!(surface.point.y, 0.0);
            assert!((surface.point - point).abs().cmple(surface.error + DVec3::splat(2.0 * U * t)).all());
        }
    }
    for (origin, d) in [(DVec3::Y, DVec3::X), (DVec3::ZERO, DVec3::X)] {
        assert_eq!(hit(&ground, origin, d), None);
    }
    for tilt in [1e-30, 1e-300, 5e-324] {
        let at = hit(&ground, DVec3::Y, DVec3::new(1.0, -tilt, 0.0));
        assert!(at.is_none_or(|at| at.t.is_finite()), "{tilt:e}: {at:?}");
    }
}

/// The rows of a picture of a checkered ground, from the horizon down, each as its mean and its largest distance from
/// it.
fn ground_rows(camera: &str, pattern: &str) -> Vec<(f32, f32)> {
    let text = format!(
        "(output: (size: (64, 64)), quality: (antialias: 1), ambient: 1, camera: ({camera}),
        objects: {{ \"ground\": (shape: Plane(), material: (ambient: 1, diffuse: 0, color: {pattern})) }})"
    );
    let film = &shoot_all(&text)[0].film;
    let pixels: Vec<f32> = film.radiance().map(|pixel| pixel.x).collect();
    let row = |row: &[f32]| {
        let mean = row.iter().sum::<f32>() / row.len() as f32;
        (mean, row.iter().fold(0.0, |most: f32, pixel| most.max((pixel - mean).abs())))
    };
    pixels.chunks(64).map(row).collect()
}

/// Cells that a pixel covers whole fade to their mean; near the eye they are as firm as ever. One sample in a pixel
/// would show noise instead, up to the horizon.
#[test]
fn int_17_far_patterns_fade_to_their_mean() {
    for pattern in ["Checker()", "Stripes()", "Checker(space: Uv)"] {
        // 90 degrees: at depth z a pixel is z / 32 wide, and on the ground z² / (32 · 1.7) long.
        let level = "position: (0.3, 1.7, 0), target: (0.3, 1.7, -1), projection: Perspective(fov: 90)";
        let rows = ground_rows(level, pattern);
        for (row, (mean, most)) in rows.iter().enumerate().skip(32) {
            let depth = 1.7 * 32.0 / (row as f32 - 31.5);
            let (wide, long) = (depth / 32.0, depth * depth / (32.0 * 1.7));
            let checker = pattern.starts_with("Checker");
            if wide >= 1.01 || checker && long >= 1.01 {
                assert!((mean - 0.5).abs() < 1e-6 && *most < 1e-6, "{pattern} row {row}: {mean} ± {most}");
            }
            if long <= 0.49 {
                assert!(*most > 0.1, "{pattern} row {row} is {mean} ± {most}");
            }
        }
        assert_eq!(rows[33], (0.5, 0.0), "{pattern}");
    }
    // Straight down, all pixels are alike: firm up to half a cell, gone from a whole one on.
    for (height, firm) in [(30.0, true), (65.0, false), (1e9, false)] {
        let down = format!(
            "position: (0.25, 9, 0.25), target: (0.25, 0, 0.25), up: (0, 0, -1), projection: Orthographic(height: {height})"
        );
        let halves =
            ["Checker()", "Stripes()", "Waves()", "Islands()", "Checker(space: Uv)"].map(|p| (p, 0.5));
        // 2/π² ∫ acos(1 - cos x) from 0 to π/2.
        for (pattern, mean) in halves.into_iter().chain([("Dots()", 0.369_563_06)]) {
            let rows = ground_rows(&down, pattern);
            let most = rows.iter().fold(0.0, |most: f32, row| most.max((row.0 - mean).abs().max(row.1)));
            assert!(if firm { most >= mean } else { most <= 1e-6 }, "{pattern} from {height}: {most}");
        }
    }
}

/// Where coordinates are known no better than to a twentieth of a cell, cells are as uncertain.
#[test]
fn int_17_uncertain_cells_fade() {
    use kinora::appearance::texture::Pattern;
    let share =
        |error: f64| Pattern::Checker.share(DVec3::new(0.5, 0.5, 0.5), DVec3::splat(error), DVec3::ZERO);
    assert_eq!([share(1e-12), share(0.05), share(0.1), share(1e9)], [0.0, 0.0, 0.5, 0.5]);
}

/// Sizes whose squares leave f32: r² = 1e-40, c² = 9e36.
#[test]
fn int_21_extreme_sizes_of_spheres() {
    for (center, radius, expected) in [
        (DVec3::new(0.0, 0.0, 1e-18), 1e-20, 0.99e-18),
        (DVec3::new(0.0, 0.0, 3e18), 1e18, 2e18),
        (DVec3::new(0.0, 0.0, 1e-28), 1e-30, 0.99e-28),
        (DVec3::new(0.0, 0.0, 3e29), 1e29, 2e29),
    ] {
        near(hit(&sphere(center, radius), DVec3::ZERO, DVec3::Z).expect("a hit").t, expected, 1e-9);
        // The same through a tree.
        let geometry = geometry([Shape::Sphere(Sphere { center, radius })]);
        let bvh = kinora::scene::top_level::Bvh::build(&geometry);
        let probe =
            kinora::geometry::bvh::TraversalRay::new(Ray { origin: DVec3::ZERO, direction: DVec3::Z });
        near(bvh.intersect_one(&geometry, &probe).expect("a hit").at.t, expected, 1e-9);
    }
}

/// Every shape from a size of 10^-60 to 10^60, which parents may scale it to: the same t in units of the size.
#[test]
fn int_21_extreme_sizes_of_all_shapes() {
    use kinora::geometry::shape::{Cone, Cuboid, Cylinder, Disk, Torus, Triangle};
    let shapes = [
        Shape::Sphere(Sphere { center: DVec3::ZERO, radius: 1.0 }),
        Shape::Cuboid(Cuboid { min: DVec3::splat(-0.8), max: DVec3::splat(0.7) }),
        Shape::Cylinder(Cylinder::new(DVec3::NEG_Y, DVec3::Y, 0.8, true).expect("a cylinder")),
        Shape::Cone(Cone::new(DVec3::NEG_Y, DVec3::Y, 0.9, 0.0, true).expect("a cone")),
        Shape::Torus(Torus::new(DVec3::ZERO, DVec3::Y, 0.8, 0.3)),
        Shape::Disk(Disk { center: DVec3::ZERO, normal: DVec3::Y, radius: 1.0 }),
        Shape::Triangle(Triangle { corners: [DVec3::X, DVec3::Y, DVec3::Z] }),
    ];
    let turn = DAffine3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 1.0);
    for (shape, uneven) in shapes.iter().flat_map(|shape| [(shape, false), (shape, true)]) {
        let form = if uneven { turn * DAffine3::from_scale(DVec3::new(1.0, -0.5, 2.0)) } else { turn };
        for size in [1e-60, 1e-30, 1e-10, 1e10, 1e30, 1e60] {
            let scaled = DAffine3::from_scale(DVec3::splat(size));
            let (unit, extreme) = (placed(shape, form), placed(shape, scaled * form));
            let mut random = Random(21);
            let mut hits = 0;
            for _ in 0..500 {
                let (origin, aim) = (direction(&mut random) * 5.0, random.point(0.5));
                let d = aim - origin;
                let expected = met(&unit, origin, d);
                let found = met(&extreme, origin * size, d * size);
                assert_eq!(found.is_some(), expected.is_some(), "{shape:?} of {size:e}");
                let (Some((t, surface)), Some((expected, plain))) = (found, expected) else { continue };
                let cosine = plain.normal.dot(d.normalize()).abs();
                assert!(
                    (t - expected).abs() <= 1e-13 / cosine,
                    "{shape:?} of {size:e}: {t} instead of {expected}"
                );
                let beyond = spawn_ray(&surface, d);
                let again = spawn_ray(&plain, d);
                let counted =
                    [hit(&extreme, beyond.origin, d * size).is_some(), hit(&unit, again.origin, d).is_some()];
                assert_eq!(counted[0], counted[1], "{shape:?} of {size:e}");
                hits += 1;
            }
            assert!(hits > 50, "{hits} of {shape:?}");
        }
    }
}

/// Rays exactly at the edges and corners of closed meshes meet two triangles or more. They enter what it encloses once,
/// and leave it: one that stayed inside would be absorbed for ever.
#[test]
fn int_12_rays_at_edges_enter_closed_meshes_once() {
    let cube = "Mesh(vertices: [(-1, -1, -1), (1, -1, -1), (-1, 1, -1), (1, 1, -1), (-1, -1, 1), (1, -1, 1), (-1, 1, 1),
        (1, 1, 1)], triangles: [(0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3),
        (0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6)])";
    let octahedron =
        "Mesh(vertices: [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], triangles:
        [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)])";
    let wedge =
        "Mesh(vertices: [(-1, 0, -1), (1, 0, -1), (-1, 0.125, -1), (-1, 0, 1), (1, 0, 1), (-1, 0.125, 1)],
        triangles: [(0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (0, 3, 5), (0, 5, 2), (0, 2, 1), (3, 4, 5)])";
    let mut dark = Vec::new();
    for (name, mesh) in [("cube", cube), ("octahedron", octahedron), ("wedge", wedge)] {
        for eye in [
            "(5, 5, 0)",
            "(0, 5, 5)",
            "(5, 5, 5)",
            "(0, 0, 5)",
            "(5, 0, 0)",
            "(5, 3, 0)",
            "(0, 8, 0)",
            "(5, 0, 5)",
        ] {
            for (place, scale) in [("(0, 0, 0)", 1.0), ("(3, -7, 11)", 0.3), ("(3, -7, 11)", 0.5)] {
                let text = format!(
                    "(output: (size: (65, 65)), quality: (antialias: 1, bounces: 9), background: 1, ambient: 0,
                    camera: (position: {eye}, up: (0, 1, 0.001), projection: Orthographic(height: 4.0625)),
                    objects: {{ \"glass\": (shape: {mesh}, translation: {place}, pivot: (0, 0, 0), scale: {scale},
                        material: (ambient: 0, diffuse: 0, refraction: 1, ior: 1, absorption: 0.01)) }})"
                );
                // The camera goes with the mesh.
                let text = if scale == 1.0 {
                    text
                } else {
                    text.replace("camera: (", "camera: (target: (3, -7, 11), ")
                        .replace(&format!("position: {eye}"), &format!("position: {}", moved(eye)))
                };
                let film = &shoot_all(&text)[0].film;
                let count = film.radiance().filter(|pixel| pixel.x < 0.9).count();
                if count > 0 {
                    dark.push(format!("{count} pixels of the {name} from {eye} at {place}"));
                }
            }
        }
    }
    assert!(dark.is_empty(), "{}", dark.join("\n"));
}

/// An eye moved with a mesh to (3, -7, 11).
fn moved(eye: &str) -> String {
    let parts: Vec<f64> =
        eye.trim_matches(['(', ')']).split(", ").map(|part| part.parse().expect("a number")).collect();
    format!("({:?}, {:?}, {:?})", parts[0] + 3.0, parts[1] - 7.0, parts[2] + 11.0)
}
