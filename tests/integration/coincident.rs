//! Surfaces that lie in one, as they do where things stand on, touch or are set into others: none is overlooked,
//! whichever the file names first.

use crate::support::shoot_all;
use kinora::base::color::Rgb;

const BOTH: [&str; 2] = ["Whitted", "Path(roulette: Off)"];

/// What is seen from (0.1, 5, 0.2) straight down, of two objects in either order.
#[track_caller]
fn both_ways(fields: &str, objects: [&str; 2], expected: [f32; 3], tolerance: f32) {
    let [a, b] = objects;
    for (integrator, objects) in BOTH.iter().flat_map(|i| [(i, [a, b]), (i, [b, a])]) {
        let text = format!(
            r#"(output: (size: (1, 1)), quality: (integrator: {integrator}, samples: 4096, bounces: 40, antialias: 1),
            camera: (position: (0.1, 5, 0.2), target: (0.1, 0, 0.2), up: (0, 0, -1), projection: Perspective(fov: 0.001)),
            {fields}, objects: {{ "one": ({}), "two": ({}) }})"#,
            objects[0], objects[1]
        );
        let found = shoot_all(&text)[0].pixel(0, 0);
        assert!(
            (found - Rgb::from_array(expected)).abs().max_element() <= tolerance,
            "{integrator} {objects:?}: {found}"
        );
    }
}

const CLEAR: &str = "material: (ambient: 0, diffuse: 0, transparency: 0.5)";

#[test]
fn coincident_bases_do_not_darken_floors() {
    let floor = "shape: Plane(), material: (ambient: 0, diffuse: 0, emission: 1, color: 1)";
    for shape in [
        "Cylinder(from: (0, 0, 0), to: (0, 1, 0))",
        "Box(min: (-1, 0, -1), max: (1, 1, 1))",
        "Cone(base: (0, 0, 0), apex: (0, 1, 0))",
    ] {
        // Its upper side halves the light. The lower one, in the floor, is met first or not at all.
        let glass = format!("shape: {shape}, {CLEAR}");
        for order in [[&glass[..], floor], [floor, &glass]] {
            let text = |integrator| {
                format!(
                    r#"(output: (size: (1, 1)), quality: (integrator: {integrator}, samples: 4096, antialias: 1),
                    camera: (position: (0.1, 5, 0.2), target: (0.1, 0, 0.2), up: (0, 0, -1),
                             projection: Perspective(fov: 0.001)),
                    objects: {{ "one": ({}), "two": ({}) }})"#,
                    order[0], order[1]
                )
            };
            for integrator in BOTH {
                let found = shoot_all(&text(integrator))[0].pixel(0, 0).x;
                let near = |share: f32| (found - share).abs() < 0.03;
                assert!(near(0.5) || near(0.25), "{integrator} {shape}: {found}");
            }
        }
    }
}

#[test]
fn light_passes_slabs_face_to_face() {
    let slab = |low: f64, high: f64| {
        format!(
            "shape: Box(min: (-9, {low:?}, -9), max: (9, {high:?}, 9)),
            material: (ambient: 0, diffuse: 0, refraction: 1, ior: 1.5, absorption: 0.2)"
        )
    };
    let (upper, lower) = (slab(1.0, 2.0), slab(0.0, 1.0));
    let left = libm::expf(-0.4);
    both_ways("background: 1", [&upper, &lower], [left; 3], 1e-5);
    let clear = |low: f64, high: f64| {
        format!(
            "shape: Box(min: (-9, {low:?}, -9), max: (9, {high:?}, 9)), material: (ambient: 0, diffuse: 0, transparency: 0.9)"
        )
    };
    both_ways("background: 1", [&clear(1.0, 2.0), &clear(0.0, 1.0)], [0.6561; 3], 1e-5);
}

#[test]
fn sheets_in_one_plane_cast_their_shadows_together() {
    let opaque = "shape: Rectangle(corner: (-9, 2, -9), u: (18, 0, 0), v: (0, 0, 18))";
    let veil = format!("{opaque}, {CLEAR}");
    let fields = r#"lights: { "sun": Directional(direction: (-0.1, -1, 0)) },
        background: 0, cameras: { "low": (position: (0.1, 1, 0.2), target: (0.1, 0, 0.2), up: (0, 0, -1)) },
        materials: {}"#;
    for order in [[opaque, &veil], [&veil, opaque]] {
        let text = format!(
            r#"(output: (size: (1, 1)), ambient: 0, quality: (antialias: 1), {fields},
            objects: {{ "one": ({}), "two": ({}), "floor": (shape: Plane()) }})"#,
            order[0], order[1]
        );
        assert_eq!(shoot_all(&text)[0].pixel(0, 0), Rgb::ZERO, "{order:?}");
    }
}

