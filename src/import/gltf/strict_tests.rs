//! Tests of what the reader refuses, notes and shares.

use super::{GltfScene, ImageBytes, from_bytes};
use crate::base::files::Root;
use crate::base::math::{DQuat, DVec3};
use crate::geometry::mesh::MeshError;
use crate::testing::GltfFixture as Fixture;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::sync::Arc;

fn scene(bytes: &[u8]) -> Result<GltfScene, MeshError> {
    from_bytes(bytes, Path::new(env!("CARGO_MANIFEST_DIR")), &Root::anywhere())
}

fn good(file: Fixture) -> GltfScene {
    scene(&file.glb()).unwrap_or_else(|error| panic!("{error}"))
}

fn fault(file: Fixture) -> String {
    scene(&file.glb()).expect_err("a wrong file").to_string()
}

const TRIANGLE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// A file whose only node shows a triangle.
fn triangle() -> Fixture {
    let mut file = Fixture::with(json!({ "nodes": [{ "mesh": 0 }] }));
    file.triangle(TRIANGLE);
    file
}

fn part(file: &mut Fixture) -> &mut Value {
    &mut file.json["meshes"][0]["primitives"][0]
}

fn normalized(file: &mut Fixture, accessor: usize) {
    file.json["accessors"][accessor]["normalized"] = json!(true);
}

#[test]
fn indices_and_joints_are_whole_numbers() {
    let mut file = triangle();
    let indices = file.indices(&[0, 1, 2]);
    part(&mut file)["indices"] = json!(indices);
    normalized(&mut file, indices);
    assert_eq!(fault(file), "accessors[1]: indices are whole numbers, but it is `normalized`");
    let mut file = triangle();
    let indices = file.floats("SCALAR", 1, &[0.0, 1.0, 2.0]);
    part(&mut file)["indices"] = json!(indices);
    let types = "`5121 (unsigned byte)`, `5123 (unsigned short)` or `5125 (unsigned int)`";
    assert_eq!(fault(file), format!("accessors[1]: indices have the component type {types}"));
    let joints = |component: u32, bytes: &[u8], is_normalized: bool| {
        let mut file = triangle();
        let joints = file.accessor(bytes, component, "VEC4", 3);
        let weights = file.floats("VEC4", 4, &[1.0; 12]);
        let attributes = &mut part(&mut file)["attributes"];
        (attributes["JOINTS_0"], attributes["WEIGHTS_0"]) = (json!(joints), json!(weights));
        if is_normalized {
            normalized(&mut file, joints);
        }
        fault(file)
    };
    assert_eq!(
        joints(5121, &[0; 12], true),
        "accessors[1]: joints are whole numbers, but it is `normalized`"
    );
    let types =
        "accessors[1]: joints have the component type `5121 (unsigned byte)` or `5123 (unsigned short)`";
    assert_eq!([joints(5126, &[0; 48], false), joints(5120, &[0; 12], false)], [types, types]);
}

#[test]
fn weights_are_as_many_as_morph_targets() {
    let morphing = || {
        let mut file = triangle();
        part(&mut file)["targets"] = json!([{ "POSITION": 0 }]);
        file
    };
    let mut file = morphing();
    file.json["meshes"][0]["weights"] = json!([1, 2, 3]);
    assert_eq!(fault(file), "meshes[0]: it has 3 weights for 1 morph target");
    let mut file = morphing();
    file.json["nodes"][0]["weights"] = json!([0.5, 1]);
    assert_eq!(fault(file), "nodes[0]: it has 2 weights for 1 morph target");
    let keyed = |mut file: Fixture, values: &[f32]| {
        let (input, output) = (file.floats("SCALAR", 1, &[0.0, 1.0]), file.floats("SCALAR", 1, values));
        file.set(json!({ "animations": [{ "samplers": [{ "input": input, "output": output }],
            "channels": [{ "sampler": 0, "target": { "node": 0, "path": "weights" } }] }] }));
        file
    };
    let wrong = fault(keyed(morphing(), &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]));
    assert_eq!(wrong, "animations[0].samplers[0]: its 2 keys need 2 values, not 6");
    assert_eq!(good(keyed(morphing(), &[0.0, 1.0])).animations[0].channels[0].width, 1);
    let none = good(keyed(triangle(), &[0.0, 1.0]));
    assert_eq!(none.left_out, ["the animation of weights without morph targets of 1 channel"]);
}

