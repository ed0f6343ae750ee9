//! Media that touch and media in media: light passes them alike both ways, and whichever the file names first.

use crate::support::{shoot_all, shoot_film};
use kinora::base::color::Rgb;
use kinora::film::Film;

const BOTH: [&str; 2] = ["Whitted", "Path(roulette: Off)"];

/// Transmittance and reflectance of a boundary that light meets squarely.
fn boundary(before: f64, behind: f64) -> (f64, f64) {
    let amplitude = (before - behind) / (before + behind);
    (1.0 - amplitude * amplitude, amplitude * amplitude)
}

/// The share of light that passes water under glass, all reflections between the three boundaries included.
fn through_glass_and_water() -> f64 {
    let [(t1, r1), (t2, r2), (t3, r3)] = [boundary(1.0, 1.5), boundary(1.5, 1.33), boundary(1.33, 1.0)];
    let (t, r) = (t1 * t2 / (1.0 - r1 * r2), r2 + t2 * t2 * r1 / (1.0 - r1 * r2));
    t * t3 / (1.0 - r * r3)
}

const MATERIALS: &str = r#"materials: { "glass": Dielectric(ior: 1.5), "water": Dielectric(ior: 1.33) }"#;

/// Two objects in either order.
fn both_orders(one: &str, two: &str) -> [String; 2] {
    [format!("objects: {{ {one}, {two} }}"), format!("objects: {{ {two}, {one} }}")]
}

/// What is seen of a sky that shines from one side alone, through what two shapes are, of which the upper one is of glass and
/// the lower one of water.
#[track_caller]
fn assert_passes(upper: &str, lower: &str, middle: f64) {
    let glass = format!("\"glass\": (shape: {upper}, material: \"glass\")");
    let water = format!("\"water\": (shape: {lower}, material: \"water\")");
    let expected = through_glass_and_water();
    for objects in both_orders(&glass, &water) {
        for (x, side, integrator) in [0.1, 0.31, -0.23].into_iter().flat_map(|x| {
            [1.0, -1.0].into_iter().flat_map(move |side| BOTH.map(|integrator| (x, side, integrator)))
        }) {
            let (samples, tolerance) = if integrator == "Whitted" { (1, 2e-5) } else { (4096, 0.012) };
            let text = format!(
                r#"(output: (size: (1, 1)), {MATERIALS}, {objects}, ambient: 0,
                quality: (integrator: {integrator}, samples: {samples}, antialias: 1, bounces: 30, threshold: 1e-7),
                background: Gradient(bottom: {:?}, top: {:?}),
                camera: (position: ({x:?}, {:?}, 0.2), target: ({x:?}, {middle:?}, 0.2), up: (0, 0, 1),
                         projection: Perspective(fov: 0.001)))"#,
                f64::from(side > 0.0),
                f64::from(side < 0.0),
                middle + 5.0 * side,
            );
            let found = f64::from(shoot_all(&text)[0].pixel(0, 0).x);
            let off = (found - expected).abs();
            assert!(off < tolerance, "{upper} {lower} {integrator} {side} {x}: {found}, not {expected}");
        }
    }
}

#[test]
fn glass_on_water_lets_light_pass_both_ways() {
    let (upper, lower) = ("Box(min: (-9, 0, -9), max: (9, 1, 9))", "Box(min: (-9, -3, -9), max: (9, 0, 9))");
    assert_passes(upper, lower, 0.0);
}

/// Shapes of two kinds know the height of the face that they share by formulas of their own.
#[test]
fn light_passes_shared_faces_of_different_shapes() {
    for middle in [0.1, 1.0 / 3.0, 1e3 + 0.7] {
        let kinds = |up: f64| {
            let far = middle + up;
            let (low, high) = if far < middle { (far, middle) } else { (middle, far) };
            [
                format!("Box(min: (-2, {low:?}, -2), max: (2, {high:?}, 2))"),
                format!("Cylinder(from: (0, {far:?}, 0), to: (0, {middle:?}, 0), radius: 1.7)"),
                format!("Cone(base: (0, {middle:?}, 0), apex: (0, {far:?}, 0), radius: 2, top_radius: 1.9)"),
            ]
        };
        for (k, upper) in kinds(0.7).iter().enumerate() {
            for lower in
                kinds(-0.9).iter().enumerate().filter(|(other, _)| *other != k).map(|(_, lower)| lower)
            {
                assert_passes(upper, lower, middle);
            }
        }
    }
}

/// A film's radiance, to compare bit by bit.
fn bits(film: &Film) -> Vec<u32> {
    film.radiance().map(|color| color.x.to_bits()).collect()
}