/// Seen from below, through a clear floor: what stands on it shows its base.
#[test]
fn bases_are_visible_through_a_transparent_floor() {
    for (at, size) in [(0.0, 1.0), (1000.0, 1.0), (-3.7, 1e-3), (1e6, 50.0)] {
        let v = |x: f64, y: f64, z: f64| {
            format!("({:?}, {:?}, {:?})", at + x * size, at + y * size, at + z * size)
        };
        for shape in [
            format!("Cylinder(from: {}, to: {}, radius: {size:?})", v(0.0, 0.0, 0.0), v(0.0, 1.0, 0.0)),
            format!("Box(min: {}, max: {})", v(-1.0, 0.0, -1.0), v(1.0, 1.0, 1.0)),
            format!("Cone(base: {}, apex: {}, radius: {size:?})", v(0.0, 0.0, 0.0), v(0.0, 1.0, 0.0)),
        ] {
            // The base is lit; the inside, which would be seen if it were missed, is dark.
            let solid = format!("\"solid\": (shape: {shape}, material: (ambient: 0, diffuse: 1, color: 1))");
            let floor = format!("\"floor\": (shape: Plane(point: {}), {CLEAR})", v(0.0, 0.0, 0.0));
            for objects in [[&solid, &floor], [&floor, &solid]] {
                let text = format!(
                    r#"(output: (size: (1, 1)), ambient: 0, quality: (antialias: 1),
                    lights: {{ "below": Directional(direction: (0, 1, 0)) }},
                    camera: (position: {}, target: {}, up: (0, 0, 1)), objects: {{ {}, {} }})"#,
                    v(0.1, -5.0, 0.2),
                    v(0.1, 0.0, 0.2),
                    objects[0],
                    objects[1]
                );
                let found = shoot_all(&text)[0].pixel(0, 0).x;
                // The floor dims the light and the view, unless the base is met first.
                let known = [0.25, 0.5, 1.0].iter().any(|share| (found - share).abs() < 1e-3);
                assert!(known, "{at} {size} {shape}: {found}");
            }
        }
    }
}

/// Two sheets that are close, but not in one place, are two.
#[test]
fn separate_sheets_are_passed_once_each() {
    for apart in [1e-14, 1e-13, 1e-12, 1e-9, 1e-3] {
        let sheet = |y: f64| format!("shape: Plane(point: (0, {y:?}, 0)), {CLEAR}");
        both_ways("background: 1", [&sheet(1.0), &sheet(1.0 + apart)], [0.25; 3], 0.02);
    }
}

/// The light of a panel in a ceiling is the same as that of one a little below.
#[test]
fn panels_shine_from_within_a_ceiling() {
    let seen = |at: f64, height: f64, integrator: &str| {
        let v = |x: f64, y: f64, z: f64| format!("({:?}, {:?}, {:?})", at + x, at + y, at + z);
        let text = format!(
            r#"(output: (size: (1, 1)), quality: (integrator: {integrator}, samples: 4096, bounces: 1, antialias: 1),
            camera: (position: {}, target: {}, up: (0, 0, -1), projection: Perspective(fov: 0.001)), ambient: 0,
            lights: {{ "panel": Rectangle(corner: {}, u: (2, 0, 0), v: (0, 0, 2)) }},
            objects: {{ "ceiling": (shape: Plane(point: {}), material: Lambertian(color: 0)),
                        "floor": (shape: Plane(point: {}), material: Lambertian(color: 1)) }})"#,
            v(0.1, 1.0, 0.2),
            v(0.1, 0.0, 0.2),
            v(-1.0, height, -1.0),
            v(0.0, 4.0, 0.0),
            v(0.0, 0.0, 0.0)
        );
        shoot_all(&text)[0].pixel(0, 0).x
    };
    for (at, integrator) in [0.0, 7.3, -1e4, 1e6].into_iter().flat_map(|at| BOTH.map(|i| (at, i))) {
        let (flush, below) = (seen(at, 4.0, integrator), seen(at, 3.999, integrator));
        assert!((flush / below - 1.0).abs() < 0.01, "{at} {integrator}: {flush} and {below}");
    }
}
