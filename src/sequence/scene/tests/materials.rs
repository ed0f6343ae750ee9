//! Materials of scenes.

use super::{TRIANGLE, object, read, read_with};
use crate::appearance::material::{MaterialBinding, ScalarTextureTracks};
use crate::appearance::texture::{Texture, TextureTracks};
use crate::base::color::Rgb;
use crate::base::time::Time;
use crate::sequence::Sequence;
use crate::testing::GltfFixture as Fixture;
use serde_json::json;

fn material(sequence: &Sequence, index: u32) -> &crate::appearance::material::MaterialTracks {
    &sequence.materials[index as usize].value
}

#[test]
fn materials_follow_the_metallic_roughness_model() {
    let mut file = Fixture::with(json!({
        "nodes": [{ "name": "part", "mesh": 0 }, { "name": "glass", "mesh": 1 }, { "name": "pane", "mesh": 2 },
            { "name": "sign", "mesh": 3 }],
        "materials": [
            { "name": "paint", "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.25, 1, 0.5],
                "metallicFactor": 0.75, "roughnessFactor": 0.5 }, "emissiveFactor": [1, 0, 0],
              "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 3 }, "KHR_materials_ior": { "ior": 1.25 },
                  "KHR_materials_clearcoat": { "clearcoatFactor": 0.75, "clearcoatRoughnessFactor": 0.125 } } },
            { "name": "glass", "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 0 }, "extensions": {
                "KHR_materials_transmission": { "transmissionFactor": 1 },
                "KHR_materials_volume": { "thicknessFactor": 0.1, "attenuationDistance": 2, "attenuationColor": [0.25, 1, 1] } } },
            { "name": "pane", "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 0 }, "extensions": {
                "KHR_materials_transmission": { "transmissionFactor": 0.5 } } },
            { "name": "sign", "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.5, 0, 0.25] }, "alphaMode": "BLEND",
              "extensions": { "KHR_materials_unlit": {} } },
        ],
    }));
    for index in 0..4 {
        file.triangle(TRIANGLE);
        file.json["meshes"][index]["primitives"][0]["material"] = json!(index);
    }
    let sequence = read(file);
    let of = |name: &str| {
        let MaterialBinding::One(index) = object(&sequence, name).made_of else { panic!("one material") };
        material(&sequence, index)
    };
    let paint = of("robot/part");
    assert_eq!((&paint.base, &paint.microfacet), (&Rgb::new(0.5, 0.25, 1.0).into(), &1.0.into()));
    assert_eq!(paint.metallic, ScalarTextureTracks::Constant(0.75.into()));
    assert_eq!(paint.roughness, ScalarTextureTracks::Constant(0.5.into()));
    assert_eq!(paint.coat, ScalarTextureTracks::Constant(0.75.into()));
    assert_eq!(paint.coat_roughness, ScalarTextureTracks::Constant(0.125.into()));
    assert_eq!(
        (&paint.emission.strength, &paint.emission.tint),
        (&1.0.into(), &Rgb::new(3.0, 0.0, 0.0).into())
    );
    assert_eq!((&paint.ior, paint.base.has_alpha()), (&1.25.into(), false));
    let glass = of("robot/glass");
    assert_eq!((&glass.refraction.strength, &glass.microfacet), (&1.0.into(), &0.0.into()));
    // A quarter is left after a distance of 2.
    let absorption = glass.absorption.at(Time::from_integer(0));
    assert!((absorption - Rgb::new(std::f32::consts::LN_2, 0.0, 0.0)).length() < 1e-6, "{absorption}");
    let pane = of("robot/pane");
    assert_eq!(pane.transparency.strength, (0.5 * (1.0 - 0.2 * 0.2)).into());
    assert_eq!(pane.base.at(Time::from_integer(0)), Texture::Color(Rgb::splat(0.5)));
    let sign = of("robot/sign");
    assert_eq!((&sign.emission.strength, &sign.microfacet), (&1.0.into(), &0.0.into()));
    assert!(sign.base.has_alpha() && matches!(sign.base, TextureTracks::Product(_)));
}

#[test]
fn an_own_material_goes_before_and_notes_name_what_is_left_out() {
    let mut file = Fixture::with(json!({ "nodes": [{ "name": "part", "mesh": 0 }],
        "materials": [{ "extensions": { "KHR_materials_sheen": {} } }] }));
    file.triangle(TRIANGLE);
    let text = "(materials: { \"steel\": Metal() },
        objects: { \"robot\": (shape: Scene(\"robot.glb\"), material: \"steel\") })";
    let sequence = read_with(file, text);
    assert_eq!(object(&sequence, "robot/part").made_of, MaterialBinding::One(0));
    let notes = sequence.notes().join("\n");
    assert!(notes.contains(":2: left out of the scene: KHR_materials_sheen of 1 material"), "{notes}");
}