/// In a sky that is bright all over, what absorbs nothing is as bright from all sides; what is black has trapped light.
#[test]
fn no_light_is_trapped_between_shared_faces() {
    let shapes = [
        "Box(min: (-1, 0.1, -1), max: (1, 0.7, 1))",
        "Cylinder(from: (0, -0.8, 0), to: (0, 0.1, 0), radius: 0.9)",
        "Cone(base: (0, 0.1, 0), apex: (0, -1.3, 0), radius: 0.8)",
    ];
    for [a, b] in [[0, 1], [0, 2]] {
        let glass = format!("\"glass\": (shape: {}, material: \"glass\")", shapes[a]);
        let water = format!("\"water\": (shape: {}, material: \"water\")", shapes[b]);
        let films = both_orders(&glass, &water).map(|objects| {
            let text = format!(
                r#"(output: (size: (32, 24)), {MATERIALS}, {objects}, ambient: 0, background: 1,
                quality: (integrator: Path(roulette: Off), samples: 16, bounces: 1000),
                camera: (position: (1.7, 1.9, 2.3), target: (0, -0.1, 0)))"#
            );
            shoot_film(&text)
        });
        for (index, color) in films[0].radiance().enumerate() {
            assert!(
                (color.x - 1.0).abs() < 1e-4,
                "pixel {index} of {} and {}: {color}",
                shapes[a],
                shapes[b]
            );
        }
        assert!(bits(&films[0]) == bits(&films[1]), "{} and {}", shapes[a], shapes[b]);
    }
}

/// A box of glass on a table is the same as one that is sunk into it, in either order of the file.
#[test]
fn glass_on_a_table_is_seen_as_if_it_were_sunk_into_it() {
    let table = r#""table": (shape: Plane(), material: Lambertian(color: Checker(a: 0.1, b: 0.9)))"#;
    for integrator in BOTH {
        let [on, swapped, sunk] = [(0.0, false), (0.0, true), (-0.5, false)].map(|(low, swap)| {
            let glass = format!(
                "\"glass\": (shape: Box(min: (-1, {low:?}, -1), max: (1, 1, 1)), material: \"glass\")"
            );
            let [first, second] = both_orders(table, &glass);
            let objects = if swap { second } else { first };
            shoot_film(&format!(
                r#"(output: (size: (96, 72)), {MATERIALS}, {objects}, background: 0.2,
                quality: (integrator: {integrator}, samples: 4, antialias: 1, bounces: 8),
                lights: {{ "sun": Directional(direction: (-0.4, -1, -0.3)) }},
                camera: (position: (1.7, 2.9, 4.3), target: (0, 0.3, 0)))"#
            ))
        });
        assert!(bits(&on) == bits(&swapped), "{integrator}: the order of the file changes the picture");
        let differs = |(a, b): (Rgb, Rgb)| (a - b).abs().max_element() > 1e-4;
        let count = on.radiance().zip(sunk.radiance()).filter(|pair| differs(*pair)).count();
        assert_eq!(count, 0, "{integrator}: pixels of 6912");
    }
}

/// However many shells a ball of glass has, between which nothing changes, it is seen as if it had one.
#[test]
fn nested_shells_equal_one_ball() {
    const GLASS: &str = "(ambient: 0, diffuse: 0, refraction: 1, ior: 1.5, absorption: 0.3, fresnel: Off)";
    for integrator in BOTH {
        let picture = |shells: u32| {
            let shell = |k: u32| {
                let radius = 1.0 - 0.9 * f64::from(k) / f64::from(shells);
                format!("\"{k}\": (shape: Sphere(radius: {radius:?}), material: {GLASS})")
            };
            let objects: Vec<_> = (0..shells).map(shell).collect();
            shoot_film(&format!(
                r#"(output: (size: (32, 32)), objects: {{ {} }}, background: Gradient(bottom: 0.1, top: 2), ambient: 0,
                quality: (integrator: {integrator}, samples: 1, antialias: 1, bounces: 1000),
                camera: (position: (0, 0.3, 3), target: (0, 0, 0)))"#,
                objects.join(", ")
            ))
        };
        let one = picture(1);
        for shells in [6, 7, 8, 40, 200] {
            let many = picture(shells);
            for (index, (a, b)) in many.radiance().zip(one.radiance()).enumerate() {
                let off = (a - b).abs().max_element();
                assert!(off < 1e-4, "{integrator} {shells} shells, pixel {index}: {a} {b}");
            }
        }
    }
}
