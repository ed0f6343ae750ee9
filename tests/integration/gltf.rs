//! Scenes of glTF files, as users see them.

use crate::command::{kinora, refused, run, stderr};
use crate::support::{folder, sequence_in, shoot};
use kinora::base::color::Rgb;
use kinora::sequence::{Sequence, load};
use serde_json::{Value, json};
use std::fs;
use std::io::Cursor;
use std::path::Path;

#[path = "../../src/testing/gltf.rs"]
#[allow(dead_code, reason = "unit tests use the rest")]
mod fixture;

use fixture::GltfFixture;

/// A file whose only node shows a square from -1 to 1, with these texture coordinates at its corners, in a material that
/// shows its own colour.
fn square(material: Value, corners: [[f32; 2]; 4], attributes: &[(&str, usize)]) -> GltfFixture {
    let mut file =
        GltfFixture::with(json!({ "nodes": [{ "name": "square", "mesh": 0 }], "materials": [material] }));
    file.json["materials"][0]["extensions"]["KHR_materials_unlit"] = json!({});
    extend(&mut file, corners, attributes);
    file
}

/// Adds the mesh. `attributes` are further ones, whose accessors come first.
fn extend(file: &mut GltfFixture, corners: [[f32; 2]; 4], attributes: &[(&str, usize)]) {
    let positions = [-1.0, -1.0, 0.0, 1.0, -1.0, 0.0, -1.0, 1.0, 0.0, 1.0, 1.0, 0.0];
    let mut all = json!({
        "POSITION": file.floats("VEC3", 3, &positions),
        "TEXCOORD_0": file.floats("VEC2", 2, corners.as_flattened()),
    });
    attributes.iter().for_each(|(name, accessor)| all[*name] = json!(accessor));
    let part = json!({ "attributes": all, "mode": 5, "material": 0 });
    file.push("meshes", json!({ "primitives": [part] }));
}

/// In glTF, v goes downwards: the lower left corner is (0, 1).
const PLAIN: [[f32; 2]; 4] = [[0.0, 1.0], [1.0, 1.0], [0.0, 0.0], [1.0, 0.0]];

