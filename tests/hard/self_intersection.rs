//! Rays that start on a surface. SELF-01 stands in `src/trace/tests.rs` and `src/trace/round_tests.rs`.

use crate::exact::Exact;
use crate::support::{Random, U, direction, facing, few, hit, met, placed, shoot_all};
use kinora::appearance::optics::refract;
use kinora::base::math::{DAffine3, DVec3};
use kinora::geometry::mesh::{self, Corners, Normals, generate};
use kinora::geometry::shape::{Geometric, Mesh, Shape, Sphere, Surface};
use kinora::import;
use kinora::trace::spawn::{spawn_lifted, spawn_ray};
use std::sync::Arc;

/// A shell 4e-5 of its size above another one: any fixed offset that is longer skips the inner one.
#[test]
fn self_02_nested_shells() {
    for (scale, integrator) in
        [1.0, 1e-3, 1e3].into_iter().flat_map(|scale| ["Whitted", "Path(roulette: Off)"].map(|i| (scale, i)))
    {
        // Rays within 0.99 of the radius.
        let (side, height) = (512u32, 2.0 * scale);
        let text = format!(
            "(output: (size: ({side}, {side})), quality: (integrator: {integrator}, antialias: 1, samples: 1, bounces: 4),
            ambient: 1, camera: (position: (0, 0, {:?}), projection: Orthographic(height: {height:?})),
            objects: {{
                \"inner\": (shape: Sphere(radius: {scale:?}), material: (color: (1, 0, 0), ambient: 1, diffuse: 0)),
                \"outer\": (shape: Sphere(radius: {:?}), material: Dielectric(ior: 1)),
            }})",
            5.0 * scale,
            scale * (1.0 + 4e-5)
        );
        let film = &shoot_all(&text)[0].film;
        let (mut seen, mut wrong) = (0, 0);
        for (k, pixel) in (0..).zip(film.radiance()) {
            let at = |i: u32| (f64::from(i) + 0.5) / f64::from(side) * 2.0 - 1.0;
            if libm::hypot(at(k % side), at(k / side)) < 0.98 {
                seen += 1;
                wrong += u32::from(pixel.to_array() != [1.0, 0.0, 0.0]);
            }
        }
        assert!(seen > 190_000 && wrong == 0, "{wrong} of {seen} at {scale} by {integrator}");
    }
}

/// A sphere of flat triangles that is shaded as a smooth one.
fn smooth(level: u32) -> Mesh {
    let mut parts = generate::icosphere(level);
    parts.normals = Some(Corners::per_vertex(parts.positions.iter().map(|p| p.as_vec3()).collect()));
    Mesh::new(Arc::new(mesh::TriangleMesh::new(parts).expect("a mesh")), Normals::File)
}

/// Shares of points, lit as on the smooth sphere, that their own triangles shadow: where light is looked for from the
/// triangles, and where from the smooth surface.
fn falsely_shadowed(to_world: DAffine3, level: u32, points: u32) -> [f64; 2] {
    let mesh = smooth(level);
    let primitive = placed(&Shape::Mesh(mesh.clone()), to_world);
    let light = to_world.transform_vector3(DVec3::new(0.3, 0.8, 0.52)).normalize();
    let mut random = Random(3);
    let (mut lit, mut wrong) = (0, [0, 0]);
    while lit < points {
        let drawn: Surface = mesh.sample_area(random.unit(), random.unit()).0.into();
        // Seen from above, a little beside the normal.
        let to_eye = (drawn.normal + direction(&mut random) * 0.5).normalize();
        let (eye, way) =
            (to_world.transform_point3(drawn.point + to_eye), to_world.transform_vector3(-to_eye));
        let Some((_, surface)) = met(&primitive, eye, way.normalize()) else { continue };
        let surface = facing(surface, way);
        if surface.shading.dot(light) <= 0.0 {
            continue;
        }
        lit += 1;
        let gathering = spawn_lifted::<f64>(&(&surface).into(), light.into()).origin;
        for (wrong, origin) in wrong.iter_mut().zip([spawn_ray(&surface, light).origin, gathering.into()]) {
            *wrong += u32::from(hit(&primitive, origin, light).is_some());
        }
    }
    wrong.map(|wrong| f64::from(wrong) / f64::from(lit))
}

/// The shadow terminator of coarse meshes: 5.1, 2.6, 1.6 and 0.8 % of what is lit are shadowed by flat triangles.
#[test]
fn self_03_the_shadow_terminator_of_coarse_meshes() {
    let naive = [0.0513, 0.0263, 0.0155, 0.0081];
    for (level, naive) in (1..).zip(naive) {
        // Fewer points would scatter by more than the limit.
        let points = few(1_000_000).max(40_000);
        let [without, with] = falsely_shadowed(DAffine3::IDENTITY, level, points);
        assert!((without / naive - 1.0).abs() < 0.15, "level {level} without: {without}");
        assert!(with <= 5e-4, "level {level}: {with}");
    }
    // Far away, tiny, and as an ellipsoid.
    let turn = DAffine3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 1.0);
    for to_world in [
        DAffine3::from_translation(DVec3::new(0.6, 0.64, 0.48) * 1e6),
        turn * DAffine3::from_scale(DVec3::splat(1e-6)),
        turn * DAffine3::from_scale(DVec3::new(3.0, 1.0, -0.5)) * turn,
    ] {
        let [_, with] = falsely_shadowed(to_world, 2, few(100_000));
        assert!(with <= 5e-4, "{to_world}: {with}");
    }
}