/// Channels that name the same accessors share their numbers, and all keys together must fit into memory.
#[test]
fn channels_share_times_and_values() {
    let file = |channels: usize, keys: u16| {
        let mut file = Fixture::with(json!({ "nodes": [{ "name": "arm" }] }));
        let times: Vec<f32> = (0..keys).map(f32::from).collect();
        let input = file.floats("SCALAR", 1, &times);
        let output = file.accessor(&vec![0; 3 * usize::from(keys) + 4], 5120, "VEC3", keys.into());
        let channel = json!({ "sampler": 0, "target": { "node": 0, "path": "translation" } });
        file.set(json!({ "animations": [{ "samplers": [{ "input": input, "output": output }],
            "channels": vec![channel; channels] }] }));
        file
    };
    let scene = good(file(3, 5));
    let channels = &scene.animations[0].channels;
    assert!(channels.iter().all(|channel| Arc::ptr_eq(&channel.times, &channels[0].times)));
    assert!(channels.iter().all(|channel| Arc::ptr_eq(&channel.values, &channels[0].values)));
    // 130 GB as tracks, from a file of 2 MB. Two seconds if each were computed anew.
    let many = fault(file(20_000, 60_000));
    assert!(many.contains("of memory, but only"), "{many}");
}

#[test]
fn buffers_are_read_once_and_only_as_far_as_they_are_needed() {
    let folder = tempfile::tempdir().expect("a folder");
    let read =
        |file: &Fixture| from_bytes(file.json.to_string().as_bytes(), folder.path(), &Root::anywhere());
    let mut file = triangle();
    let path = folder.path().join("large.bin");
    fs::write(&path, &file.data).expect("a disk");
    // A file of a terabyte, almost all of which is a hole.
    let large = fs::OpenOptions::new().write(true).open(&path).and_then(|file| file.set_len(1 << 40));
    if large.is_err() {
        // This file system has no files of that size.
        return;
    }
    let uri = |length: usize| json!({ "byteLength": length, "uri": "large.bin" });
    file.set(json!({ "buffers": [uri(36), uri(4), uri(36), uri(1)] }));
    let positions = |scene: &GltfScene| scene.meshes[0].as_ref().expect("a mesh").mesh.positions().to_vec();
    assert_eq!(positions(&read(&file).expect("a scene")), [DVec3::ZERO, DVec3::X, DVec3::Y]);
    // A view beyond its own buffer is wrong, although another buffer has read more of the file.
    file.json["bufferViews"][0]["buffer"] = json!(1);
    let message = read(&file).expect_err("too short").to_string();
    assert_eq!(message, "bufferViews[0]: it has 36 bytes from byte 0 on, but its buffer has 4 bytes");
    file.set(json!({ "buffers": [uri(1 << 39)] }));
    let message = read(&file).expect_err("too long").to_string();
    assert_eq!(message, "buffers[0]: it has 549755813888 bytes; a buffer has at most 8589934592");
    file.set(json!({ "buffers": [{ "byteLength": 4, "uri": "" }] }));
    let message = read(&file).expect_err("a folder").to_string();
    assert_eq!(message, "buffers[0]: cannot read \"\": it is a folder");
    file.set(json!({ "buffers": [{ "byteLength": 4, "uri": "x".repeat(5000) }] }));
    let message = read(&file).expect_err("a long name").to_string();
    assert!(message.starts_with("buffers[0]: cannot read \"xxx") && message.len() < 200, "{message}");
}

