//! Tests of files: what is in them, and what Kinora's own reader makes of it.

use super::*;
use crate::base::time::Time;
use crate::sequence::{load, parse};
use serde_json::Value;

const OPTIONS: Options =
    Options { container: Container::Binary, tolerance: 0.01, light_unit: LightUnit::Photometric };

fn sequence(text: &str) -> Sequence {
    parse("a.ron", text).unwrap_or_else(|faults| panic!("{faults}"))
}

fn json(text: &str) -> Value {
    let options = Options { container: Container::Text, ..OPTIONS };
    serde_json::from_slice(&exported(&sequence(text), options).expect("a file").bytes).expect("JSON")
}

/// The sequence as Kinora reads it again. Its nodes are below the object `s`.
fn read_again(given: &Sequence) -> Sequence {
    let folder = tempfile::tempdir().expect("a folder");
    let bytes = exported(given, OPTIONS).expect("a file").bytes;
    std::fs::write(folder.path().join("s.glb"), bytes).expect("written");
    let frames = given.timeline.frames;
    let text = format!(
        "(timeline: (frames: {frames}, fps: {}), objects: {{ \"s\": (shape: Scene(\"s.glb\")) }})",
        given.timeline.rate
    );
    let path = folder.path().join("again.ron");
    std::fs::write(&path, text).expect("written");
    load(&path).unwrap_or_else(|error| panic!("{error}"))
}

/// The world transform of the object with this name.
fn world(sequence: &Sequence, name: &str, time: Time) -> DAffine3 {
    let at =
        |name: &str| sequence.objects.iter().find(|object| object.name == name).map(|object| &object.value);
    let object = at(name).unwrap_or_else(|| panic!("no object {name}"));
    let above = std::iter::successors(Some(object), |object| {
        object.parent.map(|parent| &sequence.objects[parent].value)
    });
    let placed = above.fold(DAffine3::IDENTITY, |inner, object| object.transform.at(time) * inner);
    DAffine3::from_mat3(sequence.up.matrix()) * placed
}

const MOVING: &str = r#"(
    timeline: (frames: 48, fps: 24),
    camera: (position: (0, 1, 8), path: [Orbit(turns: 1)]),
    objects: {
        "arm": (shape: Group, pivot: (0, 3, 1), rotation: Euler(z: [(0, -36, InSine), (2, 40)], x: 20),
            translation: [(0, (0, 0, 0), Smooth), (1, (1, 2, 3)), (2, (1, 0, 0))], scale: (1, 2, 0.5)),
        "ball": (shape: Sphere(center: (0.5, 0, 0), radius: 0.5), parent: "arm", translation: (1, 2, 3),
            rotation: AxisAngle(axis: (1, 1, 0), angle: [(0, 0), (2, 720)]), pivot: (0, 1, 0)),
        "box": (shape: Box(min: (0, 0, 0), max: (1, 2, 3)), scale: [(0, 1, Step), (0.5, 2), (1.5, 3)]),
        "child": (shape: Torus(), parent: "ball", translation: (0, 0, 4)),
        "still": (shape: Cone(), rotation: Euler(x: 10, y: 20, z: 30), pivot: (1, 0, 0), scale: (1, 3, 1)),
        "spline": (shape: Cylinder(), translation: [(0, (0, 0, 0), CatmullRom), (1, (3, 0, 0), CatmullRom), (2, (3, 3, 0))]),
    },
)"#;