/// The four pixels of a picture of the square: upper left, upper right, lower left, lower right.
fn pixels(folder: &Path, fields: &str) -> [Rgb; 4] {
    let text = format!(
        "(output: (size: (2, 2)), quality: (antialias: 1), background: (0.125, 0.25, 0.5),
        camera: (position: (0, 0, 5), projection: Orthographic(height: 2)),
        objects: {{ \"robot\": (shape: Scene(\"robot.glb\"){fields}) }})"
    );
    fs::write(folder.join("scene.ron"), text).expect("a disk");
    let sequence: Sequence = load(&folder.join("scene.ron")).unwrap_or_else(|error| panic!("{error}"));
    let shot = shoot(&sequence, 0..1).remove(0);
    [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| shot.pixel(x, y))
}

fn shown(file: GltfFixture) -> [Rgb; 4] {
    let folder = folder();
    fs::write(folder.path().join("robot.glb"), file.glb()).expect("a disk");
    pixels(folder.path(), "")
}

/// The bytes of a PNG of two by two pixels.
fn png(texels: [[u8; 4]; 4]) -> Vec<u8> {
    let image = image::RgbaImage::from_fn(2, 2, |x, y| image::Rgba(texels[(2 * y + x) as usize]));
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png).expect("an encoder");
    bytes.into_inner()
}

const RED: [u8; 4] = [255, 0, 0, 255];
const GREEN: [u8; 4] = [0, 255, 0, 255];
const BLUE: [u8; 4] = [0, 0, 255, 255];
const GREY: [u8; 4] = [255, 255, 255, 127];

const BACKGROUND: Rgb = Rgb::new(0.125, 0.25, 0.5);

/// A square with that picture as its base colour.
fn painted(info: Value, material: Value, texels: [[u8; 4]; 4]) -> GltfFixture {
    let mut material = material;
    material["pbrMetallicRoughness"]["baseColorTexture"] = info;
    let mut file = GltfFixture::default();
    let view = file.view(&png(texels));
    let rest = square(material, PLAIN, &[]).json;
    file.set(json!({ "nodes": rest["nodes"], "materials": rest["materials"] }));
    file.set(json!({ "images": [{ "bufferView": view, "mimeType": "image/png" }], "samplers": [{ "magFilter": 9728 }],
        "textures": [{ "source": 0, "sampler": 0 }] }));
    extend(&mut file, PLAIN, &[]);
    file
}

#[test]
fn images_lie_on_meshes_as_in_other_viewers() {
    let texels = [RED, GREEN, BLUE, GREY];
    let file = painted(json!({ "index": 0 }), json!({}), texels);
    assert_eq!(shown(file), [Rgb::X, Rgb::Y, Rgb::Z, Rgb::ONE]);
    // The lower left quarter, turned clockwise: the example of the extension.
    let info = json!({ "index": 0, "extensions": { "KHR_texture_transform": {
        "offset": [0, 1], "rotation": std::f64::consts::FRAC_PI_2, "scale": [0.5, 0.5] } } });
    assert_eq!(shown(painted(info, json!({}), texels)), [Rgb::Z; 4]);
    // The picture itself turned: its right side is up.
    let info = json!({ "index": 0, "extensions": { "KHR_texture_transform": {
        "offset": [0, 1], "rotation": std::f64::consts::FRAC_PI_2 } } });
    assert_eq!(shown(painted(info, json!({}), texels)), [Rgb::Z, Rgb::X, Rgb::ONE, Rgb::Y]);
}

#[test]
fn alpha_is_ignored_cut_or_mixed() {
    let clear = [0, 255, 0, 0];
    let texels = [RED, clear, BLUE, GREY];
    let of = |material: Value| shown(painted(json!({ "index": 0 }), material, texels));
    assert_eq!(of(json!({})), [Rgb::X, Rgb::Y, Rgb::Z, Rgb::ONE]);
    assert_eq!(of(json!({ "alphaMode": "MASK" })), [Rgb::X, BACKGROUND, Rgb::Z, BACKGROUND]);
    // No alpha reaches it.
    assert_eq!(of(json!({ "alphaMode": "MASK", "alphaCutoff": 2 })), [BACKGROUND; 4]);
    let low = json!({ "alphaMode": "MASK", "alphaCutoff": 0.25 });
    assert_eq!(of(low), [Rgb::X, BACKGROUND, Rgb::Z, Rgb::ONE]);
    let half = |color: Rgb, alpha: f32| color * alpha + BACKGROUND * (1.0 - alpha);
    let near = |found: [Rgb; 4], expected: [Rgb; 4]| {
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs().max_element() < 1e-6, "{found} {expected}");
        }
    };
    let alpha = 127.0 / 255.0;
    near(of(json!({ "alphaMode": "BLEND" })), [Rgb::X, BACKGROUND, Rgb::Z, half(Rgb::ONE, alpha)]);
    let veiled =
        json!({ "alphaMode": "BLEND", "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.5, 0.5, 0.5] } });
    near(
        of(veiled),
        [half(Rgb::X * 0.5, 0.5), BACKGROUND, half(Rgb::Z * 0.5, 0.5), half(Rgb::splat(0.5), 0.5 * alpha)],
    );
}

#[test]
fn vertex_colours_multiply_the_base_colour() {
    let mut file = GltfFixture::default();
    let white = [1.0f32; 12];
    let mut colors = white;
    colors[..3].copy_from_slice(&[0.5, 1.0, 0.0]);
    colors[3..6].copy_from_slice(&[0.5, 1.0, 0.0]);
    colors[6..9].copy_from_slice(&[0.5, 1.0, 0.0]);
    colors[9..].copy_from_slice(&[0.5, 1.0, 0.0]);
    let accessor = file.floats("VEC3", 3, &colors);
    let rest =
        square(json!({ "pbrMetallicRoughness": { "baseColorFactor": [1, 0.25, 1, 1] } }), PLAIN, &[]).json;
    file.set(json!({ "nodes": rest["nodes"], "materials": rest["materials"] }));
    extend(&mut file, PLAIN, &[("COLOR_0", accessor)]);
    assert_eq!(shown(file), [Rgb::new(0.5, 0.25, 0.0); 4]);
}

#[test]
fn buffers_and_images_may_be_files_within_the_root() {
    let folder = folder();
    fs::create_dir_all(folder.path().join("models/my images")).expect("a disk");
    let mut file = square(json!({}), PLAIN, &[]);
    fs::write(folder.path().join("models/data.bin"), &file.data).expect("a disk");
    fs::write(folder.path().join("models/my images/a.png"), png([RED, GREEN, BLUE, GREY])).expect("a disk");
    file.json["materials"][0]["pbrMetallicRoughness"] = json!({ "baseColorTexture": { "index": 0 } });
    file.set(json!({
        "buffers": [{ "uri": "data.bin", "byteLength": file.data.len() }],
        "images": [{ "uri": "my%20images/a.png" }],
        "samplers": [{ "magFilter": 9728 }],
        "textures": [{ "source": 0, "sampler": 0 }],
    }));
    fs::write(folder.path().join("models/robot.gltf"), file.json.to_string()).expect("a disk");
    let text = "(output: (size: (2, 2)), quality: (antialias: 1), camera: (position: (0, 0, 5), projection:
        Orthographic(height: 2)), objects: { \"robot\": (shape: Scene(\"models/robot.gltf\")) })";
    fs::write(folder.path().join("scene.ron"), text).expect("a disk");
    let sequence = load(&folder.path().join("scene.ron")).unwrap_or_else(|error| panic!("{error}"));
    let shot = shoot(&sequence, 0..1).remove(0);
    assert_eq!([shot.pixel(0, 0), shot.pixel(1, 1)], [Rgb::X, Rgb::ONE]);
    // Another folder is the root now.
    fs::create_dir_all(folder.path().join("models/assets")).expect("a disk");
    file.json["images"][0]["uri"] = json!("../secret.png");
    fs::write(folder.path().join("secret.png"), png([RED; 4])).expect("a disk");
    fs::write(folder.path().join("models/robot.gltf"), file.json.to_string()).expect("a disk");
    let text = text.replace("models/", "");
    fs::write(folder.path().join("models/scene.ron"), text).expect("a disk");
    let message = refused(folder.path(), &["check", "models/scene.ron"]);
    assert!(message.contains("images[0]: cannot read \"../secret.png\": it is outside of"), "{message}");
}

#[test]
fn check_names_what_is_left_out() {
    let folder = folder();
    let mut file = square(json!({}), PLAIN, &[]);
    file.json["materials"][0]["extensions"] = json!({ "KHR_materials_sheen": {} });
    fs::write(folder.path().join("robot.glb"), file.glb()).expect("a disk");
    let text = "(objects: {\n    \"robot\": (shape: Scene(\"robot.glb\")),\n})";
    fs::write(folder.path().join("scene.ron"), text).expect("a disk");
    let printed = kinora(folder.path(), &["check", "scene.ron"]);
    let note = "note: scene.ron:2: left out of the scene: KHR_materials_sheen of 1 material";
    assert!(printed.contains(note), "{printed}");
    assert!(printed.contains("2 objects with 2 triangles"), "{printed}");
}

/// A square of `diffuse: 1` that faces a light of the file.
fn lit(light: Value, distance: f64) -> Rgb {
    let folder = folder();
    let mut file = square(json!({}), PLAIN, &[]);
    file.set(json!({ "extensions": { "KHR_lights_punctual": { "lights": [light] } } }));
    let lamp =
        json!({ "translation": [0, 0, distance], "extensions": { "KHR_lights_punctual": { "light": 0 } } });
    file.push("nodes", lamp);
    fs::write(folder.path().join("robot.glb"), file.glb()).expect("a disk");
    let text = "(output: (size: (1, 1)), quality: (antialias: 1), camera: (position: (0, 0, 5), projection:
        Orthographic(height: 0.01)), objects: { \"robot\": (shape: Scene(\"robot.glb\"),
        material: (color: 1, diffuse: 1, ambient: 0)) })";
    fs::write(folder.path().join("scene.ron"), text).expect("a disk");
    let sequence = load(&folder.path().join("scene.ron")).unwrap_or_else(|error| panic!("{error}"));
    shoot(&sequence, 0..1)[0].pixel(0, 0)
}