#[test]
fn equal_images_share_their_bytes() {
    let mut file = Fixture::default();
    let (first, second) = (file.view(&[1, 2, 3, 4]), file.view(&[1, 2, 3, 4]));
    let same = json!({ "buffer": 0, "byteOffset": 0, "byteLength": 4 });
    let third = file.push("bufferViews", same);
    let text = "data:;base64,AAAA";
    file.set(json!({ "images": [{ "bufferView": first }, { "bufferView": third }, { "bufferView": second },
        { "uri": text }, { "uri": text }] }));
    let scene = good(file);
    let address = |index: usize| {
        let ImageBytes::Given(bytes) = &scene.images[index].bytes else { panic!("bytes") };
        bytes.as_ptr()
    };
    assert_eq!((address(0), address(3)), (address(1), address(4)));
    assert_ne!(address(0), address(2));
}

#[test]
fn flat_scales_and_matrices_hide_with_a_note() {
    let mut file = triangle();
    file.set(json!({ "nodes": [
        { "mesh": 0, "scale": [1, 0, 1] },
        { "mesh": 0, "matrix": [0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0, 4, 5, 6, 1] },
        { "mesh": 0, "scale": [0, 0, 0] },
    ] }));
    let (input, output) =
        (file.floats("SCALAR", 1, &[0.0, 1.0]), file.floats("VEC3", 3, &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]));
    file.set(json!({ "animations": [{ "samplers": [{ "input": input, "output": output }],
        "channels": [{ "sampler": 0, "target": { "node": 2, "path": "scale" } }] }] }));
    let scene = good(file);
    // The third node grows.
    assert_eq!(scene.left_out, ["surfaces flattened by a scale of 0 of 2 nodes"]);
    let node = &scene.nodes[1];
    assert_eq!((node.scale, node.translation), (DVec3::new(2.0, 0.0, 3.0), DVec3::new(4.0, 5.0, 6.0)));
    assert!((node.rotation * DVec3::X - DVec3::Y).length() < 1e-15);
}

#[test]
fn instances_are_counted_by_any_attribute() {
    let instanced = |attributes: Value| {
        let mut file = triangle();
        file.json["nodes"][0]["extensions"] =
            json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
        file
    };
    let scene = good(instanced(json!({ "_ID": 0 })));
    let instances = scene.nodes[0].instances.as_ref().expect("instances");
    assert_eq!(instances.len(), 3);
    assert!(
        instances
            .iter()
            .all(|one| (one.translation, one.rotation, one.scale)
                == (DVec3::ZERO, DQuat::IDENTITY, DVec3::ONE))
    );
    let none = fault(instanced(json!({})));
    assert_eq!(none, "nodes[0].extensions.EXT_mesh_gpu_instancing.attributes: there are no attributes");
    let mut differ = instanced(json!({ "TRANSLATION": 0, "_ID": 1 }));
    differ.floats("SCALAR", 1, &[1.0, 2.0]);
    assert!(fault(differ).ends_with("its attributes differ in their number of instances"));
}

#[test]
fn joints_that_are_not_read_are_noted() {
    let mut file = triangle();
    let (joints, weights) = (file.accessor(&[0; 12], 5121, "VEC4", 3), file.floats("VEC4", 4, &[1.0; 12]));
    for set in 0..5 {
        let attributes = &mut part(&mut file)["attributes"];
        attributes[format!("JOINTS_{set}")] = json!(joints);
        attributes[format!("WEIGHTS_{set}")] = json!(weights);
    }
    file.set(json!({ "nodes": [{ "mesh": 0, "skin": 0 }, {}], "skins": [{ "joints": [1] }] }));
    file.json["nodes"][0]["extensions"] =
        json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 0 } } });
    let scene = good(file);
    assert_eq!(scene.nodes[0].instances, None);
    assert_eq!(
        scene.left_out,
        ["instances of skinned meshes of 1 node", "joints beyond the fourth set of 1 primitive"]
    );
}