/// The node of an object with its shape and the place of the shape: shapes move relative to their nodes.
#[test]
fn transforms_come_back() {
    let given = sequence(MOVING);
    let again = read_again(&given);
    for name in ["arm", "child", "still", "spline"] {
        for frame in 0..given.timeline.frames {
            let time = given.timeline.clock(frame).time;
            let (a, b) = (world(&given, name, time), world(&again, &format!("s/{name}"), time));
            let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
            // Groups and shapes without a mesh of their own keep their space, but for the pivot.
            let offset = if name == "arm" { DVec3::new(0.0, 3.0, 1.0) } else { DVec3::ZERO };
            for point in points {
                let (p, q) = (a.transform_point3(point + offset), b.transform_point3(point));
                assert!((p - q).length() <= 1e-6 * (1.0 + p.length()), "{name} at {time}: {p} {q}");
            }
        }
    }
    // Shapes: the points of the bounds of the meshes.
    // Chords of a sphere need not touch its bounds. They are within the tolerance for a radius of 1/2, which scales double.
    for (name, mesh, off) in
        [("ball", "s/ball shape", 0.5 * 2.0 * OPTIONS.tolerance), ("box", "s/box shape", 0.0)]
    {
        let index = given.objects.iter().position(|object| object.name == name).expect("an object");
        let bounds = given.objects[index].value.shape.bounds().expect("finite");
        let of_mesh = |object: &&crate::sequence::Named<crate::sequence::Object>| {
            matches!(object.value.shape, Shape::Mesh(_)) && object.name.starts_with(mesh)
        };
        let object = again.objects.iter().find(of_mesh).expect("a mesh");
        let own = object.value.shape.bounds().expect("finite");
        for frame in 0..given.timeline.frames {
            let time = given.timeline.clock(frame).time;
            let (a, b) = (world(&given, name, time), world(&again, &object.name, time));
            for (p, q) in bounds.corners().into_iter().zip(own.corners()) {
                let (p, q) = (a.transform_point3(p), b.transform_point3(q));
                let most = off + 1e-6 * (1.0 + p.length());
                assert!((p - q).length() <= most, "{name} at {time}: {p} {q}");
            }
        }
    }
}

#[test]
fn cameras_come_back() {
    let given = sequence(MOVING);
    let again = read_again(&given);
    let (a, b) = (given.fitted_camera(0), again.cameras.iter().find(|camera| camera.name.starts_with("s/")));
    let b = &b.expect("a camera").value;
    for frame in 0..given.timeline.frames {
        let clock = given.timeline.clock(frame);
        let (a, b) = (a.at(&clock, None).expect("a camera"), b.at(&clock, None).expect("a camera"));
        assert!((a.position - b.position).length() <= 1e-6 * a.position.length());
        assert!((a.basis.forward - b.basis.forward).length() <= 1e-6, "frame {frame}");
        assert!((a.basis.up - b.basis.up).length() <= 1e-6, "frame {frame}");
    }
}

#[test]
fn equal_shapes_share_a_mesh() {
    let file = json(
        r#"(objects: { "a": (shape: Sphere(radius: 2)), "b": (shape: Sphere(center: (3, 0, 0))),
        "c": (shape: Sphere(), material: (color: (1, 0, 0))), "d": (shape: Box(min: (0, 0, 0), max: (1, 1, 1))) })"#,
    );
    let mesh = |index: usize| file["nodes"][index]["mesh"].as_u64();
    assert_eq!([0, 1, 2, 3].map(mesh), [Some(0), Some(0), Some(1), Some(2)]);
    assert_eq!(file["nodes"][0]["scale"], serde_json::json!([2.0, 2.0, 2.0]));
}

#[test]
fn switches_and_colours_of_lights_are_keyed() {
    let text = r#"(timeline: (frames: 48, fps: 24), lights: {
        "a": Point(position: (0, 2, 0), intensity: 2, attenuation: (constant: 0, quadratic: 1), on: [(0, true), (0.5, false), (1, true)]),
        "b": Directional(direction: (0, -1, 0), color: [(0, (1, 1, 1)), (1, (1, 0, 0))]),
        "c": Spot(position: [(0, (0, 5, 0)), (1, (1, 5, 0))], target: (0, 0, 0), angle: 60, inner_angle: 40),
    })"#;
    let given = sequence(text);
    let again = read_again(&given);
    assert_eq!(again.lights.len(), 3);
    for (a, b) in given.lights.iter().zip(&again.lights) {
        for frame in 0..48 {
            let time = given.timeline.clock(frame).time;
            let level = |light: &crate::appearance::light::LightTracks| {
                let on = f32::from(u8::from(light.on.at(time)));
                light.color.at(time) * light.intensity.at(time) as f32 * on
            };
            let factor = match (&a.value.kind, a.value.kind.at(time)) {
                // Imported lights are 10 000 times as bright, and fade as much faster.
                (_, crate::appearance::light::Source::Directional { .. }) => 1.0,
                _ => 1e4,
            };
            let (given, read) = (level(&a.value) * factor, level(&b.value));
            // The spot light does not fade: only its colour is compared.
            if a.name != "c" {
                assert!((given - read).length() <= 1e-4 * factor, "{} at {time}: {given} {read}", a.name);
            }
        }
    }
}

