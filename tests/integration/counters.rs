//! Work is done when it is called for, and once: trees, packing and rays are counted exactly.

use crate::support::{Shot, Work, shoot_all, shoot_all_in};

/// A sequence of `frames` frames of 16x12 pixels with keys in frames, a floor, a ball and a light. The rest may
/// name fields again that come before `objects`.
fn ball(frames: u32, fields: &str, light: &str, material: &str, object: &str) -> Vec<Shot> {
    shoot_all(&format!(
        r#"(timeline: (frames: {frames}, keys: Frames), output: (size: (16, 12)), quality: (antialias: 1), {fields}
        lights: {{ "lamp": Point({light}) }}, materials: {{ "m": ({material}) }},
        objects: {{
            "floor": (shape: Plane(point: (0, -1, 0))), "ball": (shape: Sphere(), material: "m", {object}),
        }})"#
    ))
}

const LAMP: &str = "position: (3, 4, 5)";

/// Trees built or refitted, and geometry and shading packed, in each frame. Only the first frame builds a tree.
#[track_caller]
fn made(shots: &[Shot]) -> Vec<(u64, u64, u64)> {
    let builds: Vec<u64> = shots.iter().map(|shot| shot.work.bvh_builds).collect();
    assert_eq!((builds[0], builds.iter().sum()), (1, 1), "{builds:?}");
    let made = |work: &Work| (work.bvh_builds + work.bvh_refits, work.geometry_packs, work.shading_packs);
    shots.iter().map(|shot| made(&shot.work)).collect()
}

/// Asserts that everything is made once, in frame 0, and later only what `later` says, frame by frame.
#[track_caller]
fn made_anew(shots: &[Shot], later: &[(u64, u64, u64)]) {
    assert_eq!(made(shots), [&[(1, 1, 1)], later].concat());
}

const NOTHING: (u64, u64, u64) = (0, 0, 0);
const GEOMETRY: (u64, u64, u64) = (1, 1, 0);
const SHADING: (u64, u64, u64) = (0, 0, 1);

#[test]
fn a_hundred_still_frames_build_one_tree() {
    made_anew(&ball(100, "", LAMP, "", ""), &[NOTHING; 99]);
}

#[test]
fn animated_light_weights_rebuild_nothing() {
    let on = "on: [(0, true), (1, false), (3, true)]";
    let intensity = "intensity: [(0, 1), (4, 0)]";
    let color = "color: [(0, (1, 0, 0)), (4, (0, 0, 1))]";
    for keys in [on, intensity, color, &[on, intensity, color].join(", ")] {
        made_anew(&ball(5, "", &format!("{LAMP}, {keys}"), "", ""), &[NOTHING; 4]);
    }
    let glow = "background: [(0, 0), (4, 1)], ambient: [(0, 1), (4, 0)],";
    made_anew(&ball(5, glow, LAMP, "", ""), &[NOTHING; 4]);
    let sky = "background: Gradient(intensity: [(0, 0), (4, 1)]),";
    made_anew(&ball(5, sky, LAMP, "", ""), &[NOTHING; 4]);
}

#[test]
fn animated_skies_are_packed_again() {
    let color = "background: Gradient(bottom: [(0, 0), (2, 1)]),";
    made_anew(&ball(5, color, LAMP, "", ""), &[SHADING, SHADING, NOTHING, NOTHING]);
    let turn = "background: Gradient(up: (1, 0, 0), rotation: [(0, 0), (1, 90), (2, 90)]),";
    made_anew(&ball(5, turn, LAMP, "", ""), &[SHADING, NOTHING, NOTHING, NOTHING]);
}

#[test]
fn animated_cameras_rebuild_nothing() {
    for camera in [
        "camera: (path: Orbit()),",
        "camera: (position: [(0, (0, 1, 5)), (4, (1, 2, 5))], roll: [(0, 0), (4, 90)]),",
        "camera: (path: Zoom(fov: [(0, 45), (4, 10)])),",
        r#"cameras: { "a": (), "b": (position: (5, 1, 0), projection: Orthographic()) }, active_camera: [(0, "a"), (2, "b")],"#,
    ] {
        made_anew(&ball(5, camera, LAMP, "", ""), &[NOTHING; 4]);
    }
}

