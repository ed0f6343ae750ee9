//! Fields that replace those of nodes.

use super::{TRIANGLE, object, read_with, try_read};
use crate::appearance::material::MaterialBinding;
use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::base::time::Time;
use crate::camera::path::Lens;
use crate::testing::GltfFixture as Fixture;
use serde_json::json;

#[test]
fn overrides_replace_fields_of_nodes() {
    let file = || {
        let mut file = Fixture::with(json!({
            "nodes": [
                { "name": "body", "mesh": 0, "translation": [1, 2, 3], "scale": [2, 2, 2] },
                { "name": "lamp", "extensions": { "KHR_lights_punctual": { "light": 0 } } },
                { "name": "eye", "camera": 0 },
            ],
            "cameras": [{ "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 1, "znear": 0, "zfar": 9 } }],
            "extensions": { "KHR_lights_punctual": { "lights": [{ "type": "directional" }] } },
            "materials": [{}],
        }));
        file.triangle(TRIANGLE);
        file.json["meshes"][0]["primitives"][0]["material"] = json!(0);
        file
    };
    let text = |overrides: &str| {
        format!(
        "(materials: {{ \"steel\": Metal() }}, timeline: (frames: 2, fps: 1), objects: {{
            \"robot\": (shape: Scene(file: \"robot.glb\", light_unit: Radiometric, override: {{ {overrides} }})) }})"
    )
    };
    let sequence = read_with(
        file(),
        &text(
            "
        \"body\": (material: \"steel\", visible: [(0, true), (1, false)], translation: (5, 0, 0)),
        \"lamp\": (on: [(0, false), (1, true)], color: (1, 0, 0), intensity: [(0, 0), (1, 3)]),
        \"eye\": (projection: Orthographic(height: 7), aperture: 0.5, focus: 3, shutter: 0.25),
    ",
        ),
    );
    let body = object(&sequence, "robot/body");
    assert_eq!(body.made_of, MaterialBinding::One(0));
    let second = Time::from_integer(1);
    assert_eq!(body.transform.at(second).transform_point3(DVec3::ONE), DVec3::new(7.0, 2.0, 2.0));
    assert_eq!([0, 1].map(|t| body.visible.at(Time::from_integer(t))), [true, false]);
    let light = &sequence.lights[0].value;
    assert_eq!([0, 1].map(|t| light.on.at(Time::from_integer(t))), [false, true]);
    assert!((light.intensity.at(second) - 3.0 / std::f64::consts::PI).abs() < 1e-15);
    assert_eq!(light.color, Rgb::X.into());
    let camera = &sequence.cameras[0].value;
    assert_eq!((&camera.aperture, &camera.shutter), (&0.5.into(), &0.25.into()));
    assert_eq!(camera.lens, Lens::Orthographic { height: 7.0.into() });
    let inline = read_with(file(), &text("\"body\": (material: Metal(fuzz: 0.5))"));
    let MaterialBinding::One(index) = object(&inline, "robot/body").made_of else { panic!("one material") };
    assert_eq!(inline.materials[index as usize].name, "objects.\"robot/body\".material");
    let fault = |overrides: &str| try_read(file(), &text(overrides)).expect_err("a fault");
    assert!(fault("\"bodi\": (visible: false)").contains("did you mean `body`?"));
    assert!(fault("\"lamp\": (material: \"steel\")").contains("only a mesh has a material"));
    assert!(fault("\"body\": (on: false)").contains("an override has no field `on`"));
    assert!(fault("\"body\": (material: \"steal\")").contains("did you mean `steel`?"));
}
