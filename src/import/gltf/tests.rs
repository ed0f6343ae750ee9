//! Tests of the reader with files that they write.

use super::{AlphaMode, GltfScene, MeshMaterial, from_bytes};
use crate::appearance::texture::{TextureFilter, Wrap};
use crate::base::color::Rgb;
use crate::base::files::Root;
use crate::base::math::{DQuat, DVec2, DVec3};
use crate::geometry::mesh::{MeshError, TriangleMesh};
use crate::testing::{GltfFixture as Fixture, Random};
use serde_json::{Value, json};
use std::path::Path;
use std::sync::LazyLock;

/// Reads the bytes of a file.
fn scene(bytes: &[u8]) -> Result<GltfScene, MeshError> {
    // A root that contains nothing that files name.
    static ROOT: LazyLock<Root> = LazyLock::new(|| Root::of(Path::new(env!("CARGO_MANIFEST_DIR"))));
    from_bytes(bytes, Path::new(env!("CARGO_MANIFEST_DIR")), &ROOT)
}

/// The message about a file that must be wrong.
fn fault(file: Fixture) -> String {
    scene(&file.glb()).expect_err("a wrong file").to_string()
}

/// A file with one node that shows one mesh of these primitives.
fn with_mesh(mut file: Fixture, primitives: Value) -> Fixture {
    let mesh = file.push("meshes", json!({ "name": "part", "primitives": primitives }));
    file.push("nodes", json!({ "mesh": mesh }));
    file
}

fn good(file: Fixture) -> GltfScene {
    scene(&file.glb()).unwrap_or_else(|error| panic!("{error}"))
}

fn mesh(scene: &GltfScene) -> &TriangleMesh {
    &scene.meshes[0].as_ref().expect("a mesh").mesh
}

const QUAD: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0];

#[test]
fn indices_of_all_types_give_the_same_triangles() {
    for (component, width) in [(5121, 1), (5123, 2), (5125, 4)] {
        let mut file = Fixture::default();
        let positions = file.floats("VEC3", 3, &QUAD);
        let bytes: Vec<u8> =
            [0u32, 1, 2, 2, 1, 3].iter().flat_map(|index| index.to_le_bytes()[..width].to_vec()).collect();
        let indices = file.accessor(&bytes, component, "SCALAR", 6);
        let file = with_mesh(file, json!([{ "attributes": { "POSITION": positions }, "indices": indices }]));
        let scene = good(file);
        assert_eq!(mesh(&scene).triangles(), [[0, 1, 2], [2, 1, 3]]);
        assert_eq!(mesh(&scene).positions()[3], DVec3::new(1.0, 1.0, 0.0));
        assert!(!mesh(&scene).has_normals());
    }
}

#[test]
fn strips_and_fans_are_triangles_and_the_rest_is_named() {
    for (mode, expected) in [(5, [[0, 1, 2], [1, 3, 2]]), (6, [[1, 2, 0], [2, 3, 0]])] {
        let mut file = Fixture::default();
        let positions = file.floats("VEC3", 3, &QUAD);
        let attributes = json!({ "POSITION": positions });
        let parts = json!([
            { "attributes": attributes, "mode": mode },
            { "attributes": attributes, "mode": 0 },
            { "attributes": attributes, "mode": 1 },
            { "attributes": attributes, "mode": 3 },
        ]);
        let scene = good(with_mesh(file, parts));
        assert_eq!(mesh(&scene).triangles(), expected);
        assert_eq!(scene.left_out, ["lines of 2 primitives", "points of 1 primitive"]);
    }
}

#[test]
fn integers_are_normalised_or_not() {
    let mut file = Fixture::default();
    let positions = file.accessor(&[0, 0, 0, 0, 127, 0, 0, 0, 0, 128, 0, 0], 5120, "VEC3", 3);
    file.json["bufferViews"][0]["byteStride"] = json!(4);
    file.json["accessors"][0]["normalized"] = json!(true);
    let colors = file.accessor(&[255, 0, 51, 255, 0, 255, 0, 255, 102, 0, 0, 255], 5121, "VEC4", 3);
    file.json["accessors"][1]["normalized"] = json!(true);
    let uvs = file.accessor(&[0, 0, 2, 0, 7, 0, 0, 0, 1, 0, 1, 0], 5123, "VEC2", 3);
    let attributes = json!({ "POSITION": positions, "COLOR_0": colors, "TEXCOORD_0": uvs });
    file.set(json!({ "extensionsUsed": ["KHR_mesh_quantization"], "extensionsRequired": ["KHR_mesh_quantization"] }));
    let scene = good(with_mesh(file, json!([{ "attributes": attributes }])));
    assert_eq!(mesh(&scene).positions()[1..], [DVec3::X, DVec3::NEG_Y]);
    assert_eq!(mesh(&scene).corner_colors(0).expect("colours")[0], Rgb::new(1.0, 0.0, 0.2));
    // v goes upwards.
    let uvs = mesh(&scene).corner_uvs(0).expect("coordinates");
    assert_eq!(uvs, [DVec2::new(0.0, -1.0), DVec2::new(7.0, 1.0), DVec2::new(1.0, 0.0)]);
}