/// A white surface shows its irradiance in watts per square metre, divided by π.
#[test]
fn lights_have_the_stated_units() {
    let near = |found: Rgb, expected: Rgb| assert!((found - expected).abs().max_element() < 1e-6, "{found}");
    let flux = 683.0 * std::f64::consts::PI;
    near(
        lit(json!({ "type": "directional", "intensity": flux, "color": [1, 0.5, 0] }), 1.0),
        Rgb::new(1.0, 0.5, 0.0),
    );
    near(lit(json!({ "type": "point", "intensity": flux }), 2.0), Rgb::splat(0.25));
    near(lit(json!({ "type": "point", "intensity": 0.01 * flux }), 0.2), Rgb::splat(0.25));
    near(lit(json!({ "type": "spot", "intensity": flux }), 0.5), Rgb::splat(4.0));
}

/// The upper left pixel of the frames of a file whose animation has keys at every second.
fn frames(file: GltfFixture) -> Vec<Rgb> {
    let folder = folder();
    fs::write(folder.path().join("robot.glb"), file.glb()).expect("a disk");
    let text = "(timeline: (frames: 3, fps: 1), output: (size: (2, 2)), quality: (antialias: 1),
        background: (0.125, 0.25, 0.5), camera: (position: (0, 0, 5), projection: Orthographic(height: 2)),
        objects: { \"robot\": (shape: Scene(\"robot.glb\")) })";
    fs::write(folder.path().join("scene.ron"), text).expect("a disk");
    let sequence: Sequence = load(&folder.path().join("scene.ron")).unwrap_or_else(|error| panic!("{error}"));
    shoot(&sequence, 0..3).iter().map(|shot| shot.pixel(0, 0)).collect()
}

/// Adds an animation of one channel that steps at every second.
fn step(file: &mut GltfFixture, path: &str, node: usize, (kind, width): (&str, usize), values: &[f32]) {
    let times: Vec<f32> = (0u16..).map(f32::from).take(values.len() / width).collect();
    let (input, output) = (file.floats("SCALAR", 1, &times), file.floats(kind, width, values));
    file.set(
        json!({ "animations": [{ "samplers": [{ "input": input, "output": output, "interpolation": "STEP" }],
        "channels": [{ "sampler": 0, "target": { "node": node, "path": path } }] }] }),
    );
}

#[test]
fn meshes_without_an_area_are_hidden_for_that_moment() {
    let white = Rgb::ONE;
    // A joint of scale 0 in the second frame.
    let mut file = GltfFixture::default();
    let joints = file.accessor(&[0; 16], 5121, "VEC4", 4);
    let weights = file.floats("VEC4", 4, &[1.0, 0.0, 0.0, 0.0].repeat(4));
    let rest = square(json!({}), PLAIN, &[]).json;
    file.set(json!({ "materials": rest["materials"], "skins": [{ "joints": [1] }],
        "nodes": [{ "name": "square", "mesh": 0, "skin": 0 }, { "name": "joint" }] }));
    extend(&mut file, PLAIN, &[("JOINTS_0", joints), ("WEIGHTS_0", weights)]);
    step(&mut file, "scale", 1, ("VEC3", 3), &[1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    assert_eq!(frames(file), [white, BACKGROUND, white]);
    // A morph target that leaves nothing, in the first and the last frame.
    let mut file = square(json!({}), PLAIN, &[]);
    let inward: Vec<f32> = [1.0f32, 1.0, 0.0, -1.0, 1.0, 0.0, 1.0, -1.0, 0.0, -1.0, -1.0, 0.0].into();
    let target = file.floats("VEC3", 3, &inward);
    file.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": target }]);
    step(&mut file, "weights", 0, ("SCALAR", 1), &[1.0, 0.0, 1.0]);
    assert_eq!(frames(file), [BACKGROUND, white, BACKGROUND]);
}

/// Weights without keys move vertices once, also those of instances of the node.
#[test]
fn instances_show_meshes_as_they_are_deformed() {
    let folder = folder();
    let mut file = square(json!({}), PLAIN, &[]);
    let up = file.floats("VEC3", 3, &[0.0, 1.0, 0.0].repeat(4));
    file.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": up }]);
    file.json["meshes"][0]["weights"] = json!([0.5]);
    fs::write(folder.path().join("square.glb"), file.glb()).expect("a disk");
    fs::write(folder.path().join("at.csv"), "x,y,z\n0,0,0\n").expect("a disk");
    let picture = |objects: &str| {
        let text =
            format!("(output: (size: (8, 8)), camera: (position: (0, 0, 5)), objects: {{ {objects} }})");
        shoot(&sequence_in(folder.path(), &text), 0..1).remove(0).film.data
    };
    let scene = picture("\"a\": (shape: Scene(\"square.glb\"))");
    let shown = "\"a\": (shape: Scene(\"square.glb\"), visible: false),
        \"b\": (shape: Instances(of: \"a\", file: \"at.csv\"))";
    assert!(picture(shown) == scene);
    assert!(picture("\"a\": (shape: Scene(\"square.glb\"), translation: (0, -0.5, 0))") != scene);
}

/// A mesh out of range ends the run with the name of its object.
#[test]
fn deformed_meshes_out_of_range_are_named() {
    let folder = folder();
    let mut file = square(json!({}), PLAIN, &[]);
    let target = file.floats("VEC3", 3, &[1e20; 12]);
    file.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": target }]);
    step(&mut file, "weights", 0, ("SCALAR", 1), &[0.0, 1e20]);
    fs::write(folder.path().join("robot.glb"), file.glb()).expect("a disk");
    let text = "(timeline: (frames: 2, fps: 1), output: (size: (2, 2)), objects: { \"robot\": (shape: Scene(\"robot.glb\")) })";
    fs::write(folder.path().join("scene.ron"), text).expect("a disk");
    let done = run(folder.path(), &["render", "scene.ron", "-o", "out_#.png"]);
    let message = stderr(&done);
    assert_ne!(done.status.code(), Some(0), "{message}");
    assert!(message.contains("the object \"robot/square\"") && message.contains("at most 1e30"), "{message}");
}