#[test]
fn moving_objects_refit_the_bvh_once_per_pose() {
    let keys =
        "translation: [(0, (0, 0, 0)), (2, (1, 0, 0)), (4, (1, 0, 0)), (5, (2, 0, 0), Step), (7, (0, 0, 0))]";
    let later = [GEOMETRY, GEOMETRY, NOTHING, NOTHING, GEOMETRY, NOTHING, GEOMETRY, NOTHING];
    made_anew(&ball(9, "", LAMP, "", keys), &later);
    // Turning a ball moves it in its own space at least; a whole turn per frame does not.
    let whole_turns = "rotation: AxisAngle(axis: (0, 1, 0), angle: [(0, 0), (4, 1440)])";
    made_anew(&ball(4, "", LAMP, "", whole_turns), &[NOTHING; 3]);
}

#[test]
fn appearing_and_vanishing_refit_the_tree() {
    let keys = "visible: [(0, true), (2, false), (3, false), (4, true)]";
    made_anew(&ball(6, "", LAMP, "", keys), &[NOTHING, GEOMETRY, NOTHING, GEOMETRY, NOTHING]);
    let scale = "scale: [(0, 1, Step), (2, 0, Step), (3, 1)]";
    made_anew(&ball(5, "", LAMP, "", scale), &[NOTHING, GEOMETRY, GEOMETRY, NOTHING]);
}

#[test]
fn keyed_materials_and_moving_lights_pack_shading_only() {
    for material in [
        "color: [(0, (1, 0, 0)), (2, (0, 1, 0))]",
        "mirror: [(0, 0), (2, 1)]",
        "specular: 1, shininess: [(0, 3), (2, 5)]",
        "specular: [(0, 0), (2, 1)], diffuse: [(0, 0), (2, 1)]",
    ] {
        made_anew(&ball(4, "", LAMP, material, ""), &[SHADING, SHADING, NOTHING]);
    }
    let light = "position: [(0, (3, 4, 5)), (2, (3, 5, 5))]";
    made_anew(&ball(4, "", light, "", ""), &[SHADING, SHADING, NOTHING]);
}

#[test]
fn a_lights_rays_stop_while_it_is_off() {
    let shadow = |light: &str| -> Vec<u64> {
        ball(5, "", light, "", "").iter().map(|shot| shot.work.shadow).collect()
    };
    let lit = shadow(LAMP)[0];
    assert!(lit > 50, "{lit}");
    assert_eq!(shadow(&format!("{LAMP}, on: [(0, true), (1, false), (3, true)]")), [lit, 0, 0, lit, lit]);
    assert_eq!(shadow(&format!("{LAMP}, intensity: [(0, 0, Step), (2, 1), (4, 0)]")), [0, 0, lit, lit, 0]);
    assert_eq!(shadow(&format!("{LAMP}, color: [(0, 0, Step), (2, (0, 0, 1))]")), [0, 0, lit, lit, lit]);
    assert_eq!(shadow(&format!("{LAMP}, on: false")), [0; 5]);
    assert_eq!(shadow(&format!("{LAMP}, shadows: false")), [0; 5]);
}

/// The unit ball alone, seen from +z by an orthographic camera. Returns the samples that hit it, and those that hit
/// it where it faces the light at `light`, by the ball's own formula.
fn samples_on_ball(size: (u32, u32), n: u32, height: f64, light: [f64; 3]) -> (u64, u64) {
    let (mut hits, mut facing) = (0, 0);
    for py in 0..size.1 * n {
        for px in 0..size.0 * n {
            let scale = height / f64::from(size.1 * n);
            let x = (f64::from(px) + 0.5 - 0.5 * f64::from(size.0 * n)) * scale;
            let y = (0.5 * f64::from(size.1 * n) - f64::from(py) - 0.5) * scale;
            let square = 1.0 - x * x - y * y;
            if square > 0.0 {
                let p = [x, y, square.sqrt()];
                hits += 1;
                facing += u64::from(p.iter().zip(light).map(|(p, l)| p * (l - p)).sum::<f64>() > 0.0);
            }
        }
    }
    (hits, facing)
}