#[test]
fn sparse_elements_replace_others_and_zeros() {
    for dense in [true, false] {
        let mut file = Fixture::default();
        let positions = file.floats("VEC3", 3, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 9.0, 9.0, 9.0]);
        let indices = file.view(&[if dense { 2 } else { 1 }, 2]);
        let values: Vec<u8> =
            [0.0f32, 1.0, 0.0, 2.0, 0.0, 0.0].iter().flat_map(|value| value.to_le_bytes()).collect();
        let values = file.view(&values);
        let count = if dense { 1 } else { 2 };
        file.json["accessors"][0]["sparse"] = json!({
            "count": count,
            "indices": { "bufferView": indices, "componentType": 5121 },
            "values": { "bufferView": values },
        });
        if !dense {
            file.json["accessors"][0].as_object_mut().expect("an accessor").remove("bufferView");
        }
        let scene = good(with_mesh(file, json!([{ "attributes": { "POSITION": positions } }])));
        let expected =
            if dense { [DVec3::ZERO, DVec3::X, DVec3::Y] } else { [DVec3::ZERO, DVec3::Y, 2.0 * DVec3::X] };
        assert_eq!(mesh(&scene).positions(), expected);
    }
}

#[test]
fn primitives_become_one_mesh_with_slots() {
    let mut file = Fixture::with(json!({ "materials": [{ "name": "a" }, { "name": "b" }] }));
    let positions = file.floats("VEC3", 3, &QUAD[..9]);
    let normals = file.floats("VEC3", 3, &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    let plain = json!({ "POSITION": positions });
    let parts = json!([
        { "attributes": plain, "material": 1 },
        { "attributes": { "POSITION": positions, "NORMAL": normals }, "material": 0 },
        { "attributes": plain },
    ]);
    let scene = good(with_mesh(file, parts));
    assert_eq!(scene.materials.len(), 3);
    assert_eq!(scene.meshes[0].as_ref().expect("a mesh").material, MeshMaterial::Slots);
    assert_eq!([0, 1, 2].map(|part| mesh(&scene).material_of(part)), [Some(1), Some(0), Some(2)]);
    assert_eq!(mesh(&scene).triangles(), [[0, 1, 2], [3, 4, 5], [6, 7, 8]]);
    assert!(mesh(&scene).has_normals());
}

#[test]
fn materials_are_read_with_their_extensions() {
    let file = Fixture::with(json!({
        "images": [{ "bufferView": 0 }],
        "samplers": [{ "wrapS": 33071, "wrapT": 33648, "magFilter": 9728 }],
        "textures": [{ "source": 0, "sampler": 0 }],
        "materials": [{
            "name": "m",
            "pbrMetallicRoughness": { "baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5,
                "roughnessFactor": 0.25, "baseColorTexture": { "index": 0 } },
            "normalTexture": { "index": 0, "scale": 0.75 },
            "emissiveFactor": [1, 0.5, 0],
            "alphaMode": "MASK", "alphaCutoff": 0.3,
            "extensions": {
                "KHR_materials_emissive_strength": { "emissiveStrength": 4 },
                "KHR_materials_ior": { "ior": 1.4 },
                "KHR_materials_transmission": { "transmissionFactor": 0.5 },
                "KHR_materials_volume": { "thicknessFactor": 1, "attenuationDistance": 2,
                    "attenuationColor": [0.5, 0.5, 1] },
                "KHR_materials_clearcoat": { "clearcoatFactor": 0.75, "clearcoatRoughnessFactor": 0.1,
                    "clearcoatTexture": { "index": 0 }, "clearcoatNormalTexture": { "index": 0 } },
                "KHR_materials_sheen": {},
            },
        }],
        "extensionsUsed": ["KHR_materials_clearcoat", "KHR_materials_sheen", "EXT_something"],
    }));
    let mut file = file;
    file.view(&[0; 8]);
    let scene = good(file);
    let material = &scene.materials[0];
    assert_eq!((material.base, material.metallic, material.roughness), ([0.1, 0.2, 0.3, 0.4], 0.5, 0.25));
    assert_eq!(material.emissive, DVec3::new(4.0, 2.0, 0.0));
    assert_eq!((material.alpha, material.ior, material.transmission), (AlphaMode::Mask(0.3), 1.4, 0.5));
    assert_eq!(material.volume.expect("a volume").distance, 2.0);
    let texture = material.base_texture.as_ref().expect("a texture");
    assert_eq!(material.normal_texture, Some((texture.clone(), 0.75)));
    assert_eq!((texture.wrap, texture.filter), ([Wrap::Clamp, Wrap::Mirror], TextureFilter::Nearest));
    assert_eq!((material.coat.share, material.coat.roughness), (0.75, 0.1));
    assert_eq!(
        (&material.coat.share_texture, &material.coat.roughness_texture),
        (&Some(texture.clone()), &None)
    );
    assert_eq!(
        scene.left_out,
        [
            "KHR_materials_sheen of 1 material",
            "normal maps of clear coats of 1 material",
            "the blur of rough transmission of 1 material",
            "EXT_something",
        ]
    );
}

#[test]
fn nodes_come_parents_first_with_their_places() {
    let matrix = [0.0, 2.0, 0.0, 0.0, -3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 5.0, 6.0, 7.0, 1.0];
    let file = Fixture::with(json!({
        "nodes": [
            { "name": "hand", "translation": [0, 1, 0], "rotation": [0, 0, 2, 2] },
            { "name": "arm", "children": [0], "scale": [1, -2, 1] },
            { "name": "base", "children": [1], "matrix": matrix },
            { "name": "elsewhere" },
        ],
        "scenes": [{ "nodes": [3] }, { "nodes": [2] }],
        "scene": 1,
    }));
    let scene = good(file);
    let names: Vec<_> = scene.nodes.iter().map(|node| node.name.as_str()).collect();
    assert_eq!(names, ["base", "arm", "hand"]);
    assert_eq!(scene.nodes.iter().map(|node| node.parent).collect::<Vec<_>>(), [None, Some(0), Some(1)]);
    let half = std::f64::consts::FRAC_1_SQRT_2;
    assert!((scene.nodes[2].rotation - DQuat::from_xyzw(0.0, 0.0, half, half)).length() < 1e-15);
    let base = &scene.nodes[0];
    assert_eq!((base.translation, base.scale), (DVec3::new(5.0, 6.0, 7.0), DVec3::new(2.0, 3.0, 4.0)));
    assert!((base.rotation * DVec3::X - DVec3::Y).length() < 1e-15);
}

#[test]
fn wrong_files_have_a_message_with_their_place() {
    let nodes = |nodes: Value| fault(Fixture::with(json!({ "nodes": nodes })));
    assert_eq!(nodes(json!([{ "mesh": 3 }])), "nodes[0].mesh: there is no meshes[3]; the file has 0 of them");
    assert_eq!(
        nodes(json!([{ "children": [1] }, { "children": [1] }])),
        "nodes[1]: it is a child of two nodes"
    );
    assert_eq!(
        nodes(json!([{ "rotation": [0, 0, 0, 0] }])),
        "nodes[0]: its `rotation` is zero, which is no rotation"
    );
    assert_eq!(nodes(json!([{ "scale": [1, 1] }])), "nodes[0].scale: expected 3 numbers from -1e30 to 1e30");
    assert_eq!(
        nodes(json!([{ "scale": [1, 1, 1e31] }])),
        "nodes[0].scale: expected 3 numbers from -1e30 to 1e30"
    );
    let required = json!({ "extensionsRequired": ["KHR_draco_mesh_compression"] });
    let message = fault(Fixture::with(required));
    assert_eq!(
        message,
        "it needs `KHR_draco_mesh_compression`, which Kinora does not read; export it without"
    );
    let old = fault(Fixture::with(json!({ "asset": { "version": "1.0" } })));
    assert_eq!(old, "asset: it is of version \"1.0\" of glTF; Kinora reads version 2.0");
    assert!(scene(b"{ nothing").expect_err("no JSON").to_string().starts_with("its JSON is wrong: "));
    assert_eq!(scene(b"{}").expect_err("no file").to_string(), "it has no `asset`");
}

/// A circle of nodes is never reached, or has a node with two parents.
#[test]
fn circles_of_nodes_end() {
    let circle = json!([{ "children": [1] }, { "children": [0] }, { "name": "free" }]);
    let scene = good(Fixture::with(json!({ "nodes": circle })));
    assert_eq!(scene.nodes.len(), 1);
    let scenes = json!({ "nodes": circle, "scenes": [{ "nodes": [0] }] });
    assert_eq!(
        fault(Fixture::with(scenes)),
        "scenes[0]: its nodes[0] is its own ancestor, or below such a node"
    );
    let below = json!([{ "children": [1] }, { "children": [2] }, { "name": "leaf" }]);
    let twice = good(Fixture::with(json!({ "nodes": below, "scenes": [{ "nodes": [2, 0, 1] }] })));
    let parents: Vec<_> = twice.nodes.iter().map(|node| (node.index, node.parent)).collect();
    assert_eq!(parents, [(0, None), (1, Some(0)), (2, Some(1))], "listed nodes are shown once");
    let part = good(Fixture::with(json!({ "nodes": below, "scenes": [{ "nodes": [1] }] })));
    let parents: Vec<_> = part.nodes.iter().map(|node| (node.index, node.parent)).collect();
    assert_eq!(parents, [(1, None), (2, Some(0))], "parents that are not listed are left out");
    let own = json!({ "nodes": [{ "children": [0] }], "scenes": [{ "nodes": [0] }] });
    assert!(fault(Fixture::with(own)).contains("is its own ancestor"));
}

#[test]
fn wrong_geometry_has_a_message_with_its_place() {
    let part = |edit: &dyn Fn(&mut Fixture)| {
        let mut file = Fixture::default();
        let positions = file.floats("VEC3", 3, &QUAD);
        let indices = file.indices(&[0, 1, 2]);
        edit(&mut file);
        fault(with_mesh(file, json!([{ "attributes": { "POSITION": positions }, "indices": indices }])))
    };
    let short = part(&|file| file.json["accessors"][0]["count"] = json!(1_000_000_000_000u64));
    // The memory for all meshes is checked first where there is too little of it.
    assert!(short.contains("too short") || short.contains("of memory"), "{short}");
    let short = part(&|file| file.json["accessors"][0]["count"] = json!(5));
    assert_eq!(short, "accessors[0]: bufferViews[0] is too short for its 5 elements");
    let zeros = part(&|file| {
        file.json["accessors"][0] = json!({ "componentType": 5126, "type": "VEC3", "count": 20_000_000 });
    });
    assert_eq!(zeros, "accessors[0]: it has 20000000 elements, but no bufferView");
    let index = part(&|file| file.data[48] = 4);
    assert_eq!(index, "meshes[0].primitives[0]: there is no vertex 4; the primitive has 4");
    let nan = part(&|file| file.data[4..8].copy_from_slice(&f32::NAN.to_le_bytes()));
    assert_eq!(nan, "accessors[0]: its element 0 is not finite");
    let view = part(&|file| file.json["bufferViews"][0]["byteLength"] = json!(u64::MAX));
    assert!(view.starts_with("bufferViews[0]: it has 18446744073709551615 bytes"), "{view}");
    let stride = part(&|file| file.json["bufferViews"][0]["byteStride"] = json!(4));
    assert_eq!(stride, "accessors[0]: its elements have 12 bytes, but lie 4 bytes apart");
    let kind = part(&|file| file.json["accessors"][0]["type"] = json!("VEC2"));
    assert_eq!(kind, "accessors[0]: its elements have 2 numbers, not 3");
}

#[test]
fn other_files_must_exist_within_the_root() {
    let of = |uri: &str| {
        let mut file = Fixture::default();
        file.set(json!({ "buffers": [{ "byteLength": 4, "uri": uri }] }));
        scene(file.json.to_string().as_bytes()).expect_err("no such file").to_string()
    };
    assert_eq!(of("none.bin"), "buffers[0]: cannot read \"none.bin\": there is no such file");
    assert!(of("../../../../../../etc/passwd").contains("--allow-outside"));
    assert!(of("/etc/passwd").contains("--allow-outside"));
    assert_eq!(of("https://host/a.bin"), "buffers[0]: its `uri` is neither a relative path nor a data URI");
    assert_eq!(of("data:;base64,AAAA"), "buffers[0]: it has 3 bytes, not 4");
}

/// A file of every kind of content.
pub fn sampler() -> Fixture {
    let mut file = Fixture::with(json!({
        "materials": [{ "name": "m", "emissiveFactor": [1, 0.5, 0], "alphaMode": "BLEND",
            "extensions": { "KHR_materials_volume": { "thicknessFactor": 1 } } }],
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 0.8, "znear": 0.1 } },
            { "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 2, "znear": 0, "zfar": 9 } }],
        "extensions": { "KHR_lights_punctual": { "lights": [
            { "type": "point", "intensity": 7 }, { "type": "directional", "color": [1, 0, 0] },
            { "type": "spot", "spot": { "innerConeAngle": 0.1, "outerConeAngle": 0.3 } } ] } },
        "extensionsUsed": ["KHR_lights_punctual"],
        "nodes": [
            { "name": "root", "children": [1, 2, 3], "translation": [1, 2, 3] },
            { "mesh": 0, "rotation": [0, 0, 0, 1], "scale": [1, 2, 3] },
            { "camera": 1, "children": [4] },
            { "extensions": { "KHR_lights_punctual": { "light": 2 } } },
            { "camera": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1] },
        ],
        "scenes": [{ "nodes": [0] }],
    }));
    let positions = file.floats("VEC3", 3, &QUAD);
    let colors = file.accessor(&[255; 16], 5121, "VEC4", 4);
    let indices = file.indices(&[0, 1, 2, 2, 1, 3]);
    let joints = file.accessor(&[0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0], 5121, "VEC4", 4);
    let weights = file.floats("VEC4", 4, &[0.25; 16]);
    let times = file.floats("SCALAR", 1, &[0.0, 0.5]);
    let turns = file.floats("VEC4", 4, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.5, 0.0, 1.0]);
    let shares = file.floats("SCALAR", 1, &[0.0, 1.0]);
    let attributes =
        json!({ "POSITION": positions, "COLOR_0": colors, "JOINTS_0": joints, "WEIGHTS_0": weights });
    let part = json!({ "attributes": attributes, "indices": indices, "material": 0,
        "targets": [{ "POSITION": positions }] });
    file.set(json!({
        "skins": [{ "joints": [0, 2] }],
        "animations": [{ "samplers": [{ "input": times, "output": turns }, { "input": times, "output": shares }],
            "channels": [
                { "sampler": 0, "target": { "node": 2, "path": "rotation" } },
                { "sampler": 1, "target": { "node": 1, "path": "weights" } },
                { "sampler": 1, "target": { "path": "pointer", "extensions": { "KHR_animation_pointer":
                    { "pointer": "/extensions/KHR_lights_punctual/lights/0/intensity" } } } } ] }],
    }));
    file.json["nodes"][1]["skin"] = json!(0);
    file.json["nodes"][3]["mesh"] = json!(0);
    file.json["nodes"][3]["extensions"]["EXT_mesh_gpu_instancing"] =
        json!({ "attributes": { "TRANSLATION": positions } });
    file.push("meshes", json!({ "primitives": [part] }));
    file
}

