//! What the two integrators make of every kind of light and surface, where its radiance is known.

use crate::support::{Shot, shoot_all, shoot_film};
use kinora::base::color::Rgb;

const PATH: &str = "Path()";
const BOTH: [&str; 2] = ["Whitted", PATH];

/// The one pixel of a picture that looks from (0, 2, 0) straight down to the origin.
fn down(integrator: &str, samples: u32, fields: &str) -> Shot {
    let text = format!(
        "(output: (size: (1, 1)), ambient: 0, quality: (integrator: {integrator}, samples: {samples}, bounces: 40),
        camera: (position: (0, 2, 0), up: (0, 0, -1), projection: Perspective(fov: 0.001)), {fields})"
    );
    shoot_all(&text).remove(0)
}

#[track_caller]
fn near(shot: &Shot, expected: impl Into<[f32; 3]>, tolerance: f32) {
    let (found, expected) = (shot.pixel(0, 0), Rgb::from_array(expected.into()));
    assert!((found - expected).abs().max_element() <= tolerance, "{found} instead of {expected}");
}

/// Whether a scene seen from above has this radiance.
#[track_caller]
fn sends(integrator: &str, samples: u32, scene: &str, expected: f32, tolerance: f32) {
    let found = down(integrator, samples, scene).pixel(0, 0);
    let off = (found - Rgb::splat(expected)).abs().max_element();
    assert!(off <= tolerance, "{integrator}, {scene}: {found} instead of {expected}");
}

/// A closed white room of light: a surface that absorbs nothing looks like it.
#[test]
fn white_objects_vanish_in_a_furnace() {
    for material in [
        "Lambertian(color: 1)",
        "Metal(color: 1)",
        "Dielectric()",
        "Dielectric(fresnel: Schlick, ior: 2.4)",
        "Dielectric(fresnel: Off)",
        "(diffuse: 0, mirror: 0.25, transparency: 0.25, refraction: 0.5, fresnel: Exact)",
    ] {
        let ball = format!(
            r#"background: 1, objects: {{ "ball": (shape: Sphere(center: (0.3, 0, 0.2)), material: {material}) }}"#
        );
        near(&down("Path(roulette: Off)", 64, &ball), [1.0; 3], 1e-5);
    }
}

/// SH-06 and its like: a boundary reflects its share of what is above and lets the rest of what is below pass.
#[test]
fn boundaries_split_light_by_fresnels_share() {
    let floor = |lobes: &str| {
        format!(
            r#"background: Gradient(bottom: (0, 1, 0), top: (1, 0, 0)), objects: {{ "floor": (shape: Plane(),
            material: (ambient: 0, diffuse: 0, fresnel: Exact, ior: 1.5, {lobes})) }}"#
        )
    };
    for integrator in BOTH {
        near(&down(integrator, 4096, &floor("refraction: 1")), [0.04, 0.96, 0.0], 1e-3);
        // Other lobes beside it change nothing.
        let beside = floor("refraction: 0.5, transparency: 0.5");
        near(&down(integrator, 4096, &beside), [0.02, 0.98, 0.0], 1e-3);
        let beside = floor("refraction: 0.25, mirror: 0.5");
        near(&down(integrator, 4096, &beside), [0.51, 0.24, 0.0], 1e-3);
    }
}

