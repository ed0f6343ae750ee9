//! Solids made of solids, and objects that planes cut open.

use crate::command::{contents, folder, kinora};
use crate::support::shoot_all;
use kinora::base::color::Rgb;
use std::fs;

/// What the camera sees of these objects, which use the materials "glass" and "matt".
fn pictured(objects: &str) -> Vec<Rgb> {
    let text = format!(
        r#"(output: (size: (40, 30)), quality: (bounces: 6), background: (0.2, 0.3, 0.5),
        camera: (position: (3, 2.3, 5), target: (0, 0, 0), projection: Perspective(fov: 30)),
        lights: {{ "sun": Directional(direction: (-1, -2, -1.5)) }},
        materials: {{ "matt": (color: (0.8, 0.4, 0.2)), "glass": Dielectric(ior: 1.5, color: (0.9, 0.7, 0.5)) }},
        objects: {{ "floor": (shape: Plane(point: (0, -1.5, 0)), material: (color: (0.6, 0.6, 0.6))), {objects} }})"#
    );
    shoot_all(&text).remove(0).film.radiance().collect()
}

/// Both shapes look the same, in matt and in glass.
#[track_caller]
fn look_alike(shape: &str, other: &str) {
    for material in ["matt", "glass"] {
        let [one, other] = [shape, other]
            .map(|shape| pictured(&format!(r#""it": (shape: {shape}, material: "{material}")"#)));
        let differ = one.iter().zip(&other).filter(|(a, b)| (**a - **b).length() > 1e-5).count();
        // A pixel's ray may graze an edge, where one of both shapes is met by chance.
        assert!(differ <= 2, "{differ} pixels differ in {material}");
        let empty = pictured("");
        assert!(one.iter().zip(&empty).filter(|(a, b)| a != b).count() > 100, "the shape is not seen");
    }
}

const BLOCK: &str = "Box(min: (-1, -1, -1), max: (1, 1, 1))";

/// Faces that parts share leave neither sheets nor gaps, where glass would show them.
#[test]
fn solids_look_like_equal_shapes() {
    look_alike(
        "Union([Box(min: (-1, -1, -1), max: (0.1, 1, 1)), Box(min: (0.1, -1, -1), max: (1, 1, 1))])",
        BLOCK,
    );
    look_alike(
        "Difference([Box(min: (-1, -1, -1), max: (3, 1, 1)), Box(min: (1, -1, -1), max: (3, 1, 1))])",
        BLOCK,
    );
    look_alike("Intersection([Sphere(), Box(min: (-2, -2, -2), max: (2, 2, 2))])", "Sphere()");
    look_alike("Difference([Sphere(), Sphere(center: (0, 5, 0))])", "Sphere()");
    look_alike(
        "Difference([Difference([Sphere(), Box(min: (0, -2, -2), max: (2, 2, 2))]), Torus(center: (0, 9, 0))])",
        "Intersection([Sphere(), Plane(normal: (1, 0, 0))])",
    );
}

/// Points on planes through the origin have no error.
#[test]
fn faces_through_the_origin_look_like_others() {
    let half = |x: f64| {
        pictured(&format!(
            r#""it": (shape: Sphere(), material: "glass", clip: [Plane(point: ({x}, 0, 0), normal: (1, 0, 0))])"#
        ))
    };
    let (exact, beside) = (half(0.0), half(1e-9));
    let differ = exact.iter().zip(&beside).filter(|(a, b)| (**a - **b).length() > 1e-5).count();
    assert!(differ <= 2, "{differ} pixels differ");
}

#[test]
fn cuts_look_like_intersections_with_half_spaces() {
    let cut = |material: &str| {
        pictured(&format!(
            r#""it": (shape: Sphere(), material: "{material}", clip: [Plane(normal: (1, 0, 0.4)), Plane(point: (0, 0.5, 0), normal: (0, 1, 0))])"#
        ))
    };
    let solid = |material: &str| {
        pictured(&format!(
            r#""it": (shape: Intersection([Sphere(), Plane(normal: (1, 0, 0.4)), Plane(point: (0, 0.5, 0), normal: (0, 1, 0))]), material: "{material}")"#
        ))
    };
    for material in ["matt", "glass"] {
        assert_eq!(cut(material), solid(material), "{material}");
    }
}

/// Planes move with the objects that have them, and cut what is below.
#[test]
fn groups_cut_what_is_below_them() {
    let below = pictured(
        r#""all": (shape: Group, rotation: Euler(y: 40), translation: (0.3, 0, 0), clip: [Plane(point: (0.2, 0, 0), normal: (1, 0, 0))]),
        "ball": (shape: Sphere(), material: "matt", parent: "all", translation: (0.2, 0, 0), scale: (1, 1.2, 0.9))"#,
    );
    let alone = pictured(
        r#""all": (shape: Group, rotation: Euler(y: 40), translation: (0.3, 0, 0)),
        "ball": (shape: Sphere(), material: "matt", parent: "all", translation: (0.2, 0, 0), scale: (1, 1.2, 0.9), clip: [Plane(normal: (1, 0, 0))])"#,
    );
    let differ = below.iter().zip(&alone).filter(|(a, b)| (**a - **b).length() > 1e-5).count();
    assert!(differ <= 2, "{differ} pixels differ");
}

#[test]
fn caps_have_a_material_of_their_own() {
    let glowing = r#"(emission: 7, emission_color: (1, 0, 0), color: (0, 0, 0))"#;
    let seen = |fields: &str| {
        let objects =
            format!(r#""it": (shape: Sphere(), material: "matt", clip: [Plane(normal: (0, 0, 1))]{fields})"#);
        pictured(&objects).iter().filter(|light| light.x == 7.0).count()
    };
    assert_eq!(seen(""), 0);
    assert!(seen(&format!(", cap: {glowing}")) > 100);
    // An open shape has nothing to close.
    let open = pictured(&format!(
        r#""it": (shape: Cylinder(capped: false), material: "matt", clip: [Plane(normal: (0, 0, 1))], cap: {glowing})"#
    ));
    assert!(open.iter().all(|light| light.x < 7.0));
    // The nearest object above that has one gives the material of the cap.
    let above = pictured(&format!(
        r#""all": (shape: Group, clip: [Plane(normal: (0, 0, 1))], cap: {glowing}),
        "ball": (shape: Sphere(), material: "matt", parent: "all"),
        "other": (shape: Sphere(center: (2, 0, 0), radius: 0.6), parent: "all", cap: "matt")"#
    ));
    let without = pictured(&format!(
        r#""all": (shape: Group, clip: [Plane(normal: (0, 0, 1))], cap: {glowing}),
        "ball": (shape: Sphere(), material: "matt", parent: "all")"#
    ));
    let caps = |picture: &[Rgb]| picture.iter().filter(|light| light.x == 7.0).count();
    assert!(caps(&above) > 100 && caps(&above) <= caps(&without));
}

/// A single object that moves is in no tree, whatever its shape costs.
#[test]
fn single_solids_move() {
    for object in [
        "shape: Sphere(), clip: [Plane(point: [(0, (0.5, 0, 0)), (2, (-0.5, 0, 0))], normal: (1, 0, 0))]",
        "shape: Union([Sphere(), Torus()]), rotation: Euler(x: [(0, 0), (2, 90)])",
        "shape: Difference([Sphere(), Sphere(center: (0.5, 0, 1))]), visible: [(0, true), (1, false), (2, true)]",
    ] {
        let text = format!(
            r#"(timeline: (frames: 3, keys: Frames), output: (size: (20, 16)), camera: (position: (0, 2, 5)),
            lights: {{ "sun": Directional(direction: (-1, -2, -1.5)) }}, objects: {{ "it": ({object}) }})"#
        );
        let frames: Vec<Vec<Rgb>> =
            shoot_all(&text).into_iter().map(|frame| frame.film.radiance().collect()).collect();
        assert!(frames.len() == 3 && frames[0] != frames[1], "{object}");
    }
}

#[test]
fn frames_with_moving_cuts_are_the_same_however_they_are_rendered() {
    const SCENE: &str = r##"(
        timeline: (frames: 6, keys: Frames), output: (size: (32, 20), files: ["f_#.png"]),
        camera: (position: (3, 3, 6)),
        lights: { "sun": Point(position: (4, 9, 5)), "lamp": Point(position: (-4, 3, 5), on: [(0, true), (3, false)]) },
        objects: {
            "floor": (shape: Plane(point: (0, -1, 0))),
            "all": (shape: Group, clip: [Plane(point: [(0, (1, 0, 0)), (2, (0, 0, 0)), (4, (0, 0, 0))], normal: (1, 0, 0))]),
            "ball": (shape: Sphere(), parent: "all", material: (color: "#d8341c")),
            "nut": (shape: Difference([Sphere(center: (-1, 0, 1)), Sphere(center: (-1, 0.6, 1.4))]),
                rotation: Euler(y: [(0, 0), (5, 50)]), material: (color: "#1c34d8", mirror: 0.3)),
        },
    )"##;
    let rendered = |options: &[&str]| {
        let folder = folder();
        fs::write(folder.path().join("cut.ron"), SCENE).expect("writable");
        kinora(folder.path(), &[&["render", "cut.ron", "-q"], options].concat());
        contents(folder.path())
    };
    let all = rendered(&["--threads", "1"]);
    assert_eq!(all.len(), 8);
    assert_eq!(all, rendered(&["--threads", "3"]));
    assert_eq!(all, rendered(&["--no-reuse"]));
    let some = rendered(&["--frames", "2,5"]);
    assert!(some.iter().all(|(name, bytes)| all.get(name) == Some(bytes)), "frames alone");
    assert_ne!(all.get("f_0.png"), all.get("f_1.png"));
}
