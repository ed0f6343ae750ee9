//! Radiance against closed forms, through the whole renderer, before tone mapping.

use crate::support::{radiance_at_target, shoot_all};
use kinora::base::color::Rgb;

/// Asserts that `actual` is `expected` to 1e-6.
#[track_caller]
fn near(actual: Rgb, expected: impl Into<[f64; 3]>) {
    let expected: [f64; 3] = expected.into();
    let off = actual.to_array().into_iter().zip(expected).map(|(a, e)| (f64::from(a) - e).abs());
    assert!(off.fold(0.0, f64::max) <= 1e-6, "{actual} instead of {expected:?}");
}

#[track_caller]
fn near_grey(actual: Rgb, expected: f64) {
    near(actual, [expected; 3]);
}

fn vector([x, y, z]: [f64; 3]) -> String {
    format!("({x:?}, {y:?}, {z:?})")
}

/// `base` to a whole power, the plain way.
fn power(base: f64, exponent: u32) -> f64 {
    (0..exponent).fold(1.0, |product, _| product * base)
}

#[test]
fn lambert_follows_the_cosine() {
    // A light at (0, 4, 0) over the plane y = 0: the cosine at (x, 0, z) is 4 / sqrt(x² + 16 + z²).
    for [x, z] in [[0.0, 0.0], [3.0, 0.0], [0.0, -3.0], [4.0, 7.0], [-1e4, 0.0]] {
        let camera =
            format!("position: {}, target: {}", vector([x + 1.0, 5.0, z + 2.0]), vector([x, 0.0, z]));
        let radiance = radiance_at_target(&format!(
            r#"camera: ({camera}), lights: {{ "l": Point(position: (0, 4, 0), color: (1, 0.5, 0), intensity: 2) }},
            default_material: (color: (0.2, 0.6, 1), ambient: 0, diffuse: 0.5), objects: {{ "p": (shape: Plane()) }}"#
        ));
        let cosine = 4.0 / (x * x + 16.0 + z * z).sqrt();
        near(radiance, [0.2, 0.3, 0.0].map(|c| c * cosine));
    }
}

/// SH-03: a floor under two lights, each of which a small ball may hide.
#[test]
fn overlapping_shadows_fall_to_ambient() {
    let floor = |blockers: &str| {
        radiance_at_target(&format!(
            r#"camera: (position: (0, 1, 5)), default_material: (color: 1, ambient: 0.1, diffuse: 0.5),
            lights: {{ "a": Point(position: (-4, 8, 0)), "b": Point(position: (4, 8, 0)) }},
            objects: {{ "floor": (shape: Plane()), {blockers} }}"#
        ))
    };
    let a = r#""a": (shape: Sphere(center: (-1, 2, 0), radius: 0.5)),"#;
    let b = r#""b": (shape: Sphere(center: (1, 2, 0), radius: 0.5)),"#;
    near_grey(floor(&[a, b].concat()), 0.1);
    near_grey(floor(a), 0.547_213_595_499_958);
    near_grey(floor(b), 0.547_213_595_499_958);
    near_grey(floor(""), 0.994_427_190_999_916);
}

/// SH-01: a floor that only has highlights, with light and eye anywhere.
fn highlight(model: &str, eye: [f64; 3], light: [f64; 3], shift: [f64; 3]) -> Rgb {
    let moved = |p: [f64; 3]| vector([p[0] + shift[0], p[1] + shift[1], p[2] + shift[2]]);
    radiance_at_target(&format!(
        r#"camera: (position: {}, target: {}), lights: {{ "l": Point(position: {}) }},
        default_material: (ambient: 0, diffuse: 0, specular: 1, shininess: 32, highlight: {model}),
        objects: {{ "floor": (shape: Plane(point: {})) }}"#,
        moved(eye),
        moved([10.0, 0.0, 0.0]),
        moved(light),
        moved([0.0; 3]),
    ))
}

#[test]
fn sh_01_highlights_stand_where_they_must_wherever_the_scene_is() {
    let light = [13.0, 4.0, 0.0];
    for shift in [[0.0; 3], [1024.0, -512.0, 256.0]] {
        for model in ["Phong", "BlinnPhong"] {
            near_grey(highlight(model, [7.0, 4.0, 0.0], light, shift), 1.0);
        }
        // From straight above, L = (0.6, 0.8, 0): R·L = 0.8 and N·H = 1.8 / |(0.6, 1.8, 0)|.
        let above = [10.0, 5.0, 0.0];
        near_grey(highlight("Phong", above, light, shift), power(0.8, 32));
        near_grey(highlight("BlinnPhong", above, light, shift), power(1.8 / 3.6_f64.sqrt(), 32));
    }
}

