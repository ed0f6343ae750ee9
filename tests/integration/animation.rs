//! What changes over time changes in exactly its frames: lights, visibility, scales, parents.

use crate::support::{Shot, shoot_all};
use kinora::base::color::Rgb;

fn picture(shot: &Shot) -> Vec<[u32; 3]> {
    shot.film.radiance().map(|c| c.to_array().map(f32::to_bits)).collect()
}

/// The largest difference of two pictures.
fn difference(a: &Shot, b: &Shot) -> f32 {
    a.film.radiance().zip(b.film.radiance()).map(|(a, b)| (a - b).abs().max_element()).fold(0.0, f32::max)
}

/// A ball on a floor, under `lights`.
fn lit(timeline: &str, lights: &str) -> Vec<Shot> {
    shoot_all(&format!(
        r#"(timeline: ({timeline}), output: (size: (24, 18)), background: 0.1, lights: {{ {lights} }},
        objects: {{ "floor": (shape: Plane(point: (0, -1, 0))), "ball": (shape: Sphere(), material: (specular: 0.3)) }})"#
    ))
}

const PLACES: [&str; 3] =
    ["position: (-3, 4, 2)", "position: (0, 5, 1), color: (1, 0.5, 0.2)", "position: (3, 4, 2)"];

#[test]
fn each_light_shows_from_exactly_its_frame_on() {
    // Per light: its keys, and whether it is on in each of seven frames.
    let keyed = [
        ("on: [(0, true), (3, false), (5, true)]", [1, 1, 1, 0, 0, 1, 1]),
        // Between two frames: from the next frame on.
        ("on: [(0, false), (1.5, true), (3.999, false)]", [0, 0, 1, 1, 0, 0, 0]),
        ("intensity: [(0, 0, Step), (4, 1, Step), (6, 0)]", [0, 0, 0, 0, 1, 1, 0]),
    ];
    let lights = |on: Option<usize>| -> String {
        let light = |k: usize| match on {
            None => format!("\"{k}\": Point({}, {}),", PLACES[k], keyed[k].0),
            Some(frame) => format!("\"{k}\": Point({}, on: {}),", PLACES[k], keyed[k].1[frame] == 1),
        };
        (0..3).map(light).collect()
    };
    let shots = lit("frames: 7, keys: Frames", &lights(None));
    for (frame, shot) in shots.iter().enumerate() {
        let still = &lit("frames: 1", &lights(Some(frame)))[0];
        assert!(difference(shot, still) <= 1e-6, "frame {frame}: {}", difference(shot, still));
        assert_eq!(shot.work.shadow, still.work.shadow, "frame {frame}");
        // Frames without a change are equal to the last bit, others are not.
        if let Some(before) = frame.checked_sub(1) {
            let changes = keyed.iter().any(|(_, on)| on[before] != on[frame]);
            assert_eq!(picture(shot) != picture(&shots[before]), changes, "frame {frame}");
        }
    }
}