#[test]
fn ga_02_a_matte_ball_takes_a_camera_ray_per_sample_and_a_shadow_ray_per_facing_light() {
    let lights = [[3.0, 4.0, 5.0], [0.0, 0.0, -8.0], [-9.0, 1.0, 0.5]];
    for n in [1, 2, 3] {
        for (count, lights) in (0..=3).map(|count| (count, &lights[..count])) {
            let text: String = lights
                .iter()
                .enumerate()
                .map(|(k, [x, y, z])| format!("\"{k}\": Point(position: ({x}, {y}, {z})),"))
                .collect();
            let shots = shoot_all(&format!(
                r#"(output: (size: (23, 17)), quality: (antialias: {n}, bounces: 9), lights: {{ {text} }},
                camera: (position: (0, 0, 9), projection: Orthographic(height: 2.7)),
                objects: {{ "ball": (shape: Sphere(), material: (color: 1)) }})"#
            ));
            let shadow = lights.iter().map(|light| samples_on_ball((23, 17), n, 2.7, *light).1).sum();
            let expected = Work { camera: u64::from(23 * 17 * n * n), mirror: 0, shadow, ..shots[0].work };
            assert_eq!(shots[0].work, expected, "{count} lights, {n} x {n} samples");
            assert!(count == 0 || shadow > 0);
        }
    }
}

#[test]
fn ga_02_mirror_rays_are_as_many_as_mirrors_call_for() {
    let mirror_rays = |bounces: u32, material: &str| {
        let shots = shoot_all(&format!(
            r#"(output: (size: (23, 17)), quality: (antialias: 1, bounces: {bounces}),
            camera: (position: (0, 0, 9), projection: Orthographic(height: 2.7)),
            objects: {{ "ball": (shape: Sphere(), material: ({material})) }})"#
        ));
        shots[0].work.mirror
    };
    // A convex mirror is hit once per sample that meets it; every such ray then leaves.
    let hits = samples_on_ball((23, 17), 1, 2.7, [0.0; 3]).0;
    assert_eq!(mirror_rays(1, "mirror: 0.5"), hits);
    assert_eq!(mirror_rays(9, "mirror: 0.5"), hits);
    assert_eq!(mirror_rays(0, "mirror: 0.5"), 0);
    assert_eq!(mirror_rays(9, "mirror: 0"), 0);
    assert_eq!(mirror_rays(9, "mirror: 1, mirror_color: 0"), 0);
    assert_eq!(mirror_rays(9, "specular: 1"), 0);
}

#[test]
fn ga_02_no_light_means_no_shadow_rays() {
    for fields in ["", r#"lights: { "off": Point(position: (0, 5, 5), on: false) },"#] {
        let shots = shoot_all(&format!(
            r#"(output: (size: (8, 6)), {fields} objects: {{ "b": (shape: Sphere()) }})"#
        ));
        assert_eq!((shots[0].work.shadow, shots[0].work.mirror), (0, 0));
    }
    // A surface that reflects no light needs none to be traced to it.
    let black = r#"(output: (size: (8, 6)), lights: { "l": Point(position: (0, 5, 5)) },
        objects: { "b": (shape: Sphere(), material: (diffuse: 0)) })"#;
    assert_eq!(shoot_all(black)[0].work.shadow, 0);
}

/// As many primitives are rewritten as change: a row of balls, some of which move, appear or shine.
#[test]
fn only_primitives_that_change_are_rewritten() {
    let balls: String = (0..40)
        .map(|k| {
            let keys = match k {
                3 | 17 | 29 => "translation: [(0, (0, 0, 0)), (2, (0, 1, 0))]",
                5 => "visible: [(0, true), (2, false), (3, true)]",
                _ => "",
            };
            format!("\"{k}\": (shape: Sphere(center: ({k}, 0, 0), radius: 0.4), {keys}),")
        })
        .collect();
    let shots = shoot_all(&format!(
        r#"(timeline: (frames: 5, keys: Frames), output: (size: (8, 6)), quality: (antialias: 1),
        lights: {{ "lamp": Sphere(center: [(0, (0, 9, 0)), (1, (0, 8, 0))], radius: 1) }}, objects: {{ {balls} }})"#
    ));
    let packed: Vec<u64> = shots.iter().map(|shot| shot.work.primitives_packed).collect();
    assert_eq!(packed, [41, 4, 4, 1, 0]);
    let trees: Vec<_> = shots.iter().map(|shot| (shot.work.bvh_builds, shot.work.bvh_refits)).collect();
    assert_eq!(trees, [(1, 0), (0, 1), (0, 1), (0, 1), (0, 0)]);
}