#[test]
fn metallic_roughness_materials_come_back() {
    let text = r##"(materials: {
        "gold": MetallicRoughness(color: (1, 0.75, 0.25), metallic: 1, roughness: 0.25, coat: 0.5, coat_roughness: 0.125),
        "lamp": (color: (0, 0, 0), diffuse: 0, ambient: 0, emission: 5, emission_color: (1, 0.5, 0)),
        "glass": (color: (1, 1, 1), diffuse: 0, refraction: 1, ior: 1.25, absorption: (0, 0.5, 1)),
        "matt": (color: (0.5, 0.25, 0), diffuse: 1),
    }, objects: { "a": (shape: Sphere(), material: "gold"), "b": (shape: Sphere(), material: "lamp"),
        "c": (shape: Sphere(), material: "glass"), "d": (shape: Sphere(), material: "matt") })"##;
    let given = sequence(text);
    let again = read_again(&given);
    let start = Time::from_integer(0);
    let lobes = |sequence: &Sequence, index: usize| {
        let material = sequence.materials[index].value.at(start, crate::film::LayerId::CONSTANT);
        (material.lobes, material.medium)
    };
    let close = |a: crate::base::color::Rgb, b: crate::base::color::Rgb| (a - b).length() < 1e-5;
    let (gold, read) = (lobes(&given, 0).0, lobes(&again, 0).0);
    assert_eq!((read.metallic, read.roughness, read.microfacet), (gold.metallic, gold.roughness, 1.0));
    assert!(close(read.base, gold.base));
    assert_eq!((read.coat.share, read.coat.roughness), (0.5, 0.125));
    assert!(close(lobes(&again, 1).0.emission, crate::base::color::Rgb::new(5.0, 2.5, 0.0)));
    let (glass, medium) = lobes(&again, 2);
    assert_eq!((medium.ior, glass.refraction), (1.25, crate::base::color::Rgb::ONE));
    assert!(close(medium.absorption, crate::base::color::Rgb::new(0.0, 0.5, 1.0)), "{}", medium.absorption);
    let matt = lobes(&again, 3);
    assert!(close(matt.0.base, crate::base::color::Rgb::new(0.5, 0.25, 0.0)) && matt.1.ior == 1.0);
}

#[test]
fn visibility_steps() {
    let given = sequence(
        r#"(timeline: (frames: 24, fps: 24), objects: {
        "a": (shape: Sphere(), visible: [(0, true), (0.5, false)]), "b": (shape: Sphere(), visible: false) })"#,
    );
    let again = read_again(&given);
    for frame in 0..24 {
        let time = given.timeline.clock(frame).time;
        let visible = |name: &str| {
            let object = again.objects.iter().find(|object| object.name == name).expect("an object");
            object.value.visible.at(time)
        };
        assert_eq!((visible("s/a"), visible("s/b")), (frame < 12, false));
    }
}

/// The same bytes again, in both forms.
#[test]
fn exports_are_deterministic() {
    let given = sequence(MOVING);
    for container in [Container::Binary, Container::Text] {
        let options = Options { container, ..OPTIONS };
        assert_eq!(exported(&given, options), exported(&given, options));
    }
}