/// A pane that neither bends nor reflects is not there, whichever way light finds through it.
#[test]
fn panes_without_effect_change_nothing() {
    const PANE: &str = r#""pane": (shape: Box(min: (-9, 0.5, -9), max: (9, 0.6, 9)),
        material: Dielectric(ior: 1, fresnel: Off)),"#;
    const LAMP: &str =
        r#"lights: { "lamp": Rectangle(corner: (-1, 3, -1), u: (2, 0, 0), v: (0, 0, 2), intensity: 3) }"#;
    for integrator in ["Whitted", "Path(roulette: Off)", "Path(refractive_shadows: true)"] {
        for material in ["Lambertian()", "MetallicRoughness(roughness: 0.5, color: 0.7)", "Metal(fuzz: 0.5)"]
        {
            for light in ["background: 0.5", "background: Gradient()", LAMP] {
                let scene = |pane: &str| {
                    format!(
                        r#"{light}, objects: {{ {pane} "floor": (shape: Plane(), material: {material}) }}"#
                    )
                };
                let (without, with) =
                    (down(integrator, 8192, &scene("")), down(integrator, 8192, &scene(PANE)));
                let (a, b) = (without.pixel(0, 0), with.pixel(0, 0));
                let off = (a - b).abs().max_element();
                assert!(off <= 0.03 * a.max_element(), "{integrator} {material} {light}: {b} instead of {a}");
            }
        }
    }
}

/// Rays that are counted are followed.
#[test]
fn the_last_surface_of_a_path_sends_no_ray() {
    for (bounces, scattered) in [(0, 0), (1, 256), (2, 256)] {
        let text = format!(
            r#"(output: (size: (16, 16)), quality: (integrator: Path(), samples: 1, bounces: {bounces}),
            camera: (position: (0, 2, 0), up: (0, 0, -1), projection: Perspective(fov: 10)),
            objects: {{ "floor": (shape: Plane(), material: Lambertian()) }})"#
        );
        let work = shoot_all(&text)[0].work;
        assert_eq!((work.camera, work.scattered, work.shadow), (256, scattered, 0), "{bounces} bounces");
    }
}

