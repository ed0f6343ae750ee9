//! Surfaces in one place, or as good as in one: of opaque ones the first in the file is seen, and light passes each of the
//! others once.

use crate::support::{shoot_all, shoot_film};
use kinora::base::color::Rgb;

const BOTH: [&str; 2] = ["Whitted", "Path(roulette: Off)"];

/// A height that is this many numbers above another.
fn up(mut height: f64, steps: u32) -> f64 {
    for _ in 0..steps {
        height = height.next_up();
    }
    height
}

/// What is seen straight down through objects, of a sky of 1.
fn seen_through(objects: &str, integrator: &str) -> f32 {
    let text = format!(
        r#"(output: (size: (1, 1)), ambient: 0, background: 1, objects: {{ {objects} }},
        quality: (integrator: {integrator}, antialias: 1, samples: 4),
        camera: (position: (0.1, 5, 0.2), target: (0.1, 0, 0.2), up: (0, 0, -1), projection: Perspective(fov: 0.001)))"#
    );
    shoot_all(&text)[0].pixel(0, 0).x
}

/// A sheet that lets a share of light pass.
fn sheet(name: usize, shape: &str, share: f64) -> String {
    format!(
        "\"{name}\": (shape: {shape}, material: (color: 0, ambient: 0, diffuse: 0, transparency: {share:?})), "
    )
}

fn flat_shapes(height: f64) -> [String; 4] {
    [
        format!("Plane(point: (0, {height:?}, 0))"),
        format!("Rectangle(corner: (-3, {height:?}, -3), u: (6, 0, 0), v: (0, 0, 7))"),
        format!("Disk(center: (0.3, {height:?}, 0), radius: 4)"),
        format!("Triangle(a: (-9, {height:?}, -8), b: (9, {height:?}, -7), c: (0, {height:?}, 11))"),
    ]
}

/// However many there are.
#[test]
fn coincident_sheets_count_once_each() {
    for (height, count) in
        [0.0, 0.1, -2.7].into_iter().flat_map(|h| [1, 4, 5, 6, 9, 40].map(|count| (h, count)))
    {
        let objects: String = (0..count).map(|k| sheet(k, &flat_shapes(height)[k % 4], 0.98)).collect();
        let expected = libm::pow(0.98, count as f64) as f32;
        for integrator in BOTH {
            let found = seen_through(&objects, integrator);
            assert!((found - expected).abs() < 1e-5, "{count} at {height}, {integrator}: {found}");
        }
    }
}

/// Next to zero, numbers are finer than the eye's distance is known.
#[test]
fn sheets_nearer_than_the_eyes_rounding_count_once_each() {
    for apart in [0.0, 1e-300, 1e-40, 1e-18, 1e-17, 1e-16, 3e-16, 1e-15, 4e-15] {
        for heights in [[0.0, apart], [apart, 0.0], [0.0, -apart], [-apart, 0.0]] {
            for kind in 0..4 {
                let objects: String = (0..2).map(|k| sheet(k, &flat_shapes(heights[k])[kind], 0.5)).collect();
                let found = seen_through(&objects, "Whitted");
                assert!((found - 0.25).abs() < 1e-6, "{heights:?} {}: {found}", flat_shapes(0.0)[kind]);
            }
        }
    }
}