#[test]
fn sh_01_a_moved_scene_gives_the_same_picture() {
    let picture = |[x, y, z]: [f64; 3]| {
        let at = |p: [f64; 3]| vector([p[0] + x, p[1] + y, p[2] + z]);
        let text = format!(
            r#"(output: (size: (32, 24)), camera: (position: {}, target: {}), background: 0.3,
            lights: {{ "l": Point(position: {}) }}, default_material: (specular: 0.5, mirror: 0.3),
            objects: {{
                "floor": (shape: Plane(point: {})), "ball": (shape: Sphere(center: {}, radius: 0.8)),
                "box": (shape: Box(min: {}, max: {})),
            }})"#,
            at([0.5, 2.0, 6.0]),
            at([0.0, 0.6, 0.0]),
            at([3.0, 5.0, 4.0]),
            at([0.0; 3]),
            at([-1.0, 0.8, 0.0]),
            at([0.5, 0.0, -0.5]),
            at([1.5, 1.0, 0.5]),
        );
        shoot_all(&text)[0].film.radiance().collect::<Vec<_>>()
    };
    let (here, there) = (picture([0.0; 3]), picture([1024.0, -512.0, 256.0]));
    let off = here.iter().zip(&there).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max);
    assert!(off <= 1e-6, "differs by {off}");
}

/// Two mirrors face each other: a (1 + m + m² + … + mⁿ) after n bounces, per channel.
#[test]
fn facing_mirrors_sum_a_geometric_series() {
    let mirrors = [0.5, 0.25, 1.0];
    for bounces in [0, 1, 2, 5, 20] {
        // Straight at a mirror, and at an angle.
        for target in ["(0, 0, -1)", "(0.75, 0.5, -1)"] {
            let shots = shoot_all(&format!(
                r#"(output: (size: (1, 1)), quality: (antialias: 1, bounces: {bounces}),
                camera: (position: (0, 0, 0), target: {target}),
                default_material: (color: 1, ambient: 0.125, diffuse: 0, mirror: 1, mirror_color: (0.5, 0.25, 1)),
                objects: {{
                    "before": (shape: Plane(point: (0, 0, -1), normal: (0, 0, 1))),
                    "behind": (shape: Plane(point: (0, 0, 1), normal: (0, 0, 1))),
                }})"#
            ));
            near(
                shots[0].pixel(0, 0),
                mirrors.map(|m| 0.125 * (0..=bounces).map(|k| power(m, k)).sum::<f64>()),
            );
            assert_eq!(shots[0].work.mirror, u64::from(bounces));
        }
    }
}

#[test]
fn ambient_light_alone() {
    let radiance = radiance_at_target(
        r#"ambient: (0.5, 2, 1), default_material: (color: (0.2, 0.4, 0.6), ambient: 0.5, specular: 1, mirror: 0),
        objects: { "p": (shape: Sphere()) }"#,
    );
    near(radiance, [0.05, 0.4, 0.3]);
    // Each part may have a colour of its own.
    let own = r#"ambient: 0.5, default_material: (color: 0, ambient: 1, ambient_color: (1, 0.5, 0.25)),
        objects: { "p": (shape: Sphere()) }"#;
    near(radiance_at_target(own), [0.5, 0.25, 0.125]);
}

#[test]
fn the_background_directly_and_through_mirrors() {
    near(radiance_at_target("background: (0.1, 2, 0.3)"), [0.1, 2.0, 0.3]);
    let floor = r#"background: (0.1, 2, 0.3), objects: { "p": (shape: Plane(), material: (ambient: 0, mirror: 0.5)) }"#;
    near(radiance_at_target(floor), [0.05, 1.0, 0.15]);
    // A corner of two mirrors sends the ray back after two bounces.
    let corner = r#"background: (0.1, 2, 0.3), default_material: (ambient: 0, mirror: 0.5), camera: (position: (5, 3, 0), target: (1, 0, 0)),
        objects: { "p": (shape: Plane()), "q": (shape: Plane(normal: (1, 0, 0))) }"#;
    near(radiance_at_target(corner), [0.025, 0.5, 0.075]);
}