/// Scenes with what they send up to the camera, whichever integrator looks.
#[test]
fn both_integrators_agree_with_closed_forms() {
    const FLOOR: &str = r#"objects: { "floor": (shape: Plane(), material: Lambertian(color: 1)) }"#;
    let lit = |light: &str| format!(r#"lights: {{ "l": {light} }}, {FLOOR}"#);
    let object = |object: &str| format!(r#"background: 1, objects: {{ "o": ({object}) }}"#);
    let pane = |material: &str| {
        object(&format!("shape: Box(min: (-9, 0, -9), max: (9, 0.5, 9)), material: {material}"))
    };
    let e = libm::exp;
    for (scene, expected) in [
        // Lights above the point, at distance 4, each with the share that arrives.
        (lit("Point(position: (0, 4, 0), intensity: 3)"), 3.0),
        (lit("Point(position: (0, 4, 0), attenuation: (constant: 1, linear: 0.25, quadratic: 0.125))"), 0.25),
        (lit("Point(position: (0, 4, 0), attenuation: (constant: 0, quadratic: 0.01))"), 1.0),
        (lit("Spot(position: (0, 4, 0), angle: 10)"), 1.0),
        (lit("Spot(position: (0, 4, 3), target: (0, 0, 3), angle: 70)"), 0.0),
        // 36.87 degrees from its axis, which points straight down.
        (lit("Spot(position: (0, 4, 3), target: (0, 0, 3), angle: 80, inner_angle: 76)"), 0.8),
        (lit("Directional(direction: (3, -4, 0))"), 0.8),
        // A sphere seen from the floor: (radius / distance)².
        (lit("Sphere(center: (0, 5, 0), radius: 2, intensity: 2)"), 0.32),
        // Nothing comes from the back of what shines to the other side.
        (lit("Rectangle(corner: (-1, 4, -1), u: (2, 0, 0), v: (0, 0, 2))"), 0.073_477_67),
        (lit("Rectangle(corner: (-1, 4, -1), u: (2, 0, 0), v: (0, 0, 2), one_sided: true)"), 0.073_477_67),
        (lit("Rectangle(corner: (-1, 4, -1), u: (0, 0, 2), v: (2, 0, 0), one_sided: true)"), 0.0),
        // Light through surfaces: twice through a closed one.
        (object("shape: Sphere(), material: (ambient: 0, diffuse: 0, transparency: 0.5)"), 0.25),
        (object("shape: Disk(), material: (ambient: 0, diffuse: 0, transparency: 0.5)"), 0.5),
        (pane("Dielectric(ior: 1, fresnel: Off, absorption: 2)"), e(-1.0)),
        (pane("Dielectric(ior: 1, fresnel: Off, color: 0.5)"), 0.25),
        (object("shape: Plane(), material: (ambient: 0, diffuse: 0, mirror: 0.5)"), 0.5),
        (object("shape: Plane(), material: (ambient: 0, diffuse: 0, emission: 1.5)"), 1.2),
        (object("shape: Plane(), material: MetallicRoughness(roughness: 0, metallic: 1, color: 0.75)"), 0.75),
        // Fog over two units of length, without end, and thinning out upwards.
        (
            format!(
                "fog: (density: 0.5, color: 1), {}",
                object("shape: Plane(), material: Lambertian(color: 0)")
            ),
            1.0 - e(-1.0),
        ),
        ("fog: (density: 0.01, color: 0.25), background: 1".to_owned(), 0.25),
        (
            format!(
                "fog: (density: 1, color: 1, falloff: (height: 2)), {}",
                object("shape: Plane(), material: Lambertian(color: 0)")
            ),
            1.0 - e(-2.0 * (1.0 - e(-1.0))),
        ),
    ] {
        for integrator in BOTH {
            near(&down(integrator, 4096, &scene), [expected as f32; 3], 4e-3);
        }
    }
}

/// Lamps are asked for light by what they shine on, and met by chance: together they count once.
#[test]
fn glowing_objects_are_lamps_to_paths_alone() {
    for (shape, fields) in [
        ("Sphere", "center: (0, 5, 0), radius: 2"),
        ("Rectangle", "corner: (-1, 4, -1), u: (2, 0, 0), v: (0, 0, 2)"),
        ("Sphere", "center: (0, 2.5, 4), radius: 3.5"),
    ] {
        for material in ["Lambertian(color: 1)", "MetallicRoughness(roughness: 0.4)", "Metal(fuzz: 0.6)"] {
            let scene = |lights: &str, lamp: &str| {
                format!(
                    r#"lights: {{ {lights} }}, objects: {{ {lamp} "floor": (shape: Plane(), material: {material}) }}"#
                )
            };
            let light = scene(&format!(r#""l": {shape}({fields}, intensity: 2)"#), "");
            let glow = scene(
                "",
                &format!(
                    r#""l": (shape: {shape}({fields}), material: (color: 1, ambient: 0, diffuse: 0, emission: 2)),"#
                ),
            );
            // One bounce: the floor, and what it sees of the lamp.
            let of = |integrator: &str, scene: &str| down(integrator, 4096, scene).pixel(0, 0);
            let (whitted, path, object) = (of("Whitted", &light), of(PATH, &light), of(PATH, &glow));
            let off = (whitted - path).abs().max_element().max((path - object).abs().max_element());
            assert!(off <= 0.03 * path.max_element(), "{shape} {material}: {whitted} {path} {object}");
            if material.starts_with("Lambertian") {
                assert_eq!(of("Whitted", &glow), Rgb::ZERO, "Whitted's integrator only shows that they glow");
            }
        }
    }
}

/// A shutter that is open the whole frame sees half of what is there for half of it.
#[test]
fn moments_share_a_frame() {
    for integrator in BOTH {
        for (shutter, expected) in [(0.0, 1.0), (0.25, 1.0), (0.5, 1.0), (1.0, 0.5), (0.75, 2.0 / 3.0)] {
            let text = format!(
                r#"(timeline: (frames: 2, keys: Frames), output: (size: (2, 2)), ambient: 0,
                quality: (integrator: {integrator}, samples: 1024, shutter_steps: 24),
                camera: (position: (0, 2, 0), up: (0, 0, -1), shutter: {shutter:?}),
                objects: {{ "o": (shape: Plane(), visible: [(0, true), (0.5, false)],
                    material: (color: 1, ambient: 0, diffuse: 0, emission: 1)) }})"#
            );
            let found = shoot_all(&text)[0].pixel(0, 0).x;
            assert!(
                (found - expected).abs() <= 2e-3,
                "{integrator} {shutter}: {found} instead of {expected}"
            );
        }
    }
}

/// Fog dims what is seen, not what shines on a surface: however its light was found, that is one and the same.
#[test]
fn fog_leaves_light_on_surfaces_as_it_is() {
    // From a height of 2, on a white floor.
    let left = libm::exp(-2.0 * 0.3) as f32;
    for (light, bright) in [
        (r#"lights: { "sun": Sphere(center: (0, 6, 0), radius: 3) }, objects: {"#, 0.25),
        ("background: 0.5, objects: {", 0.5),
        ("background: Gradient(bottom: 0.5, top: 0.5), objects: {", 0.5),
        (
            r#"objects: { "lamp": (shape: Sphere(center: (0, 6, 0), radius: 3), material: (emission: 1, color: 1, diffuse: 0)),"#,
            0.25,
        ),
    ] {
        let scene = |fog: &str| {
            format!(r#"{fog} {light} "floor": (shape: Plane(), material: Lambertian(color: 1)) }}"#)
        };
        near(&down("Path(roulette: Off)", 4096, &scene("")), [bright; 3], 0.004);
        let foggy = down("Path(roulette: Off)", 4096, &scene("fog: (density: 0.3, color: 0),"));
        near(&foggy, [bright * left; 3], 0.004);
    }
}

/// Light that a surface within glass asks for passes no less glass than light that it meets.
#[test]
fn media_absorb_the_light_within_them() {
    let pool = |lamp: &str| {
        format!(
            r#"lights: {{ {lamp} }}, objects: {{
                "glass": (shape: Box(min: (-50, -0.5, -50), max: (50, 1.5, 50)),
                          material: (ambient: 0, diffuse: 0, refraction: 1, ior: 1, absorption: (1, 0.5, 0))),
                "floor": (shape: Rectangle(corner: (-9, 0, 9), u: (18, 0, 0), v: (0, 0, -18)),
                          material: Lambertian(color: 1)) }}"#
        )
    };
    // One length down from the light, one up to the surface, and a half more to there.
    let lamp = r#""lamp": Point(position: (0, 1, 0))"#;
    let expected = |absorption: f32| libm::expf(-absorption * (1.0 + 1.5));
    for integrator in BOTH {
        near(&down(integrator, 64, &pool(lamp)), [expected(1.0), expected(0.5), 1.0], 1e-4);
    }
}

/// A glowing ball is seen through itself: its far side shines through the near one, and no shadow ray asks for that.
#[test]
fn far_sides_of_clear_lamps_shine() {
    // The ball fills a quarter of what the floor sees, by the cosine.
    let scene = |material: &str| {
        format!(
            r#"objects: {{ "floor": (shape: Plane(), material: Lambertian(color: 1)),
                "lamp": (shape: Sphere(center: (0, 6, 0), radius: 3),
                         material: (color: 1, ambient: 0, diffuse: 0, emission: 1, ior: 1, {material})) }}"#
        )
    };
    for integrator in ["Path(roulette: Off)", "Path(roulette: Off, refractive_shadows: true)"] {
        for material in ["transparency: 0.9", "refraction: 0.9", "transparency: 0.5, refraction: 0.4"] {
            sends(integrator, 16_384, &scene(material), 0.25 * 1.9, 5e-3);
        }
    }
}

/// Fog that leaves nothing of what is seen does not end a path that light is still to come along.
#[test]
fn thick_fog_does_not_end_diffuse_paths() {
    let text = format!(
        r#"(output: (size: (1, 1)), ambient: 0, quality: (integrator: {PATH}, samples: 256, bounces: 8),
        camera: (position: (0, 0.01, 0), up: (0, 0, -1), projection: Perspective(fov: 0.001)),
        background: 1, fog: (density: 50, color: 0), objects: {{
            "floor": (shape: Plane(), material: Lambertian(color: 1)),
            "pane": (shape: Plane(point: (0, 3, 0)), material: (ambient: 0, diffuse: 0, transparency: 1)) }})"#
    );
    near(&shoot_all(&text)[0], [libm::expf(-0.5); 3], 1e-5);
}