/// Shadow rays pass two sheets as often as there are sheets: what arrives is T², not T⁴.
#[test]
fn near_sheets_cast_the_shadow_of_two() {
    let lights = [
        "Directional(direction: (-0.3, -1, 0.1))",
        "Point(position: (1, 9, 2))",
        "Directional(direction: (0, -1, 0))",
    ];
    let lit = |objects: &str, light: &str, integrator: &str| {
        let text = format!(
            r#"(output: (size: (1, 1)), ambient: 0, quality: (integrator: {integrator}, antialias: 1, samples: 1),
            lights: {{ "lamp": {light} }},
            objects: {{ {objects} "floor": (shape: Plane(point: (0, -3, 0)), material: Lambertian(color: 1)) }},
            camera: (position: (0.1, -2.8, 0.2), target: (0.1, -3, 0.2), up: (0, 0, -1),
                     projection: Perspective(fov: 0.001)))"#
        );
        shoot_all(&text)[0].pixel(0, 0).x
    };
    for (light, integrator) in lights.into_iter().flat_map(|light| BOTH.map(|integrator| (light, integrator)))
    {
        let bare = lit("", light, integrator);
        for (height, gap) in
            [1.0, 0.1, 2.7, -0.7].into_iter().flat_map(|h| [0, 1, 2, 4, 5, 6, 8, 16].map(|gap| (h, gap)))
        {
            for steps in [[0, gap], [gap, 0]] {
                let one_of_two = |k: usize| sheet(k, &flat_shapes(up(height, steps[k]))[1], 0.5);
                let objects: String = (0..2).map(one_of_two).collect();
                let share = lit(&objects, light, integrator) / bare;
                assert!((share - 0.25).abs() < 1e-6, "{light} {integrator} {height} {steps:?}: {share}");
            }
        }
    }
}

/// Shapes of all kinds that have an upper side at a height, within one unit around the axis.
fn level_shapes(height: f64) -> Vec<String> {
    let below = height - 1.3;
    let mut shapes = flat_shapes(height).to_vec();
    shapes.extend([
        format!("Box(min: (-2, {below:?}, -3), max: (3, {height:?}, 2))"),
        format!("Cylinder(from: (0, {below:?}, 0), to: (0, {height:?}, 0), radius: 2)"),
        format!("Cone(base: (0, {height:?}, 0), apex: (0, {below:?}, 0), radius: 2)"),
        format!("Cone(base: (0, {below:?}, 0), apex: (0, {height:?}, 0), radius: 2.5, top_radius: 2)"),
        format!(
            "Mesh(vertices: [(-3, {height:?}, -3), (-3, {height:?}, 3), (3, {height:?}, 3), (3, {height:?}, -3)],
             triangles: [(0, 1, 2), (0, 2, 3)])"
        ),
    ]);
    shapes
}

/// Every pixel shows the first of two objects that lie in one.
#[track_caller]
fn assert_first_is_seen(first: &str, second: &str, place: &str, height: f64) {
    for integrator in BOTH {
        let object = |name: &str, shape: &str, color: &str| {
            format!(
                "\"{name}\": (shape: {shape}, {place} material: (color: 0, ambient: 0, diffuse: 0, emission: 1, emission_color: {color}))"
            )
        };
        let film = shoot_film(&format!(
            r#"(output: (size: (16, 12)), ambient: 0, quality: (integrator: {integrator}, antialias: 1, samples: 1),
            camera: (position: (0.2, {:?}, 3), target: (0.1, {height:?}, 0), projection: Perspective(fov: 20)),
            objects: {{ {}, {} }})"#,
            height + 4.0,
            object("one", first, "(1, 0, 0)"),
            object("two", second, "(0, 1, 0)"),
        ));
        let wrong = film.radiance().filter(|color| *color != Rgb::new(1.0, 0.0, 0.0)).count();
        assert_eq!(wrong, 0, "pixels of 192: {first} before {second}, {place} {integrator}");
    }
}

#[test]
fn of_opaque_shapes_of_all_kinds_the_first_is_seen() {
    for height in [0.0, 0.1, 1.0 / 3.0, 1e3 + 0.7] {
        let shapes = level_shapes(height);
        for (first, second) in
            shapes.iter().flat_map(|first| shapes.iter().map(move |second| (first, second)))
        {
            assert_first_is_seen(first, second, "", height);
        }
    }
}

/// Also where rays are moved to the shapes instead.
#[test]
fn the_first_of_coincident_rotated_shapes_is_visible() {
    let turned = "rotation: Euler(x: 11, y: 37, z: -7), scale: (1.1, 1, 0.9),";
    let shapes = level_shapes(0.0);
    for (first, second) in shapes.iter().flat_map(|first| shapes.iter().map(move |second| (first, second))) {
        assert_first_is_seen(first, second, turned, 0.0);
    }
}