/// Through the renderer: with the option, a coarse sphere is lit where a smooth one is; without it, the test prints how many pixels are dark.
#[test]
fn self_03_with_the_option_and_without() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let file = std::fs::File::create(folder.path().join("ball.ply")).expect("a file");
    import::ply::write(file, &generate::icosphere(2)).expect("a disk");
    let dark = |quality: &str| {
        let text = format!(
            "(output: (size: (96, 96)), quality: (antialias: 1, samples: 16, {quality}), ambient: 0,
            camera: (position: (0, 0, 5), projection: Orthographic(height: 2)),
            lights: {{ \"sun\": Directional(direction: (-0.6, -0.8, 0)) }},
            objects: {{ \"ball\": (shape: Mesh(file: {:?}, normals: Smooth)) }})",
            folder.path().join("ball.ply")
        );
        let film = &shoot_all(&text)[0].film;
        let mut dark = 0;
        for (k, pixel) in (0u32..).zip(film.radiance()) {
            let at = |i: u32| (f64::from(i) + 0.5) / 48.0 - 1.0;
            let (x, y) = (at(k % 96), -at(k / 96));
            // Well within the outline and the lit half of the smooth sphere.
            dark += u32::from(libm::hypot(x, y) < 0.9 && 0.6 * x + 0.8 * y > 0.04 && pixel.x == 0.0);
        }
        dark
    };
    for integrator in ["Whitted", "Path"] {
        assert_eq!(dark(&format!("integrator: {integrator}")), 0);
        let off = dark(&format!("integrator: {integrator}, smooth_terminator: false"));
        assert!(off > 0, "{off} points in shadow without the option");
    }
}

/// What a ray does at the two interfaces of a glass sphere, and where it leaves.
fn through_glass(radius: f64, center: DVec3) -> (Vec<Surface>, DVec3) {
    let ball = placed(&Shape::Sphere(Sphere { center, radius }), DAffine3::IDENTITY);
    let (mut origin, mut d) = (center + DVec3::new(-5.0, 0.5, 0.0) * radius, DVec3::X);
    let mut events = Vec::new();
    while let Some((_, surface)) = met(&ball, origin, d) {
        let entering = surface.normal.dot(d) < 0.0;
        let eta = if entering { 1.5 } else { 1.0 / 1.5 };
        let bent = refract::<f64>(d.into(), facing(surface, d).normal.into(), eta);
        assert!(!bent.is_total, "passes");
        d = bent.direction.into();
        origin = spawn_ray(&surface, d).origin;
        events.push(surface);
        assert!(events.len() < 9, "caught inside");
    }
    (events, d)
}

/// SH-08 is the sphere of radius 1 among these: the outward normal on both sides, or one interface alone, is off by 7
/// degrees. An offset of 1e-3 loses the exit of the smallest.
#[test]
fn self_05_sh_08_two_interfaces_of_a_glass_sphere() {
    // In closed form: sin a = 1/2, sin b = 1/3, and the deviation is 2 (a - b).
    let (cos_a, cos_b) = ((Exact::from(0.75)).sqrt(), (Exact::from(8.0) / Exact::from(9.0)).sqrt());
    let (sin_a, sin_b) = (Exact::from(0.5), Exact::from(1.0) / Exact::from(3.0));
    let two = Exact::from(2.0);
    let (sine, cosine) = (sin_a * cos_b - cos_a * sin_b, cos_a * cos_b + sin_a * sin_b);
    let way = [cosine * cosine - sine * sine, -(two * sine * cosine)].map(Exact::value);
    assert!((way[0] - 0.933_219_942_840_706).abs() < 1e-15 && (way[1] + 0.359_305_633_527_209).abs() < 1e-15);
    for radius in [4e-4, 6e-4, 1e-3, 1.0, 1e3, 1e-20, 1e20] {
        let (events, d) = through_glass(radius, DVec3::ZERO);
        assert_eq!(events.len(), 2, "interfaces at {radius}");
        let off = (d - DVec3::new(way[0], way[1], 0.0)).length();
        assert!(off <= 32.0 * U, "direction off by {} u at {radius}", off / U);
        let exit = DVec3::new(0.987_844_994_581_918, 0.155_442_165_062_928, 0.0) * radius;
        let off = (events[1].point - exit).length();
        // The printed digits of the exit are good to 5e-16.
        assert!(off <= 32.0 * U * radius, "exit off by {} u r at {radius}", off / U / radius);
        let chord = (events[1].point - events[0].point).length() / radius;
        assert!((chord - 1.885_618_083_164_127).abs() <= 32.0 * U, "{chord}");
    }
    // Far from the origin two interfaces are two as well.
    for radius in [1e-3, 1.0, 1e3] {
        assert_eq!(through_glass(radius, DVec3::new(0.6, 0.64, 0.48) * 1e6).0.len(), 2);
    }
}

/// The integrators meet both interfaces as well: two rays are sent on for every one of the camera.
#[test]
fn self_05_integrators_meet_both_interfaces() {
    for radius in [4e-4, 6e-4, 1e-3, 1.0, 1e3] {
        let shot = &shoot_all(&format!(
            "(output: (size: (64, 64)), quality: (antialias: 1), background: 1,
            camera: (position: (0, 0, {:?}), projection: Orthographic(height: {:?})),
            objects: {{ \"ball\": (shape: Sphere(radius: {radius:?}),
                material: (ambient: 0, diffuse: 0, refraction: 1)) }})",
            9.0 * radius,
            1.4 * radius
        ))[0];
        assert_eq!(shot.work.transmitted, 2 * shot.work.camera, "{radius}");
    }
}