/// What a mirror shows is dimmed by the fog before it and gets its glow, however smooth the mirror is.
#[test]
fn fog_attenuates_reflections_of_rough_mirrors() {
    let scene = |light: &str, material: &str| {
        format!(
            r#"fog: (density: 0.3, color: 0.5), {light} "floor": (shape: Plane(), material: {material}) }}"#
        )
    };
    let shown = |way: f32| 0.5 + 0.5 * libm::expf(-0.3 * way);
    for (light, expected) in [
        // Two lengths from the eye to the floor, and three from there to the lamp.
        (r#"lights: { "l": Sphere(center: (0, 6, 0), radius: 3) }, objects: {"#, shown(5.0)),
        (
            r#"objects: { "l": (shape: Sphere(center: (0, 6, 0), radius: 3), material: (emission: 1, color: 1, diffuse: 0)),"#,
            shown(5.0),
        ),
        ("background: Gradient(bottom: 1, top: 1), objects: {", 0.5),
        ("background: 1, objects: {", 0.5),
    ] {
        for material in [
            "Metal(color: 1)",
            "Metal(color: 1, fuzz: 0.0007)",
            "Metal(color: 1, fuzz: 0.0009)",
            "MetallicRoughness(color: 1, metallic: 1, roughness: 0)",
            "MetallicRoughness(color: 1, metallic: 1, roughness: 0.009)",
            "MetallicRoughness(color: 1, metallic: 1, roughness: 0.011)",
        ] {
            for integrator in BOTH {
                // Whitted's integrator only asks for the light of lamps, which finds no narrow reflection.
                if integrator == PATH || !light.starts_with("lights") {
                    sends(integrator, 1024, &scene(light, material), expected, 2e-3);
                }
            }
        }
    }
}

/// Polished surfaces need no random samples. Through a lens there are some, and the surface looks the same.
#[test]
fn polished_surfaces_look_alike_with_and_without_random_samples() {
    for metallic in [0.0, 0.5, 1.0] {
        let seen = |aperture: &str| {
            let film = shoot_film(&format!(
                r#"(timeline: (frames: 1), output: (size: (4, 3)), quality: (antialias: 1, samples: 1),
                camera: (position: (0, 2, 3), target: (0, 0, 0), projection: Perspective(fov: 0.00001), {aperture}),
                background: (0.1, 0.2, 0.4), lights: {{ "l": Directional(direction: (-1, -2, 0.5)) }}, objects: {{
                    "floor": (shape: Plane(), material: MetallicRoughness(
                        roughness: 0, metallic: {metallic}, color: (0.9, 0.6, 0.3))),
                }})"#
            ));
            let pixels: Vec<_> = film.radiance().collect();
            pixels
        };
        let (sharp, through_lens) = (seen(""), seen("aperture: 0.000001"));
        assert_eq!(sharp.len(), 12);
        for (a, b) in sharp.iter().zip(&through_lens) {
            assert!((*a - *b).abs().max_element() <= 1e-6, "metallic {metallic}: {a} {b}");
        }
    }
}