#[test]
fn bind_matrices_are_maps_of_space() {
    let with = |last: f32| {
        let mut matrix = [0.0f32; 16];
        [0, 5, 10, 15].into_iter().for_each(|at| matrix[at] = 1.0);
        matrix[15] = last;
        let mut file = triangle();
        let matrices = file.floats("MAT4", 16, &matrix);
        file.set(json!({ "skins": [{ "joints": [0], "inverseBindMatrices": matrices }] }));
        file
    };
    assert_eq!(fault(with(2.0)), "skins[0]: the last row of its inverse bind matrix 0 is not 0, 0, 0, 1");
    assert!(good(with(1.0f32.next_down())).skins[0].is_some());
}

#[test]
fn rotations_of_keys_are_not_zero() {
    let mut file = Fixture::with(json!({ "nodes": [{}] }));
    let output = file.floats("VEC4", 4, &[0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0]);
    let input = file.floats("SCALAR", 1, &[0.0, 1.0]);
    file.set(json!({ "animations": [{ "samplers": [{ "input": input, "output": output }],
        "channels": [{ "sampler": 0, "target": { "node": 0, "path": "rotation" } }] }] }));
    let message = fault(file);
    assert_eq!(message, "animations[0].samplers[0]: the rotation of its key 1 is zero, which is no rotation");
}

#[test]
fn objects_are_objects() {
    let of = |members: Value| fault(Fixture::with(members));
    assert_eq!(of(json!({ "nodes": [3] })), "nodes[0]: expected an object, as { ... }");
    assert_eq!(
        of(json!({ "nodes": [{ "extensions": [1] }] })),
        "nodes[0].extensions: expected an object, as { ... }"
    );
    assert_eq!(of(json!({ "extensions": 1 })), "extensions: expected an object, as { ... }");
    let material = json!({ "materials": [{ "pbrMetallicRoughness": 3 }] });
    assert_eq!(of(material), "materials[0].pbrMetallicRoughness: expected an object, as { ... }");
    assert_eq!(of(json!({ "asset": 2 })), "asset: expected an object, as { ... }");
    assert_eq!(
        scene(b"[]").expect_err("no object").to_string(),
        "it begins neither with `glTF`, as binary files do, nor with JSON's `{`"
    );
    assert!(
        scene(b"\x89PNG\r\n").expect_err("an image").to_string().starts_with("it begins neither with `glTF`")
    );
    assert!(scene(b"\xef\xbb\xbf \n{ \"asset\": { \"version\": \"2.0\" } }").is_ok());
}

#[test]
fn the_least_version_is_2_0() {
    let of = |asset: Value| scene(Fixture::with(json!({ "asset": asset })).json.to_string().as_bytes());
    assert!(of(json!({ "version": "2.1" })).is_ok());
    assert!(of(json!({ "version": "2.1", "minVersion": "2.0" })).is_ok());
    let message = of(json!({ "version": "2.1", "minVersion": "2.1" })).expect_err("too new").to_string();
    assert_eq!(message, "asset: it is of version \"2.1\" of glTF; Kinora reads version 2.0");
}

#[test]
fn cones_of_spots_are_in_order() {
    let of = |inner: f64, outer: f64| {
        let spot = json!({ "innerConeAngle": inner, "outerConeAngle": outer });
        let lights = json!({ "lights": [{ "type": "spot", "spot": spot }] });
        scene(&Fixture::with(json!({ "extensions": { "KHR_lights_punctual": lights } })).glb())
            .map_err(|error| error.to_string())
    };
    let place = "extensions.KHR_lights_punctual.lights[0]: ";
    assert_eq!(
        of(1.0, 0.5).expect_err("wrong"),
        format!("{place}its `innerConeAngle` 1 is above its `outerConeAngle` 0.5")
    );
    assert_eq!(
        of(1.0, 4.0).expect_err("wrong"),
        format!("{place}its `outerConeAngle` 4 is above half a turn; it is in radians")
    );
    // The float that is nearest to half a turn is a little more.
    assert!(of(0.0, f64::from(std::f32::consts::PI)).is_ok());
}