/// A mesh that turns is placed anew: its triangles and its own tree stay as they are.
#[test]
fn a_mesh_that_turns_is_one_primitive() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let mut obj = String::new();
    for k in 0..=100 {
        for l in 0..=100 {
            obj += &format!("v {} {} {}\n", k - 50, l - 50, (k * l) % 7);
        }
    }
    for (k, l) in (0..100).flat_map(|k| (0..100).map(move |l| (101 * k + l + 1, 101 * k + l + 102))) {
        obj += &format!("f {k} {l} {}\nf {k} {} {}\n", l + 1, l + 1, k + 1);
    }
    std::fs::write(folder.path().join("grid.obj"), obj).expect("a disk");
    let shots = shoot_all_in(
        folder.path(),
        r#"(timeline: (frames: 4, keys: Frames), output: (size: (8, 6)), quality: (antialias: 1),
        objects: { "grid": (shape: Mesh(file: "grid.obj"), scale: 0.02,
            rotation: AxisAngle(axis: (0, 1, 0), angle: [(0, 0), (3, 30)])) })"#,
    );
    let packed: Vec<u64> = shots.iter().map(|shot| shot.work.primitives_packed).collect();
    assert_eq!((packed, shots[3].work.bvh_builds, shots[3].work.bvh_refits), (vec![1; 4], 0, 1));
}