/// Of the light that is asked for, what rough mirrors reflect is dimmed, what is diffuse or a highlight is not.
#[test]
fn fog_dims_the_shine_of_lights_alone() {
    let seen = |integrator: &str, fog: &str, light: &str, material: &str| {
        let scene = format!(
            r#"{fog} lights: {{ "l": {light} }}, objects: {{ "floor": (shape: Plane(), material: {material}) }}"#
        );
        down(integrator, 8192, &scene).pixel(0, 0).x
    };
    let left = |way: f32| libm::expf(-0.3 * way);
    let (point, fog) = ("Point(position: (0, 4, 0))", "fog: (density: 0.3, color: 0),");
    for integrator in BOTH {
        for (material, expected) in [
            ("Lambertian()", left(2.0)),
            ("(ambient: 0, diffuse: 0.2, specular: 0.5)", left(2.0)),
            ("Metal(fuzz: 0.5)", left(6.0)),
            ("MetallicRoughness(metallic: 1, roughness: 0.5)", left(6.0)),
        ] {
            let share = seen(integrator, fog, point, material) / seen(integrator, "", point, material);
            assert!((share - expected).abs() <= 1e-4, "{integrator} {material}: {share}, not {expected}");
        }
    }
    // Both kinds of lobes at once, under lamps that are asked for and met.
    let fog = "fog: (density: 0.3, color: 0.25),";
    for light in ["Sphere(center: (0, 6, 0), radius: 3, intensity: 2)", point] {
        for material in [
            "MetallicRoughness(roughness: 0.3)",
            "(ambient: 0, diffuse: 0.5, mirror: 0.5, fuzz: 0.4)",
            "MetallicRoughness(metallic: 0.5, roughness: 0.7)",
        ] {
            let [whitted, path] = BOTH.map(|integrator| seen(integrator, fog, light, material));
            assert!((whitted - path).abs() <= 0.01 * path, "{light} {material}: {whitted} and {path}");
        }
    }
}