#[test]
fn products_stay_in_range_and_transmission_of_metal_is_noted() {
    let emitting = |strength: f64| {
        Fixture::with(json!({ "materials": [{ "emissiveFactor": [0, 1e10, 0],
            "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": strength } } }] }))
    };
    assert_eq!(
        fault(emitting(1e21)),
        "materials[0]: its `emissiveFactor` times its `emissiveStrength` is above 1e30"
    );
    assert_eq!(good(emitting(1e20)).materials[0].emissive.y, 1e30);
    let glass = |pbr: Value| {
        Fixture::with(json!({
            "images": [{ "uri": "data:;base64,AAAA" }], "textures": [{ "source": 0 }],
            "materials": [{ "pbrMetallicRoughness": pbr,
                "extensions": { "KHR_materials_transmission": { "transmissionFactor": 1 } } }],
        }))
    };
    let textured = json!({ "roughnessFactor": 0, "metallicRoughnessTexture": { "index": 0 } });
    assert_eq!(
        good(glass(textured)).left_out,
        ["transmission where an image says what is metal of 1 material"]
    );
    assert_eq!(good(glass(json!({ "roughnessFactor": 0 }))).left_out, [""; 0]);
}

#[test]
fn notes_name_whole_pointers_and_messages_real_limits() {
    let mut file = Fixture::with(json!({ "nodes": [{}] }));
    let input = file.floats("SCALAR", 1, &[0.0]);
    let channel = |pointer: &str| {
        json!({ "sampler": 0, "target": { "path": "pointer",
        "extensions": { "KHR_animation_pointer": { "pointer": pointer } } } })
    };
    file.set(json!({ "animations": [{ "samplers": [{ "input": input, "output": input }],
        "channels": [channel(""), channel("/nodes/0/weights/0"), channel("/a\u{1b}[31m")] }] }));
    assert_eq!(
        good(file).left_out,
        [
            "the animation of `/a\\u{1b}[31m` of 1 channel",
            "the animation of `/nodes/0/weights/0` of 1 channel",
            "the animation of `` of 1 channel",
        ]
    );
    let mut file = triangle();
    file.json["bufferViews"][0]["byteStride"] = json!(253);
    assert_eq!(fault(file), "bufferViews[0]: its `byteStride` is not from 1 to 252");
    let mut file = triangle();
    let colors = file.accessor(&[127; 12], 5120, "VEC4", 3);
    part(&mut file)["attributes"]["COLOR_0"] = json!(colors);
    assert!(fault(file).starts_with("accessors[1]: colours have the component type 5126 (float)"));
}

/// Meshes that are flat at rest stay, if something deforms them.
#[test]
fn flat_meshes_with_morph_targets_stay() {
    let flat = |indices: [u16; 3]| {
        let mut file = Fixture::with(json!({ "nodes": [{ "mesh": 0 }] }));
        file.triangle([[0.0; 3]; 3]);
        let (target, indices) = (file.floats("VEC3", 3, TRIANGLE.as_flattened()), file.indices(&indices));
        part(&mut file)["targets"] = json!([{ "POSITION": target }]);
        part(&mut file)["indices"] = json!(indices);
        good(file)
    };
    let scene = flat([0, 1, 2]);
    let mesh = scene.meshes[0].as_ref().expect("a mesh");
    assert!(mesh.is_flat && scene.left_out.is_empty());
    assert_eq!(mesh.deformer.as_ref().map(|deformer| deformer.targets()), Some(1));
    // Nothing gives an area to a triangle of two vertices.
    let scene = flat([0, 1, 1]);
    assert!(scene.meshes[0].is_none());
    assert_eq!(scene.left_out, ["surfaces without an area of 1 mesh"]);
}
