//! Light transport against closed forms: white furnaces, form factors, shadows, boundaries and fog.

use super::support::{radiance_at_target, shoot_all};
use kinora::base::color::Rgb;

/// The mean radiance of a picture of `side` x `side` pixels.
fn mean(side: u32, rest: &str) -> f64 {
    let shot = &shoot_all(&format!("(output: (size: ({side}, {side})), {rest})"))[0];
    let sum: f64 = shot.film.radiance().map(|pixel| f64::from(pixel.element_sum()) / 3.0).sum();
    sum / f64::from(side * side)
}

/// Looks at a small patch around the target.
fn patch(samples: u32, bounces: u32, eye: &str, target: &str, rest: &str) -> f64 {
    mean(
        1,
        &format!(
            "quality: (integrator: Path, samples: {samples}, bounces: {bounces}),
            camera: (position: {eye}, target: {target}, projection: Orthographic(height: 1e-6)), {rest}"
        ),
    )
}

fn near(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() <= within, "{found} is not {expected} within {within}");
}

#[test]
fn sa_03_white_furnaces() {
    // (a) A convex matte ball in light from everywhere: the same in every sample.
    let text = "(output: (size: (16, 16)), quality: (integrator: Path, samples: 4), background: 1,
        camera: (position: (0, 0, 3), projection: Orthographic(height: 1.3)),
        objects: { \"ball\": (shape: Sphere(), material: Lambertian(color: 0.5)) })";
    for pixel in shoot_all(text)[0].film.radiance() {
        near(f64::from(pixel.x), 0.5, 1e-6);
    }
    // (c) A mirror, and (d) glass.
    let ball = |material: &str, bounces: u32| {
        mean(
            16,
            &format!(
                "quality: (integrator: Path(roulette: Off), samples: 64, bounces: {bounces}), background: 1,
                camera: (position: (0, 0, 3), projection: Orthographic(height: 1.9)),
                objects: {{ \"ball\": (shape: Sphere(), material: {material}) }}"
            ),
        )
    };
    near(ball("Metal(color: 1)", 4), 1.0, 1e-6);
    near(ball("Dielectric()", 1000), 1.0, 2e-3);
    near(ball("Dielectric(fresnel: Schlick)", 1000), 1.0, 2e-3);
}

/// (b) Inside a closed sphere that gives off 0.2 and reflects 0.8: 0.2 (1 + 0.8 + 0.64 + …).
fn closed_furnace(samples: u32, quality: &str) -> f64 {
    mean(
        1,
        &format!(
            "quality: (samples: {samples}, {quality}), camera: (position: (0.3, 0.1, 0), target: (0, 0, -1)),
            objects: {{ \"hull\": (shape: Sphere(), material: (diffuse: 0.8, ambient: 0, emission: 0.2, color: 1)) }}"
        ),
    )
}

#[test]
fn sa_03_closed_furnace() {
    near(closed_furnace(60_000, "integrator: Path, bounces: 1000"), 1.0, 4e-3);
    near(closed_furnace(60_000, "integrator: Path(roulette: Off), bounces: 10"), CUT_SHORT, 1e-3);
}

/// After 10 bounces light has been scattered 11 times: 1 - 0.8^12.
const CUT_SHORT: f64 = 0.931_280_523_264;

#[test]
#[ignore = "takes a minute: the full number of paths of SA-03; cargo test --release -- --ignored sa_03"]
fn sa_03_closed_furnace_in_full() {
    near(closed_furnace(1_000_000, "integrator: Path, bounces: 1000"), 1.0, 1e-3);
    near(closed_furnace(1_000_000, "integrator: Path(roulette: Off), bounces: 10"), CUT_SHORT, 1e-3);
}

#[test]
fn sh_18_area_lights_follow_their_form_factors() {
    let floor = |light: &str| {
        let objects = "objects: { \"floor\": (shape: Plane(), material: Lambertian(color: 0.5)) }";
        let eye = "(3, 1, 0)";
        let path = patch(4096, 1, eye, "(0, 0, 0)", &format!("lights: {{ {light} }}, {objects}"));
        let whitted = mean(
            1,
            &format!(
                "quality: (samples: 4096), ambient: 0,
                camera: (position: {eye}, projection: Orthographic(height: 1e-6)), lights: {{ {light} }}, {objects}"
            ),
        );
        near(path / whitted, 1.0, 2e-3);
        path
    };
    let square = 0.178_842_373_315_128;
    near(
        floor("\"l\": Rectangle(corner: (-1, 1.5, -1), u: (2, 0, 0), v: (0, 0, 2))"),
        square,
        0.005 * square,
    );
    // A sphere of radius r at distance d: (r / d)² of the light that a full sky would give.
    near(floor("\"l\": Sphere(center: (0, 2, 0), radius: 1)"), 0.125, 0.005 * 0.125);
    // One-sided rectangles shine to the side of u × v.
    let below = "corner: (-1, 1.5, -1), u: (2, 0, 0), v: (0, 0, 2), one_sided: true";
    near(floor(&format!("\"l\": Rectangle({below})")), square, 0.005 * square);
}

/// The mean of 16 seeds is within three of its standard errors, and of half a percent.
#[test]
fn sh_18_seeds_scatter_around_the_form_factor() {
    const MATT: &str = "\"floor\": (shape: Plane(), material: Lambertian(color: 0.5))";
    let square =
        "lights: { \"l\": Rectangle(corner: (-1, 1.5, -1), u: (2, 0, 0), v: (0, 0, 2)) }, objects: { MATT }";
    let disk = "objects: { MATT, \"lamp\": (shape: Disk(center: (0, 2, 0), radius: 1),
        material: (color: 1, ambient: 0, diffuse: 0, emission: 1)) }";
    for (scene, expected) in [(square, 0.178_842_373_315_128), (disk, 0.1)] {
        let found: Vec<f64> = (0..16)
            .map(|seed| {
                let camera = "camera: (position: (3, 1, 0), projection: Orthographic(height: 1e-6))";
                let quality = format!("quality: (integrator: Path, samples: 4096, bounces: 1, seed: {seed})");
                mean(1, &format!("{quality}, {camera}, {}", scene.replace("MATT", MATT)))
            })
            .collect();
        let mean = found.iter().sum::<f64>() / 16.0;
        let variance = found.iter().map(|one| (one - mean) * (one - mean)).sum::<f64>() / 15.0;
        // The film is f32.
        let error = (variance / 16.0).sqrt() + expected * f64::from(f32::EPSILON);
        near(mean, expected, (3.0 * error).min(0.005 * expected));
    }
}

#[test]
fn emitting_objects_light_as_lights_do() {
    let floor = |shape: &str, scale: &str| {
        patch(
            4096,
            1,
            "(3, 1, 0)",
            "(0, 0, 0)",
            &format!(
                "objects: {{ \"floor\": (shape: Plane(), material: Lambertian(color: 0.5)),
                \"lamp\": (shape: {shape}, scale: {scale}, material: (color: 1, ambient: 0, diffuse: 0, emission: 1)) }}"
            ),
        )
    };
    let one = "(1, 1, 1)";
    let square = 0.178_842_373_315_128;
    near(floor("Rectangle(corner: (-1, 1.5, -1), u: (2, 0, 0), v: (0, 0, 2))", one), square, 0.005 * square);
    near(
        floor("Rectangle(corner: (-2, 0.75, -1), u: (4, 0, 0), v: (0, 0, 2))", "(0.5, 2, 1)"),
        square,
        0.005 * square,
    );
    near(floor("Disk(center: (0, 2, 0), radius: 1)", one), 0.1, 0.0005);
    // An elliptic disk that is scaled back to a round one: sampled in its own space.
    near(floor("Disk(center: (0, 1, 0), radius: 0.5)", "(2, 2, 2)"), 0.1, 0.0005);
    near(floor("Sphere(center: (0, 2, 0))", one), 0.125, 0.005 * 0.125);
    // A stretched sphere, of half axes a = 1.5, b = 1 (upwards) and c = 1 at distance d = 2. The cone around it cuts
    // an ellipse of half axes p and q out of the plane at distance 1, p² = a² / (d² - b²) and q² = c² / (d² - b²).
    // In polar coordinates its form factor is the mean over all angles φ of 1 / (1 + cos²φ / p² + sin²φ / q²), which
    // is 1 / √((1 + 1 / p²) (1 + 1 / q²)).
    let (p2, q2) = (1.5 * 1.5 / 3.0, 1.0 / 3.0);
    let stretched = 0.5 / f64::sqrt((1.0 + 1.0 / p2) * (1.0 + 1.0 / q2));
    near(floor("Sphere(center: (0, 2, 0))", "(1.5, 1, 1)"), stretched, 0.005 * stretched);
}

#[test]
fn many_lights_are_chosen_among_without_bias() {
    let lamps = |count: u32| -> String {
        let each = 1.0 / f64::from(count);
        (0..count)
            .map(|k| {
                let x = f64::from(k % 5) - 2.0;
                let z = f64::from(k / 5) - 2.0;
                format!("\"{k}\": Point(position: ({x}, 3, {z}), intensity: {each:?}), ")
            })
            .collect()
    };
    let floor = |integrator: &str, count: u32| {
        mean(
            1,
            &format!(
                "quality: (integrator: {integrator}, samples: 16384, bounces: 0), ambient: 0,
                camera: (position: (3, 1, 0), projection: Orthographic(height: 1e-6)), lights: {{ {} }},
                objects: {{ \"floor\": (shape: Plane(), material: Lambertian(color: 0.5)),
                            \"post\": (shape: Sphere(center: (0.3, 1, 0), radius: 0.4), material: Lambertian()) }}",
                lamps(count)
            ),
        )
    };
    for count in [1, 7, 25] {
        let (path, whitted) = (floor("Path", count), floor("Whitted", count));
        near(path / whitted, 1.0, 4e-3);
    }
}

#[test]
fn both_integrators_agree_where_light_comes_straight() {
    let scene = "camera: (position: (2, 3, 5), target: (0, 0.5, 0)), ambient: 0.2,
        lights: { \"p\": Point(position: (3, 5, 2), attenuation: (linear: 0.1)),
                  \"s\": Spot(position: (-3, 4, 1), angle: 50, inner_angle: 20, color: (1, 0.5, 0.2)),
                  \"d\": Directional(direction: (0.2, -1, -0.3), intensity: 0.3) },
        objects: { \"floor\": (shape: Plane(), material: (color: Checker())),
                   \"ball\": (shape: Sphere(center: (0, 1, 0)), material: (specular: 0.5, shininess: 20)) }";
    let film = |integrator: &str| {
        let quality = format!("quality: (integrator: {integrator}, antialias: 1, samples: 1, bounces: 0)");
        let text = format!("(output: (size: (24, 24)), {quality}, {scene})");
        shoot_all(&text)[0].film.radiance().collect::<Vec<_>>()
    };
    // One sample in the middle of each pixel against one anywhere in it: means of many pixels agree.
    let sum =
        |film: Vec<Rgb>| film.iter().map(|pixel| pixel.as_dvec3()).sum::<kinora::base::math::DVec3>() / 576.0;
    let (whitted, path) = (sum(film("Whitted")), sum(film("Path")));
    assert!((whitted - path).abs().max_element() < 0.02 * whitted.max_element(), "{whitted} {path}");
    // A light of intensity 1 that faces a surface of diffuse 1.
    for integrator in ["Whitted", "Path"] {
        let text = format!(
            "(output: (size: (1, 1)), quality: (integrator: {integrator}, samples: 4, bounces: 3),
            camera: (position: (0, 5, 0), projection: Orthographic(height: 1e-6)),
            lights: {{ \"p\": Point(position: (0, 9, 0)) }},
            objects: {{ \"floor\": (shape: Plane(), material: Lambertian(color: 1)) }})"
        );
        near(f64::from(shoot_all(&text)[0].pixel(0, 0).x), 1.0, 1e-6);
    }
}

#[test]
fn sh_04_transparent_things_dim_shadows_by_their_product() {
    let lit = |integrator: &str, sheets: &[&str]| {
        let sheets: String = (0..)
            .zip(sheets)
            .map(|(k, material)| {
                let y = 2.0 + 0.5 * f64::from(k);
                format!("\"{k}\": (shape: Disk(center: (0, {y}, 0)), material: {material}), ")
            })
            .collect();
        let text = format!(
            "(output: (size: (1, 1)), quality: (integrator: {integrator}, samples: 1, bounces: 0), ambient: 0,
            camera: (position: (3, 0.1, 0), projection: Orthographic(height: 1e-9)),
            lights: {{ \"l\": Point(position: (0, 9, 0)) }},
            objects: {{ {sheets} \"floor\": (shape: Plane(), material: Lambertian(color: 1)) }})"
        );
        shoot_all(&text)[0].pixel(0, 0)
    };
    let clear = |color: &str| format!("(diffuse: 0, transparency: 1, transparency_color: {color})");
    let (half, a, b) = (clear("0.5"), clear("(0.5, 1, 0.25)"), clear("(1, 0.5, 0.5)"));
    for integrator in ["Whitted", "Path"] {
        for (count, expected) in [(0, 1.0), (1, 0.5), (2, 0.25), (3, 0.125)] {
            assert_eq!(lit(integrator, &vec![half.as_str(); count]), Rgb::splat(expected));
        }
        assert_eq!(lit(integrator, &[&a, &b]), Rgb::new(0.5, 0.5, 0.125));
        assert_eq!(lit(integrator, &[&b, &a]), Rgb::new(0.5, 0.5, 0.125));
        assert_eq!(lit(integrator, &[&a, "(diffuse: 1)"]), Rgb::ZERO, "opaque behind transparent");
        assert_eq!(lit(integrator, &["(diffuse: 1)", &a]), Rgb::ZERO, "opaque before transparent");
    }
    // What refracts lets Whitted's shadow rays pass, paths' only if asked.
    let glass = "(diffuse: 0, refraction: 1, refraction_color: (0.5, 1, 1))";
    assert_eq!(lit("Whitted", &[glass, glass]), Rgb::new(0.25, 1.0, 1.0));
    assert_eq!(lit("Path", &[glass]), Rgb::ZERO);
    assert_eq!(lit("Path(refractive_shadows: true)", &[glass]), Rgb::new(0.5, 1.0, 1.0));
}

#[test]
fn sh_08_refraction_through_a_sphere() {
    // The ray of the case leaves towards (0.9332, -0.3593, 0): a tiny lamp there is seen, and nothing beside it.
    let (exit, way) =
        ([0.987_844_994_581_918, 0.155_442_165_062_928], [0.933_219_942_840_706, -0.359_305_633_527_209]);
    let seen = |off: f64| {
        let at = |axis: usize| exit[axis] + 1e6 * way[axis] + off * [-way[1], way[0]][axis];
        radiance_at_target(&format!(
            "camera: (position: (-5, 0.5, 0), target: (0, 0.5, 0)),
            objects: {{ \"glass\": (shape: Sphere(), material: (ambient: 0, diffuse: 0, refraction: 1, ior: 1.5)),
                \"lamp\": (shape: Sphere(center: ({:?}, {:?}, 0), radius: 1e-6), material: (emission: 1, color: 1)) }}",
            at(0), at(1)
        ))
        .x
    };
    assert!(seen(0.0) > 0.9, "the ray is bent as it should be, to a millionth of a millionth");
    assert_eq!([seen(1e-3), seen(-1e-3)], [0.0; 2]);
}

#[test]
fn sh_07_an_index_of_one_is_invisible() {
    let picture = |ball: &str| {
        let text = format!(
            "(output: (size: (24, 24)), quality: (bounces: 2, antialias: 1), background: Gradient(),
            camera: (position: (0, 1, 5), target: (0, 0.7, 0)), lights: {{ \"l\": Point(position: (2, 5, 3)) }},
            objects: {{ \"floor\": (shape: Plane(), material: (color: Checker())), {ball} }})"
        );
        shoot_all(&text)[0].film.radiance().collect::<Vec<_>>()
    };
    let without = picture("");
    for (ior, within) in [("1", 1e-5), ("1.000001", 1e-4)] {
        let ball = format!("\"ball\": (shape: Sphere(center: (0, 1, 0)), material: Dielectric(ior: {ior}))");
        for (a, b) in picture(&ball).iter().zip(&without) {
            assert!((a - b).abs().max_element() <= within, "{a} against {b}");
        }
    }
}

#[test]
fn glass_absorbs_along_the_way_through_it() {
    let through = |integrator: &str, absorption: &str| {
        let text = format!(
            "(output: (size: (1, 1)), quality: (integrator: {integrator}, samples: 1, bounces: 8), background: 1,
            camera: (position: (0, 0, 5), projection: Orthographic(height: 1e-9)),
            objects: {{ \"box\": (shape: Box(min: (-1, -1, -1), max: (1, 1, 1)),
                material: (ambient: 0, diffuse: 0, refraction: 1, absorption: {absorption})) }})"
        );
        shoot_all(&text)[0].pixel(0, 0)
    };
    for integrator in ["Whitted", "Path"] {
        let seen = through(integrator, "(0.5, 0, 2)").as_dvec3();
        let expected = kinora::base::math::DVec3::new(libm::exp(-1.0), 1.0, libm::exp(-4.0));
        assert!((seen - expected).abs().max_element() < 1e-6, "{seen}");
    }
}

#[test]
fn sh_11_fog_hides_distant_objects_only() {
    let seen = |density: f64, distance: f64, sky: f64| {
        f64::from(
            radiance_at_target(&format!(
                "camera: (position: (0, 0, {distance:?})), background: {sky:?}, fog: (color: 0.25, density: {density:?}),
                objects: {{ \"wall\": (shape: Rectangle(corner: (-1, -1, 0), u: (2, 0, 0), v: (0, 2, 0)),
                    material: (color: 1, ambient: 0, diffuse: 0, emission: 1)) }}"
            ))
            .x,
        )
    };
    near(seen(0.1, 10.0, 0.0), 0.25 + 0.75 * libm::exp(-1.0), 1e-6);
    near(seen(0.0, 10.0, 0.0), 1.0, 0.0);
    near(seen(1e3, 10.0, 0.0), 0.25, 0.0);
    let sky = radiance_at_target("fog: (color: (0.5, 0.25, 0.125), density: 1e-9), background: 1");
    assert_eq!(sky, Rgb::new(0.5, 0.25, 0.125), "a way without end shows the fog alone");
}

/// Ground fog looks the same from every height above it, however little of it is where the camera is.
#[test]
fn ground_fog_is_seen_from_any_height() {
    for height in [30.0, 600.0, 711.0, 760.0, 1e5] {
        let seen = radiance_at_target(&format!(
            "camera: (position: (0, {height:?}, 0), up: (0, 0, 1)),
            fog: (color: 0.25, density: 0.5, falloff: (height: 1)),
            objects: {{ \"floor\": (shape: Plane(),
                material: (color: 1, ambient: 0, diffuse: 0, emission: 1)) }}"
        ));
        near(f64::from(seen.x), 0.25 + 0.75 * libm::exp(-0.5), 1e-6);
    }
}

#[test]
fn ca_09_closed_lenses_and_shutters_change_nothing() {
    let picture = |camera: &str| {
        let text = format!(
            "(output: (size: (16, 16)), timeline: (frames: 2),
            camera: (position: (0, 1, 5), {camera}), lights: {{ \"l\": Point(position: (2, 5, 3)) }},
            objects: {{ \"ball\": (shape: Sphere(), translation: [(0, (0, 0, 0)), (1, (5, 0, 0))]) }})"
        );
        shoot_all(&text).into_iter().map(|shot| shot.film).collect::<Vec<_>>()
    };
    assert_eq!(picture(""), picture("aperture: 0, focus: 3, shutter: 0"));
    assert_ne!(picture(""), picture("aperture: 0.5"));
    assert_ne!(picture(""), picture("shutter: 0.5"));
}

#[test]
fn moving_things_blur_by_the_time_they_are_there() {
    // A wall of width 1 moves by 2 during the frame past a pixel in whose middle it is for half of the time.
    let text = "(output: (size: (1, 1)), timeline: (frames: 1, fps: 1), quality: (samples: 4096, shutter_steps: 64),
        camera: (position: (0, 0, 5), projection: Orthographic(height: 1e-6), shutter: 1),
        objects: { \"wall\": (shape: Rectangle(corner: (-0.5, -1, 0), u: (1, 0, 0), v: (0, 2, 0)),
            translation: [(0, (-1, 0, 0)), (1, (1, 0, 0))], material: (ambient: 0, diffuse: 0, emission: 1, color: 1)) })";
    near(f64::from(shoot_all(text)[0].pixel(0, 0).x), 0.5, 0.02);
}

/// The point of a light may lie on what its shadow rays pass, as far as rounding distinguishes them: they end there all the
/// same, and what lets everything pass takes nothing away.
#[test]
fn shadow_rays_end_at_lights_on_clear_surfaces() {
    let picture = |integrator: &str, light: &str, sheet: &str| {
        let text = format!(
            "(output: (size: (8, 8)), quality: (integrator: {integrator}, samples: 4, bounces: 0), ambient: 0,
            camera: (position: (0, -5, 8), target: (0, -6, 0), projection: Perspective(fov: 10)), lights: {{ \"l\": {light} }},
            objects: {{ {sheet} \"floor\": (shape: Plane(point: (0, -6, 0)), material: Lambertian(color: 1)) }})"
        );
        shoot_all(&text)[0].film.radiance().map(|pixel| pixel.x).collect::<Vec<_>>()
    };
    let sheet = |share: &str, lobe: &str| {
        format!(
            "\"sheet\": (shape: Disk(normal: (1, 2, 3), radius: 5),
            material: (ambient: 0, diffuse: 0, ior: 1, {lobe}: {share})),"
        )
    };
    // Both lie in the disk's plane.
    let lights =
        ["Point(position: (3, 0, -1))", "Rectangle(corner: (-1, -1, 1), u: (2, -1, 0), v: (0, 1.5, -1))"];
    for integrator in ["Whitted", "Path", "Path(refractive_shadows: true)"] {
        for light in lights {
            let free = picture(integrator, light, "");
            assert!(free.iter().all(|share| *share > 0.0));
            for (clear, dim) in free.iter().zip(picture(integrator, light, &sheet("1", "transparency"))) {
                assert!((dim - clear).abs() <= 1e-5, "{integrator}, {light}: {dim}, not {clear}");
            }
            // Whether a surface lies before a light on it, only rounding says.
            for (clear, dim) in free.iter().zip(picture(integrator, light, &sheet("0.9", "transparency"))) {
                assert!(dim <= clear * 1.00001 && dim >= clear * 0.89999, "{dim} of {clear}");
            }
            picture(integrator, light, &sheet("1", "refraction"));
        }
    }
}