/// Mirrors that are as good as sharp are mirrors.
#[test]
fn the_slightest_fuzz_darkens_no_mirror() {
    let lamp = r#"lights: { "l": Sphere(center: (0, 6, 0), radius: 3) }"#;
    for (integrator, light) in [("Whitted", "background: 1"), (PATH, "background: 1"), (PATH, lamp)] {
        for fuzz in ["0", "1e-30", "1e-20", "1e-16", "1e-12", "1e-6", "0.0007", "0.0009", "0.01"] {
            let floor = format!(r#""floor": (shape: Plane(), material: Metal(color: 1, fuzz: {fuzz}))"#);
            sends(integrator, 256, &format!("{light}, objects: {{ {floor} }}"), 1.0, 1e-3);
        }
    }
}

/// Where smooth normals bend a ray back to the side that it came from, it has not entered what is behind.
#[test]
fn rays_that_smooth_normals_turn_back_enter_no_medium() {
    for integrator in BOTH {
        let text = format!(
            r#"(output: (size: (1, 1)), ambient: 0, background: 1,
            quality: (integrator: {integrator}, samples: 16, bounces: 8),
            camera: (position: (-10, 1, 0), projection: Perspective(fov: 0.001)),
            objects: {{ "m": (shape: Mesh(vertices: [(-1, 0, -1), (-1, 0, 1), (1, 0, 0)],
                normals: [(-0.8, 0.6, 0), (-0.8, 0.6, 0), (-0.8, 0.6, 0)], triangles: [(0, 1, 2)]),
                material: Dielectric(ior: 0.6, fresnel: Off, absorption: 5)) }})"#
        );
        near(&shoot_all(&text)[0], [1.0; 3], 1e-5);
    }
}

/// What light loses in a pane of glass depends on the angle outside, and none is reflected totally.
#[test]
fn panes_shade_by_the_angle_of_the_light() {
    for (sun, share) in [("(0, -1, 0)", 0.9216), ("(1, -1, 0)", 0.9025), ("(1.7320508, -1, 0)", 0.8301)] {
        let scene = |pane: &str| {
            format!(
                r#"lights: {{ "sun": Directional(direction: {sun}) }}, objects: {{ {pane}
                    "floor": (shape: Plane(), material: Lambertian(color: 0.01)) }}"#
            )
        };
        let pane = r#""pane": (shape: Box(min: (-50, 6, -50), max: (50, 6.1, 50)), material: Dielectric()),"#;
        for integrator in ["Whitted", "Path(refractive_shadows: true)"] {
            let seen = |pane: &str| down(integrator, 16, &scene(pane)).pixel(0, 0).x;
            let found = seen(pane) / seen("");
            assert!((found - share).abs() < 1e-3, "{integrator} {sun}: {found} instead of {share}");
        }
    }
}