/// What a mirror shows of a lit wall: its Lambert radiance, and whether the light reaches the wall.
#[test]
fn a_lit_wall_in_a_mirror() {
    // The eye at (3, 4, 0) sees the origin of a mirror y = 0; from there the ray meets the wall x = -3 at
    // (-3, 4, 0). The light at (0, 8, 0) makes a cosine of 3 / 5 there.
    let wall = |blocker: &str| {
        radiance_at_target(&format!(
            r#"camera: (position: (3, 4, 0)), lights: {{ "l": Point(position: (0, 8, 0)) }},
            objects: {{
                "mirror": (shape: Plane(), material: (color: 0, mirror: 0.5)),
                "wall": (shape: Plane(point: (-3, 0, 0), normal: (1, 0, 0)), material: (color: 1, ambient: 0.25, diffuse: 0.5)),
                {blocker}
            }}"#
        ))
    };
    near_grey(wall(""), 0.5 * (0.25 + 0.5 * 0.6));
    near_grey(wall(r#""ball": (shape: Sphere(center: (-1.5, 6, 0), radius: 0.5))"#), 0.5 * 0.25);
}

/// BVH-07: only what stands between the point and the light shadows, however far away.
#[test]
fn bvh_07_occluders_before_and_beyond_the_light() {
    let floor = |light: f64, occluder: &str| {
        let radiance = radiance_at_target(&format!(
            r#"camera: (position: (5, 5, 0)), lights: {{ "l": Point(position: (0, {light:?}, 0)) }},
            default_material: (color: 1, ambient: 0.125, diffuse: 0.5),
            objects: {{ "floor": (shape: Plane()), "occluder": (shape: {occluder}) }}"#
        ));
        radiance.x
    };
    let (lit, dark) = (0.625, 0.125);
    assert_eq!(floor(150.0, "Sphere(center: (0, 120, 0))"), dark);
    assert_eq!(floor(150.0, "Sphere(center: (0, 160, 0))"), lit);
    assert_eq!(floor(150.0, "Sphere(center: (0, 149.5, 0))"), dark, "the light is inside");
    assert_eq!(floor(2e5, "Sphere(center: (0, 1e5, 0))"), dark);
    assert_eq!(floor(2e5, "Sphere(center: (0, 2e5, 0), radius: 1e-3)"), dark, "a tiny ball around the light");
    assert_eq!(floor(150.0, "Plane(point: (0, 151, 0))"), lit);
    assert_eq!(floor(150.0, "Plane(point: (0, 149, 0))"), dark);
    assert_eq!(floor(150.0, "Disk(center: (0, 1, 0), radius: 0.01)"), dark);
    assert_eq!(floor(150.0, "Disk(center: (0, -1, 0))"), lit, "behind the surface");
    assert_eq!(floor(150.0, "Disk(center: (0, 1, 0), normal: (1, 0, 0))"), lit, "edge-on");
}

#[test]
fn faces_are_lit_on_the_visible_side() {
    let shapes = [
        "Triangle(a: (-1, 0, -1), b: (0, 0, 2), c: (2, 0, -1))",
        "Triangle(a: (-1, 0, -1), b: (2, 0, -1), c: (0, 0, 2))",
        "Rectangle(corner: (-1, 0, -1), u: (2, 0, 0), v: (0, 0, 2))",
        "Disk()",
        "Plane(normal: (0, -1, 0))",
        "Plane()",
    ];
    for shape in shapes {
        for (eye, light, expected) in [(4.0, 8.0, 0.5), (4.0, -8.0, 0.0), (-4.0, -8.0, 0.5), (-4.0, 8.0, 0.0)]
        {
            let radiance = radiance_at_target(&format!(
                r#"camera: (position: (3, {eye:?}, 0)), lights: {{ "l": Point(position: (0, {light:?}, 0)) }},
                default_material: (color: 1, ambient: 0, diffuse: 0.5), objects: {{ "face": (shape: {shape}) }}"#
            ));
            assert_eq!(radiance, Rgb::splat(expected), "{shape} from {eye}, lit from {light}");
        }
    }
}

#[test]
fn inside_a_sphere_and_a_box() {
    // The wall at (1, 0, 0) seen from the centre; a light at (0, 0.5, 0) makes a cosine of 1 / sqrt(1.25).
    for shape in ["Sphere()", "Box(min: (-1, -1, -1), max: (1, 1, 1))"] {
        let inside = |light: &str| {
            radiance_at_target(&format!(
                r#"camera: (position: (0, 0, 0), target: (1, 0, 0)), lights: {{ "l": Point(position: {light}) }},
                default_material: (color: 1, ambient: 0, diffuse: 1), objects: {{ "hull": (shape: {shape}) }}"#
            ))
        };
        near_grey(inside("(0, 0.5, 0)"), 1.0 / 1.25_f64.sqrt());
        // The light outside reaches no wall inside, on either side.
        near_grey(inside("(3, 0, 0)"), 0.0);
        near_grey(inside("(-3, 0, 0)"), 0.0);
    }
}

#[test]
fn xf_01_ellipsoids_are_lit_by_their_own_normals() {
    // XF-01: the unit sphere's (1, 1, 0) / sqrt 2 under a scale of (2, 1, 1): the normal is (1, 2, 0) / sqrt 5.
    let h = 0.5_f64.sqrt();
    let (point, eye, light) = ([2.0 * h, h, 0.0], [2.0 * h + 1.0, h + 2.0, 0.5], [2.0 * h, h + 10.0, 0.0]);
    let radiance = radiance_at_target(&format!(
        r#"camera: (position: {}, target: {}), lights: {{ "l": Point(position: {}) }},
        default_material: (color: 1, ambient: 0, diffuse: 1),
        objects: {{ "e": (shape: Sphere(), scale: (2, 1, 1)) }}"#,
        vector(eye),
        vector(point),
        vector(light)
    ));
    near_grey(radiance, 2.0 / 5.0_f64.sqrt());
}

#[test]
fn samples_are_averaged_in_linear_light() {
    // An edge through the middle of a pixel, upright and lying: exactly half of an even grid of samples.
    for edge in ["u: (9, 0, 0), v: (0, 9, 0)", "u: (9, 0, 0), v: (0, -9, 0)"] {
        for n in [2, 4, 6] {
            let text = format!(
                r#"(output: (size: (1, 1)), quality: (antialias: {n}), background: 0.25,
                camera: (position: (0, 0, 5), projection: Orthographic(height: 2)),
                objects: {{ "half": (shape: Rectangle(corner: (0, 0, 0), {edge}), material: (color: 1, ambient: 0.75)) }})"#
            );
            // A quarter of the picture is covered.
            assert_eq!(shoot_all(&text)[0].pixel(0, 0), Rgb::splat(0.25 * 0.75 + 0.75 * 0.25));
        }
    }
}

#[test]
fn pictures_are_the_right_way_round() {
    // Four balls: right is +x, up is +y, towards the eye is +z, in both projections.
    for projection in ["Perspective(fov: 45)", "Orthographic(height: 4)"] {
        let text = format!(
            r#"(output: (size: (40, 40)), camera: (position: (0, 0, 5), projection: {projection}),
            default_material: (ambient: 1),
            objects: {{
                "right": (shape: Sphere(center: (1.2, 0, 0), radius: 0.3), material: (color: (1, 0, 0))),
                "up": (shape: Sphere(center: (0, 1.2, 0), radius: 0.3), material: (color: (0, 1, 0))),
                "near": (shape: Sphere(center: (0, 0, 1), radius: 0.3), material: (color: (0, 0, 1))),
                "far": (shape: Sphere(center: (0, 0, -1), radius: 0.3), material: (color: (1, 1, 1))),
            }})"#
        );
        let shot = &shoot_all(&text)[0];
        let at = |x, y| shot.pixel(x, y);
        assert_eq!(at(31, 20), Rgb::X, "{projection}");
        assert_eq!(at(20, 8), Rgb::Y, "{projection}");
        assert_eq!(at(20, 20), Rgb::Z, "{projection}");
        assert_eq!(at(8, 20), Rgb::ZERO, "{projection}");
        assert_eq!(at(20, 31), Rgb::ZERO, "{projection}");
    }
}