/// What is not seen may move, and what is seen may turn in its own shape, without a tree.
#[test]
fn invisible_motion_builds_no_bvh() {
    let keys = "translation: [(0, (0, 0, 0)), (4, (1, 0, 0))]";
    for object in [
        format!(r#""group": (shape: Group, {keys})"#),
        format!(r#""hidden": (shape: Sphere(), visible: false, {keys})"#),
        format!(r#""flat": (shape: Sphere(), scale: [(0, 0)], {keys})"#),
    ] {
        let shots = shoot_all(&format!(
            r#"(timeline: (frames: 5, keys: Frames), output: (size: (8, 6)),
            objects: {{ "ball": (shape: Sphere()), {object} }})"#
        ));
        let updates =
            |shot: &Shot| (shot.work.bvh_builds + shot.work.bvh_refits, shot.work.primitives_packed);
        let updates: Vec<_> = shots.iter().map(updates).collect();
        assert_eq!(updates, [(1, 1), (0, 0), (0, 0), (0, 0), (0, 0)], "{object}");
    }
}

/// GA-02: what an effect asks for is counted, and exactly none of it without the effect. GA-01: of zero strength it
/// gives the same picture, with the same work, as none.
#[test]
fn ga_01_ga_02_unused_effects_take_no_work() {
    let shot = |integrator: &str, fields: &str, light: &str, material: &str| {
        let text = format!(
            r#"(timeline: (frames: 1), output: (size: (16, 12)), quality: ({integrator} samples: 2, bounces: 3), {fields}
            lights: {{ {light} }}, objects: {{
                "floor": (shape: Plane(point: (0, -1, 0))), "ball": (shape: Sphere(), material: {material}),
            }})"#
        );
        let sequence = crate::support::sequence(&text);
        let mut shots = crate::support::shoot(&sequence, [0]);
        shots.pop().expect("a shot")
    };
    const LAMP: &str = r#""lamp": Point(position: (3, 4, 5))"#;
    const AREA: &str = r#""lamp": Sphere(center: (3, 4, 5), radius: 0.5)"#;
    for integrator in ["", "integrator: Path,"] {
        let plain = shot(integrator, "", LAMP, "(color: 0.5)");
        let none = plain.work;
        assert_eq!((none.fog, none.paint, none.light_samples, none.lens_samples), (0, 0, 0, 0));
        assert_eq!((none.mirror, none.transmitted), (0, 0));
        let with = |fields: &str, light: &str, material: &str| shot(integrator, fields, light, material).work;
        assert!(with("fog: (density: 0.1),", LAMP, "()").fog > 0);
        // Light that diffuse lobes reflect comes through no fog: that of the ways of paths is all that counts.
        let matte = with("fog: (density: 0.1),", LAMP, "(color: 0.5)");
        assert_eq!(matte.fog, matte.camera + matte.scattered, "{integrator}");
        assert!(with("", LAMP, "(color: Checker())").paint > 0);
        assert!(with("", AREA, "()").light_samples > 0);
        assert!(with("camera: (aperture: 0.1),", LAMP, "()").lens_samples > 0);
        assert!(with("", LAMP, "(mirror: 0.5)").mirror > 0);
        assert!(with("", LAMP, "(transparency: 0.5)").transmitted > 0);
        assert_eq!(with("", "", "(color: 0.5)").shadow, 0);
        for (fields, material) in [
            ("fog: (density: 0, color: 1),", "(color: 0.5)"),
            ("camera: (aperture: 0),", "(color: 0.5)"),
            ("camera: (shutter: 0),", "(color: 0.5)"),
            // Nothing moves while it is open.
            ("camera: (shutter: 1),", "(color: 0.5)"),
            ("", "(color: 0.5, mirror: 0, fuzz: 0.5)"),
            ("", "(color: 0.5, transparency: 0)"),
            ("", "(color: 0.5, emission: 0)"),
            ("", "(color: 0.5, refraction: 0, ior: 1.5, absorption: 1)"),
            ("", "(color: 0.5, specular: 0, specular_color: Checker())"),
        ] {
            let found = shot(integrator, fields, LAMP, material);
            assert!(found.film == plain.film, "{integrator} {fields} {material}");
            assert_eq!(found.work, plain.work, "{integrator} {fields} {material}");
        }
        let off = format!(r#"{LAMP}, "off": Sphere(center: (30, 40, 50), radius: 0.1, intensity: 0)"#);
        let found = shot(integrator, "", &off, "(color: 0.5)");
        // Its shape is one more primitive.
        let work = Work { primitives_packed: none.primitives_packed + 1, ..none };
        assert!(found.film == plain.film && found.work == work, "{integrator} a light without intensity");
    }
}

/// A pattern of one colour is that colour: no paint is asked for, and the picture is the same to the last bit.
#[test]
fn ga_02_constant_paint_is_a_colour() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let texels = [image::Rgb([90u8, 180, 30]); 6].iter().flat_map(|texel| texel.0).collect();
    let even = image::RgbImage::from_raw(3, 2, texels).expect("all texels");
    even.save(folder.path().join("even.png")).expect("a disk");
    let shot = |color: &str| {
        let text = format!(
            r#"(output: (size: (16, 12)), quality: (antialias: 1), lights: {{ "lamp": Point(position: (3, 4, 5)) }},
            objects: {{ "ball": (shape: Sphere(), material: (color: {color}, specular: 0.5, specular_color: {color})) }})"#
        );
        shoot_all_in(folder.path(), &text).remove(0)
    };
    let srgb = "Srgb(90, 180, 30)";
    for (paint, color) in [
        ("Checker(a: 0.3, b: 0.3)", "0.3"),
        ("Checker(a: Stripes(a: 0.3, b: 0.3), b: Noise(a: 0.3, b: 0.3, octaves: 2))", "0.3"),
        ("Image(\"even.png\")", srgb),
        ("Waves(a: Image(\"even.png\"), b: Srgb(90, 180, 30))", srgb),
        ("Image(file: \"even.png\", encoding: Linear, channel: R, tint: 0)", "0"),
        ("Image(file: \"even.png\", wrap: Mirror, scale: 0.1, rotation: 30)", srgb),
        ("Marble(a: [(0, 0.3), (1, 0.5)], b: 0.3)", "0.3"),
    ] {
        let (textured, plain) = (shot(paint), shot(color));
        assert_eq!(textured.work, plain.work, "{paint}");
        assert!(textured.film == plain.film, "{paint}");
    }
    for paint in ["Checker(a: 0.3, b: 0.4)", "VertexColor", "Checker(a: VertexColor, b: VertexColor)"] {
        assert!(shot(paint).work.paint > 0, "{paint}");
    }
}