#[test]
fn the_text_form_is_the_same_scene() {
    let (binary, text) = (good(sampler()), scene(sampler().text().as_bytes()).expect("a scene"));
    assert_eq!(binary.nodes, text.nodes);
    assert_eq!(
        (binary.cameras, binary.lights, binary.materials),
        (text.cameras.clone(), text.lights.clone(), text.materials.clone())
    );
    assert_eq!(mesh(&text).digest(), binary.meshes[0].as_ref().expect("a mesh").mesh.digest());
}

/// Files that are cut off or changed at any byte give an error or a scene, and no panic.
#[test]
fn damaged_files_do_not_panic() {
    let whole = sampler().glb();
    assert!(scene(&whole).is_ok());
    let mut errors = 0;
    for end in 0..whole.len() {
        errors += usize::from(scene(&whole[..end]).is_err());
    }
    // Only padding may be missing, and the file states its length.
    assert_eq!(errors, whole.len());
    let mut random = Random(11);
    for at in 0..whole.len() {
        for byte in [0, 0xff, b'9', (random.unit() * 256.0) as u8] {
            let mut bytes = whole.clone();
            bytes[at] = byte;
            let _ = scene(&bytes);
        }
    }
}

/// Numbers of the JSON part that are replaced by absurd ones give an error or a scene, and no panic.
#[test]
fn absurd_numbers_do_not_panic() {
    let numbers = |value: &Value| {
        let mut paths = Vec::new();
        collect(value, String::new(), &mut paths);
        paths
    };
    let file = sampler();
    for path in numbers(&file.json) {
        for number in
            [json!(-1), json!(0), json!(3), json!(1e9), json!(u64::MAX), json!(1e300), json!(0.5), json!("x")]
        {
            let mut file = sampler();
            *file.json.pointer_mut(&path).expect("a number") = number;
            let _ = scene(&file.glb());
        }
    }
}

/// The paths of all numbers below a value.
fn collect(value: &Value, path: String, paths: &mut Vec<String>) {
    match value {
        Value::Number(_) => paths.push(path),
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(at, value)| collect(value, format!("{path}/{at}"), paths));
        }
        Value::Object(members) => {
            members.iter().for_each(|(key, value)| collect(value, format!("{path}/{key}"), paths));
        }
        _ => {}
    }
}