/// Samples that fall exactly on an edge of a box see one of the faces that face the eye.
#[test]
fn boxes_have_no_dark_edges() {
    // Two boxes side by side under the light, from above; the samples of a 16 x 16 grid lie on all their edges.
    for up in ["(0, 0, -1)", "(0, 0, 1)", "(1, 0, 0)", "(-1, 0, 0)"] {
        let text = format!(
            r#"(output: (size: (16, 16)), quality: (antialias: 1),
            camera: (position: (0, 10, 0), up: {up}, projection: Orthographic(height: 4)),
            lights: {{ "l": Point(position: (0, 1e6, 0)) }}, default_material: (color: 1, ambient: 0, diffuse: 1),
            objects: {{
                "a": (shape: Box(min: (-1.125, 0, -1.125), max: (0.125, 1, 1.125))),
                "b": (shape: Box(min: (0.125, 0, -1.125), max: (1.125, 1, 1.125))),
            }})"#
        );
        let shot = &shoot_all(&text)[0];
        // Sample k is at (k - 7.5) / 4: those from 4 to 11 are inside, 3 and 12 on the rim.
        for (x, y) in (4..12).flat_map(|x| (4..12).map(move |y| (x, y))) {
            assert!(shot.pixel(x, y).x > 0.999, "({x}, {y}) with {up} up: {}", shot.pixel(x, y));
        }
    }
}