#[test]
fn keys_in_seconds_fall_on_their_frames_at_any_rate() {
    // A tenth of a second at 10 frames per second, and 30 frames of NTSC: 30 · 1001 / 30000 s.
    for (rate, second, frame) in
        [("10", "0.1", 1), ("(30000, 1001)", "1.001", 30), ("25", "0.28", 7), ("60", "0.05", 3)]
    {
        let light = format!(r#""l": Point({}, on: [(0, false), ({second}, true)])"#, PLACES[0]);
        let shots = lit(&format!("frames: 32, fps: {rate}"), &light);
        let on: Vec<bool> = shots.iter().map(|shot| shot.work.shadow > 0).collect();
        let expected: Vec<bool> = (0..32).map(|k| k >= frame).collect();
        assert_eq!(on, expected, "{second} s at {rate}");
    }
}

#[test]
fn fades_and_colours_weight_linearly() {
    let fade = r#""l": Point(position: (-3, 4, 2), intensity: [(0, 0), (4, 2)], color: [(0, (1, 1, 1)), (4, (1, 0, 0.5))])"#;
    for (frame, shot) in lit("frames: 5, keys: Frames", fade).iter().enumerate() {
        let s = frame as f64 / 4.0;
        let color = [1.0, 1.0 - s, 1.0 - 0.5 * s].map(|c| c * 2.0 * s);
        let still = format!(
            r#""l": Point(position: (-3, 4, 2), color: ({:?}, {:?}, {:?}))"#,
            color[0], color[1], color[2]
        );
        let off = difference(shot, &lit("frames: 1", &still)[0]);
        assert!(off <= 1e-6, "frame {frame}: {off}");
    }
}

#[test]
fn lights_keyed_alike_share_a_layer() {
    let layers = |lights: &str| lit("frames: 2, keys: Frames", lights)[0].film.weights.len();
    let light = |name: &str, keys: &str| format!("\"{name}\": Point(position: (1, 2, 3), {keys}),");
    let (a, b) = ("on: [(0, true), (1, false)]", "on: [(0, false), (1, true)]");
    assert_eq!(layers(""), 1);
    assert_eq!(layers(&[light("1", ""), light("2", "intensity: 0.5")].concat()), 1);
    assert_eq!(layers(&[light("1", a), light("2", ""), light("3", a)].concat()), 2);
    assert_eq!(layers(&[light("1", a), light("2", b), light("3", a), light("4", b)].concat()), 3);
    // Alike in their keys, different in what is constant.
    assert_eq!(
        layers(&[light("1", a), light("2", &format!("{a}, color: (1, 0, 0), intensity: 3"))].concat()),
        2
    );
    assert_eq!(
        layers(&[light("1", a), light("2", &format!("{a}, intensity: [(0, 1), (1, 0)]"))].concat()),
        3
    );
    // Where a light is does not weight it.
    assert_eq!(layers(r#""1": Point(position: [(0, (1, 2, 3)), (1, (3, 2, 1))])"#), 1);
}

#[test]
fn keyed_backgrounds_and_ambient_light_are_layers() {
    let shots = shoot_all(
        r#"(timeline: (frames: 3, keys: Frames), output: (size: (1, 1)), quality: (antialias: 1),
        background: [(0, (1, 0, 0)), (2, (0, 0, 1))], ambient: [(0, 0), (2, 4)],
        objects: { "mirror": (shape: Plane(), material: (color: 0.5, ambient: 0.25, mirror: 0.5)) })"#,
    );
    assert_eq!(shots[0].film.weights.len(), 3);
    assert_eq!(shots[0].film.layers(), 2, "the dark one is not held");
    for (shot, s) in shots.iter().zip([0.0, 0.5, 1.0]) {
        let expected = Rgb::new(0.5 * (1.0 - s), 0.0, 0.5 * s) + Rgb::splat(0.125 * 4.0 * s);
        assert!((shot.pixel(0, 0) - expected).abs().max_element() <= 1e-6);
    }
}

/// A scene with `objects` besides a floor, all fields of which may be keyed.
fn scene(frames: u32, objects: &str) -> Vec<Shot> {
    shoot_all(&format!(
        r#"(timeline: (frames: {frames}, keys: Frames), output: (size: (32, 24)), background: 0.2,
        camera: (position: (0, 2, 7), target: (0, 0.5, 0)), lights: {{ "l": Point(position: (3, 6, 5)) }},
        objects: {{ "floor": (shape: Plane(point: (0, -1, 0)), material: (mirror: 0.2)), {objects} }})"#
    ))
}

#[test]
fn a_scale_through_zero_hides_for_exactly_those_frames() {
    let empty = picture(&scene(1, "")[0]);
    let shapes = [
        "Sphere()",
        "Box(min: (-1, -1, -1), max: (1, 1, 1))",
        "Disk(normal: (0, 1, 1))",
        "Rectangle(corner: (-1, 0, 0), u: (2, 0, 0), v: (0, 1, 1))",
        "Triangle(a: (-1, 0, 0), b: (1, 0, 0), c: (0, 1, 0))",
        "Plane(point: (0, 0.1, 0))",
    ];
    for shape in shapes {
        for (scale, hidden) in [
            ("[(0, 1), (2, 0), (4, 1)]", [false, false, true, false, false]),
            ("[(0, 1), (2, -1), (4, 1)]", [false, true, false, true, false]),
            ("[(0, 0, Step), (1, 1, Step), (3, 0)]", [true, false, false, true, true]),
            ("[(0, (1, 1, 1)), (2, (1, 0, 1)), (4, (1, 1, 1))]", [false, false, true, false, false]),
            ("[(0, (0, 1, 1), Step), (4, (1, 1, 1))]", [true, true, true, true, false]),
        ] {
            let rotation = "rotation: AxisAngle(axis: (1, 2, 3), angle: 30)";
            for shot in scene(5, &format!(r#""o": (shape: {shape}, {rotation}, scale: {scale})"#))
                .iter()
                .zip(hidden)
                .enumerate()
            {
                let (frame, (shot, hidden)) = shot;
                assert!(shot.film.data.iter().all(|c| c.is_finite()), "{shape} {scale} frame {frame}");
                assert_eq!(picture(shot) == empty, hidden, "{shape} {scale} frame {frame}");
            }
        }
    }
}

#[test]
fn nearly_flat_scales_stay_finite() {
    for scale in ["1e-3", "1e-9", "1e-12", "(1, 1e-9, 1)", "(1e-12, 1, 1)", "(1e9, 1, 1e-9)"] {
        for shape in ["Sphere()", "Box(min: (-1, -1, -1), max: (1, 1, 1))", "Disk()"] {
            let shots = scene(
                1,
                &format!(r#""o": (shape: {shape}, rotation: Euler(x: 20, y: 30, z: 40), scale: {scale})"#),
            );
            assert!(shots[0].film.data.iter().all(|c| c.is_finite()), "{shape} {scale}");
        }
    }
}

/// All orders of three things.
fn orders([a, b, c]: [&str; 3]) -> [String; 6] {
    [[a, b, c], [a, c, b], [b, a, c], [b, c, a], [c, a, b], [c, b, a]].map(|order| order.join(", "))
}

#[test]
fn parents_carry_their_children_wherever_they_stand_in_the_file() {
    // (1, 0, 0) turned by 90 degrees about y is (0, 0, -1); lifted, and moved by half of the grandparent's scale.
    let chain = [
        r#""hand": (shape: Box(min: (-0.5, -0.5, -0.5), max: (0.5, 0.5, 0.5)), translation: (1, 0, 0), parent: "arm")"#,
        r#""arm": (shape: Group, translation: (0, 2, 0), rotation: AxisAngle(axis: (0, 1, 0), angle: 90), parent: "body")"#,
        r#""body": (shape: Group, scale: 0.5, translation: (0.25, 0, 0))"#,
    ];
    let flat = r#""hand": (shape: Box(min: (0, 0.75, -0.75), max: (0.5, 1.25, -0.25)))"#;
    let expected = &scene(1, flat)[0];
    let nothing = &scene(1, "")[0];
    assert!(difference(expected, nothing) > 0.1, "the box is in the picture");
    for objects in orders(chain) {
        let off = difference(&scene(1, &objects)[0], expected);
        assert!(off <= 1e-6, "{objects}: {off}");
    }
}

#[test]
fn moving_a_grandparent_moves_its_grandchildren() {
    let chain = [
        r#""hand": (shape: Sphere(radius: 0.5), parent: "arm")"#,
        r#""arm": (shape: Group, parent: "body")"#,
        r#""body": (shape: Group, translation: [(0, (-1, 0, 0)), (4, (1, 0, 0))])"#,
    ];
    for objects in orders(chain) {
        for (frame, shot) in scene(5, &objects).iter().enumerate() {
            let x = -1.0 + 0.5 * frame as f64;
            let still = scene(1, &format!(r#""hand": (shape: Sphere(center: ({x:?}, 0, 0), radius: 0.5))"#));
            assert_eq!(picture(shot), picture(&still[0]), "{objects} frame {frame}");
            assert_eq!(shot.work.bvh_builds + shot.work.bvh_refits, 1, "{objects} frame {frame}");
        }
    }
}

#[test]
fn hidden_parents_hide_all_below_them() {
    let empty = picture(&scene(1, "")[0]);
    let child = r#""hand": (shape: Sphere(), parent: "arm", visible: [(0, true), (5, false)])"#;
    for (arm, body, hidden) in [
        ("visible: [(0, true), (1, false), (2, true)]", "", [0, 1, 0, 0, 0, 1]),
        ("", "visible: [(0, false), (3, true)]", [1, 1, 1, 0, 0, 1]),
        (
            "visible: [(0, true), (1, false), (2, true)]",
            "visible: [(0, false), (1, true), (4, false)]",
            [1, 1, 0, 0, 1, 1],
        ),
        ("scale: [(0, 1, Step), (2, 0, Step), (3, 1)]", "", [0, 0, 1, 0, 0, 1]),
        ("", "scale: [(0, 1), (2, (1, 0, 1)), (4, 1)]", [0, 0, 1, 0, 0, 1]),
    ] {
        let chain = [
            child,
            &format!(r#""arm": (shape: Group, parent: "body", {arm})"#),
            &format!(r#""body": (shape: Group, {body})"#),
        ];
        for objects in orders(chain) {
            let shown: Vec<u8> =
                scene(6, &objects).iter().map(|shot| u8::from(picture(shot) == empty)).collect();
            assert_eq!(shown, hidden, "{objects}");
        }
    }
}

/// However objects in a flat one are turned, and whatever is in them in turn: rounding leaves no slivers.
#[test]
fn flat_parents_hide_all_that_is_turned_in_them() {
    let empty = picture(&scene(1, "")[0]);
    let turned = |axis: &str, angle: u32| format!("rotation: AxisAngle(axis: {axis}, angle: {angle})");
    for angle in (4..90).step_by(5) {
        let chain = [
            &format!(
                r#""hand": (shape: Box(min: (-1, -1, -1), max: (1, 1, 1)), parent: "arm", {})"#,
                turned("(2, 1, 1)", 70)
            ),
            &format!(r#""arm": (shape: Sphere(), parent: "body", {})"#, turned("(3, -1, 1)", angle + 11)),
            &format!(
                r#""body": (shape: Group, {}, scale: [(0, 1), (2, (0, 1, 1)), (4, 1)])"#,
                turned("(1, 2, 3)", angle)
            ),
        ];
        let objects = chain.map(String::as_str).join(", ");
        let hidden: Vec<bool> = scene(4, &objects).iter().map(|shot| picture(shot) == empty).collect();
        assert_eq!(hidden, [false, false, true, false], "{angle}");
    }
}

#[test]
fn a_visible_child_does_not_show_its_parents_shape() {
    let one = scene(1, r#""child": (shape: Sphere(center: (1, 0, 0), radius: 0.5))"#);
    let two = scene(
        1,
        r#""child": (shape: Sphere(center: (1, 0, 0), radius: 0.5), parent: "parent"), "parent": (shape: Sphere(radius: 0.5))"#,
    );
    let hidden = scene(
        2,
        r#""child": (shape: Sphere(center: (1, 0, 0), radius: 0.5), parent: "parent"),
        "parent": (shape: Sphere(radius: 0.5), visible: [(0, true), (1, false)])"#,
    );
    assert!(picture(&one[0]) != picture(&two[0]));
    assert_eq!(picture(&hidden[0]), picture(&two[0]));
    assert_eq!(picture(&hidden[1]), picture(&scene(1, "")[0]));
}

#[test]
fn the_exposure_is_keyed_and_leaves_the_radiance_as_it_is() {
    let shots = |exposure: &str| {
        shoot_all(&format!(
            r#"(timeline: (frames: 3, keys: Frames), output: (size: (8, 6), {exposure}), background: 0.1,
            objects: {{ "ball": (shape: Sphere()) }})"#
        ))
    };
    let (plain, exposed) = (shots(""), shots("exposure: [(0, -1), (2, 1)]"));
    assert_eq!(exposed.iter().map(|shot| shot.film.exposure).collect::<Vec<_>>(), [0.5, 1.0, 2.0]);
    assert!(plain.iter().all(|shot| shot.film.exposure == 1.0));
    assert!(plain.iter().zip(&exposed).all(|(a, b)| picture(a) == picture(b)));
}
