//! Meshes in the materials and colours that came with them.

use crate::support::{radiance_at_target, shoot};
use kinora::appearance::material::MaterialBinding;
use kinora::base::color::Rgb;
use kinora::sequence::{Sequence, load};
use std::fs;
use std::path::Path;

/// Four squares around the origin, each in a material of its own but for the last, which has none.
const OBJ: &str = "mtllib four.mtl
v -1 -1 0\nv 0 -1 0\nv 1 -1 0\nv -1 0 0\nv 0 0 0\nv 1 0 0\nv -1 1 0\nv 0 1 0\nv 1 1 0
vt 0.25 0.5\nvt 0.75 0.5
f 4 5 8 7
usemtl dim\nf 5 6 9 8
usemtl picture\nf 1/1 2/1 5/1 4/1
usemtl lamp\nf 2 3 6 5
";

const MTL: &str = "newmtl lamp\nKd 0 0 0\nKa 0 0 0\nKe 0 2 4
newmtl dim\nKa 0.25 0.5 0.125
newmtl picture\nKa 0.75 0.75 0.75\nKd 0.5 0.5 0.5\nmap_Kd images/left.png
";

/// The mesh in four pixels, under nothing but ambient light of radiance 0.5.
fn sequence(folder: &Path, object: &str) -> Result<Sequence, String> {
    fs::create_dir_all(folder.join("models/images")).expect("the folder is writable");
    fs::write(folder.join("models/four.obj"), OBJ).expect("a disk");
    fs::write(folder.join("models/four.mtl"), MTL).expect("a disk");
    let text = format!(
        "(output: (size: (2, 2)), quality: (antialias: 1), ambient: 0.5,
        camera: (position: (0, 0, 5), projection: Orthographic(height: 2)),
        default_material: (ambient: 1, color: 0.75),
        objects: {{ \"four\": (shape: Mesh(\"models/four.obj\"){object}) }})"
    );
    let path = folder.join("scene.ron");
    fs::write(&path, text).expect("a disk");
    load(&path).map_err(|error| error.to_string())
}

fn write_image(folder: &Path) {
    let texels = [[0, 255, 0], [255, 0, 0]].map(image::Rgb::<u8>).to_vec();
    let image = image::RgbImage::from_fn(2, 1, |x, _| texels[x as usize]);
    image.save(folder.join("models/images/left.png")).expect("a disk");
}

#[test]
fn triangles_have_the_materials_of_their_file() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    fs::create_dir_all(folder.path().join("models/images")).expect("the folder is writable");
    write_image(folder.path());
    let sequence = sequence(folder.path(), "").unwrap_or_else(|error| panic!("{error}"));
    for scene in [sequence.clone(), path_traced(sequence)] {
        let shot = shoot(&scene, 0..1).remove(0);
        let pixels = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| shot.pixel(x, y).to_array());
        let bare = [0.375; 3];
        assert_eq!(pixels, [bare, [0.125, 0.25, 0.0625], [0.0, 0.375, 0.0], [0.0, 2.0, 4.0]]);
    }
}

fn path_traced(mut sequence: Sequence) -> Sequence {
    sequence.quality.integrator = kinora::sequence::quality::Integrator::Path(Default::default());
    sequence.quality.samples = 1;
    sequence
}

#[test]
fn a_material_of_the_object_goes_before() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let sequence = sequence(folder.path(), ", material: (color: 0.25)").expect("its images are not needed");
    let shot = shoot(&sequence, 0..1).remove(0);
    for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        assert_eq!(shot.pixel(x, y), Rgb::splat(0.125));
    }
}

/// Exporters that know no ambient light write `Ka 1 1 1`, or `Kd` once more: neither says anything about it.
#[test]
fn ambient_colours_of_exporters_say_nothing() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let mesh = "mtllib a.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nusemtl a\nf 1 2 3 4\n";
    fs::write(folder.path().join("a.obj"), mesh).expect("a disk");
    let seen = |library: &str, rest: &str| {
        fs::write(folder.path().join("a.mtl"), format!("newmtl a\n{library}\n")).expect("a disk");
        let text = format!(
            "(output: (size: (1, 1)), camera: (position: (0, 0, 5), projection: Orthographic(height: 1)), {rest} objects: {{ \"a\": (shape: Mesh(\"a.obj\")) }})"
        );
        fs::write(folder.path().join("scene.ron"), text).expect("a disk");
        let sequence = load(&folder.path().join("scene.ron")).unwrap_or_else(|error| panic!("{error}"));
        (shoot(&sequence, 0..1)[0].pixel(0, 0), sequence.notes())
    };
    let kd = "Kd 0.5 0.25 1";
    let share = |strength: f32| Rgb::new(0.5, 0.25, 1.0) * strength;
    let left_out = "the mesh of `a`: `Ka` is ignored where it is white or equals `Kd`, as exporters write it by default; \
                    the `ambient` of `default_material` is used instead";
    assert_eq!(seen(kd, ""), (share(0.1), vec![]));
    for ka in ["Ka 1.000000 1.000000 1.000000", "Ka 1", "Ka 0.5 0.25 1"] {
        for library in [format!("{ka}\n{kd}"), format!("{kd}\n{ka}")] {
            let (pixel, notes) = seen(&library, "");
            assert_eq!(pixel, share(0.1), "{library}");
            assert_eq!(notes, [left_out], "{library}");
            let own = seen(&library, "default_material: (ambient: 0.5),").0;
            assert_eq!(own, share(0.5), "{library}");
        }
    }
    // Others mean it.
    assert_eq!(seen(&format!("{kd}\nKa 0.2 0.2 0.2"), ""), (Rgb::splat(0.2), vec![]));
    assert_eq!(seen(&format!("{kd}\nKa 0 0 0"), ""), (Rgb::ZERO, vec![]));
    assert_eq!(seen("Ka 0.5 0.5 0.5", ""), (Rgb::splat(0.5), vec![]), "with no `Kd`");
    assert_eq!(seen("Kd 0 0 0\nKa 0 0 0", ""), (Rgb::ZERO, vec![]));
}

/// What is clear in `map_Kd` is not there of the mesh.
#[test]
fn clear_parts_of_images_are_cut_out_of_meshes() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let mesh = "mtllib a.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
                usemtl a\nf 1/1 2/2 3/3 4/4\n";
    fs::write(folder.path().join("a.obj"), mesh).expect("a disk");
    fs::write(folder.path().join("a.mtl"), "newmtl a\nKa 0.5 0.5 0.5\nmap_Kd leaf.png\nmap_d leaf.png\n")
        .expect("a disk");
    let leaf =
        image::RgbaImage::from_fn(2, 1, |x, _| image::Rgba([255, 255, 255, if x == 0 { 255 } else { 0 }]));
    leaf.save(folder.path().join("leaf.png")).expect("a disk");
    let text = "(output: (size: (2, 1)), quality: (antialias: 1), background: 0.25,
        camera: (position: (0, 0, 5), projection: Orthographic(height: 1)),
        objects: { \"a\": (shape: Mesh(\"a.obj\")) })";
    fs::write(folder.path().join("scene.ron"), text).expect("a disk");
    let sequence = load(&folder.path().join("scene.ron")).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(sequence.notes(), [""; 0]);
    let shot = shoot(&sequence, 0..1).remove(0);
    assert_eq!([0, 1].map(|x| shot.pixel(x, 0)), [0.5, 0.25].map(Rgb::splat));
}

/// A square before a background of 0.25, seen in as many pixels under ambient light of 1, in the material of a library.
fn square(folder: &Path, library: &str, size: &str) -> Result<Sequence, String> {
    let mesh = "mtllib a.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
                usemtl a\nf 1/1 2/2 3/3 4/4\n";
    let text = format!(
        "(output: (size: {size}), quality: (antialias: 1), background: 0.25,
        camera: (position: (0, 0, 5), projection: Orthographic(height: 1)),
        lights: {{ \"sun\": Directional(direction: (0, 0, -1)) }},
        objects: {{ \"a\": (shape: Mesh(\"a.obj\")) }})"
    );
    for (name, text) in [("a.obj", mesh), ("a.mtl", library), ("scene.ron", &text)] {
        fs::write(folder.join(name), text).expect("a disk");
    }
    load(&folder.join("scene.ron")).map_err(|error| error.to_string())
}

/// An image of two pixels.
fn pair(folder: &Path, name: &str, pixels: [[u8; 3]; 2]) {
    let image = image::RgbImage::from_fn(2, 1, |x, _| image::Rgb(pixels[x as usize]));
    image.save(folder.join(name)).expect("a disk");
}

#[test]
fn images_multiply_what_they_are_for() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let folder = folder.path();
    pair(folder, "left.png", [[255; 3], [0; 3]]);
    pair(folder, "up.png", [[128, 128, 255], [218, 128, 218]]);
    let seen = |library: &str| {
        let sequence = square(folder, &format!("newmtl a\nKa 0 0 0\n{library}"), "(2, 1)");
        let sequence = sequence.unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(sequence.notes(), [""; 0], "{library}");
        let shot = shoot(&sequence, 0..1).remove(0);
        [0, 1].map(|x| shot.pixel(x, 0).x)
    };
    // Light falls from the eye.
    assert_eq!(seen("Kd 0.5 0.5 0.5"), [0.5, 0.5]);
    assert_eq!(
        seen("Kd 0.5 0.5 0.5\nmap_d left.png"),
        [0.5, 0.25],
        "the background is seen where it is cut out"
    );
    assert_eq!(seen("Kd 0.5 0.5 0.5\nmap_Kd left.png\nmap_d -imfchan r left.png"), [0.5, 0.25]);
    assert_eq!(seen("Kd 0 0 0\nKe 3 3 3\nmap_Ke left.png"), [3.0, 0.0]);
    assert_eq!(seen("Kd 0 0 0\nKs 0.75 0.75 0.75\nillum 2\nmap_Ks left.png"), [0.75, 0.0]);
    // The right half is turned to the side, by a map of normals under either name.
    for name in ["norm", "map_Bump", "bump"] {
        let [left, right] = seen(&format!("Kd 0.5 0.5 0.5\n{name} up.png"));
        assert!((left - 0.5).abs() < 0.01 && right < 0.4, "{name} {left} {right}");
    }
    // Heights that fall from white to black.
    let ramp = image::GrayImage::from_fn(16, 1, |x, _| image::Luma([255 - 16 * x as u8]));
    ramp.save(folder.join("ramp.png")).expect("a disk");
    let sequence = square(folder, "newmtl a\nKa 0 0 0\nKd 0.5 0.5 0.5\nbump -bm 100 ramp.png", "(8, 4)");
    let shot = shoot(&sequence.expect("a sequence"), 0..1).remove(0);
    // 16/255 of 0.01 · 100 times the diagonal, √8, over 1/8 of the width.
    let slope = 16.0 / 255.0 * 8f32.sqrt() * 8.0;
    let expected = 0.5 / (1.0 + slope * slope).sqrt();
    assert!((shot.pixel(3, 1).x - expected).abs() < 1e-4, "{} {expected}", shot.pixel(3, 1).x);
    // Metal reflects no light of the sun diffusely; rough plastic does.
    pair(folder, "metal.png", [[0; 3], [0, 255, 0]]);
    let [plastic, metal] = seen("Kd 0.5 0.5 0.5\nPr 1\nmap_Pm -imfchan g metal.png");
    assert!(plastic > metal, "{plastic} {metal}");
}

#[test]
fn images_that_cannot_be_read_are_left_out_but_those_of_colours() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let sequence =
        square(folder.path(), "newmtl a\nKd 1 1 1\nmap_Bump none.png\nPr 0.5", "(2, 1)").expect("a sequence");
    let notes = sequence.notes().join("\n");
    let note = "left out of the mesh: the image \"none.png\": there is no such file";
    assert!(notes.contains(note), "{notes}");
    let printed = square(folder.path(), "newmtl a\nmap_Kd none.png", "(2, 1)").expect_err("no image");
    assert!(printed.contains("cannot read the image \"none.png\" of the mesh"), "{printed}");
}

#[test]
fn missing_images_are_reported() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let printed = sequence(folder.path(), "").expect_err("no image");
    assert!(printed.contains("cannot read the image \"left.png\" of the mesh"), "{printed}");
    assert!(printed.contains("scene.ron:4:41") && printed.contains("there is no such file"), "{printed}");
    assert!(printed.contains("^^^^^^^^^^^^^^^^^ there"), "all of the file's name is marked: {printed}");
}

#[test]
fn missing_libraries_are_faults_only_if_used() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nmtllib none.mtl\nusemtl any\nf 1 2 3\n";
    fs::write(folder.path().join("a.obj"), text).expect("a disk");
    let with = |fields: &str| {
        let path = folder.path().join("scene.ron");
        fs::write(&path, format!("(objects: {{ \"a\": (shape: Mesh(\"a.obj\"){fields}) }})"))
            .expect("a disk");
        load(&path).map_err(|error| error.to_string())
    };
    let printed = with("").expect_err("no library");
    assert!(printed.contains("cannot read the materials of the mesh"), "{printed}");
    assert!(printed.contains("^^^^^^^ line 4: there is no file `none.mtl` for the materials"), "{printed}");
    let notes = with(", material: (color: 1)").map(|sequence| sequence.notes());
    let note = "the mesh of `a`: line 4: there is no file `none.mtl` for the materials, and none is needed";
    assert_eq!(notes, Ok(vec![note.to_owned()]));
}

#[test]
fn ignored_material_parts_are_noted_once() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    fs::create_dir_all(folder.path().join("models/images")).expect("the folder is writable");
    write_image(folder.path());
    let printed = |object: &str| {
        sequence(folder.path(), object).expect("a sequence");
        let more = "\ndisp b.png\nTf 1 0 0\nnewmtl unused\nmap_d d.png";
        let path = folder.path().join("models/four.mtl");
        fs::write(path, MTL.to_owned() + more).expect("a disk");
        load(&folder.path().join("scene.ron")).expect("a sequence").notes()
    };
    let again = "), \"again\": (shape: Mesh(\"models/four.obj\")";
    assert_eq!(printed(again), ["the mesh of `four`: `disp` and `Tf` of its materials left out"]);
    let covered = format!(", material: (color: 1){again}");
    assert_eq!(printed(&covered), ["the mesh of `again`: `disp` and `Tf` of its materials left out"]);
    assert_eq!(printed(", material: (color: 1)"), [""; 0]);
}

#[test]
fn images_are_repeated_moved_and_clamped_as_their_options_say() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let mesh = "mtllib a.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
                usemtl a\nf 1/1 2/2 3/3 4/4\n";
    fs::create_dir_all(folder.path().join("models/images")).expect("the folder is writable");
    write_image(folder.path());
    fs::write(folder.path().join("models/a.obj"), mesh).expect("a disk");
    let text = "(output: (size: (4, 1)), quality: (antialias: 1), ambient: 1,
        camera: (position: (0, 0, 5), projection: Orthographic(height: 0.5)),
        objects: { \"a\": (shape: Mesh(\"models/a.obj\")) })";
    fs::write(folder.path().join("scene.ron"), text).expect("a disk");
    let seen = |options: &str| {
        let library = format!("newmtl a\nKa 1 1 1\nKd 1 1 1\nmap_Kd {options} images/left.png\n");
        fs::write(folder.path().join("models/a.mtl"), library).expect("a disk");
        let sequence = load(&folder.path().join("scene.ron")).unwrap_or_else(|error| panic!("{error}"));
        let shot = shoot(&sequence, 0..1).remove(0);
        [0, 1, 2, 3].map(|x| {
            let pixel = shot.pixel(x, 0);
            if pixel.x > pixel.y { 'r' } else { 'g' }
        })
    };
    // The pixels are at u = 1/8, 3/8, 5/8 and 7/8; the image is green, then red.
    assert_eq!(seen(""), ['g', 'g', 'r', 'r']);
    assert_eq!(seen("-s 2 1 1"), ['g', 'r', 'g', 'r']);
    assert_eq!(seen("-s 2 1 1 -o 0.5 0 0"), ['r', 'g', 'r', 'g']);
    assert_eq!(seen("-o 0.25 0 0"), ['g', 'r', 'r', 'g']);
    assert_eq!(seen("-o 0.25 0 0 -clamp on"), ['g', 'r', 'r', 'r']);
}

#[test]
fn meshes_without_materials_show_the_colours_of_their_vertices() {
    let mesh = "shape: Mesh(vertices: [(-1, -1, 0), (1, -1, 0), (0, 1, 0)], triangles: [(0, 1, 2)],
                colors: [(1, 0.5, 0), (1, 0.5, 0), (1, 0.5, 0)])";
    let seen = |material: &str| {
        radiance_at_target(&format!(
            "default_material: (ambient: 1, color: 0.5), objects: {{ \"m\": ({mesh}{material}) }}"
        ))
    };
    assert_eq!(seen(""), Rgb::new(1.0, 0.5, 0.0));
    assert_eq!(seen(", material: (color: 0.25)"), Rgb::splat(0.25));
}

#[test]
fn objects_with_the_same_mesh_share_its_materials() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    fs::create_dir_all(folder.path().join("models/images")).expect("the folder is writable");
    write_image(folder.path());
    let again = ") , \"again\": (shape: Mesh(file: \"./models/four.obj\", normals: Smooth)";
    let other = "), \"other\": (shape: Mesh(\"models/other.obj\")";
    fs::write(folder.path().join("models/other.obj"), OBJ).expect("a disk");
    let sequence =
        sequence(folder.path(), &format!("{again}{other}")).unwrap_or_else(|error| panic!("{error}"));
    let of = |index: usize| sequence.objects[index].value.made_of;
    assert_eq!(of(0), MaterialBinding::Slots { first: 0, count: 3 });
    assert_eq!(of(1), of(0), "of the same file");
    assert_eq!(of(2), MaterialBinding::Slots { first: 4, count: 3 });
    assert_eq!(sequence.materials.len(), 8);
}

/// Front and back of a slab of one glass that has two names: what enters by one leaves by the other.
#[test]
fn glass_is_left_by_whichever_material() {
    const SLAB: &str = "mtllib slab.mtl
v -9 -9 1\nv 9 -9 1\nv 9 9 1\nv -9 9 1\nv -9 -9 -1\nv 9 -9 -1\nv 9 9 -1\nv -9 9 -1
usemtl front\nf 1 2 3 4
usemtl back\nf 6 5 8 7
";
    const GLASS: &str = "Kd 0 0 0\nKa 0 0 0\nNi 1.5\nd 0\nillum 6\n";
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    fs::write(folder.path().join("slab.obj"), SLAB).expect("a disk");
    let both = format!("newmtl front\n{GLASS}newmtl back\n{GLASS}");
    fs::write(folder.path().join("slab.mtl"), both).expect("a disk");
    // A slab shifts rays, but turns none: the sky behind it is the same.
    let seen = |objects: &str| {
        let text = format!(
            "(output: (size: (1, 1)), quality: (antialias: 1), background: Gradient(),
            camera: (position: (0, 3, 5)), objects: {{ {objects} }})"
        );
        let path = folder.path().join("scene.ron");
        fs::write(&path, text).expect("a disk");
        let whitted = load(&path).unwrap_or_else(|error| panic!("{error}"));
        [whitted.clone(), path_traced(whitted)].map(|scene| shoot(&scene, 0..1).remove(0).pixel(0, 0))
    };
    let (without, with) = (seen(""), seen("\"slab\": (shape: Mesh(\"slab.obj\"))"));
    for (a, b) in without.into_iter().zip(with) {
        assert!((a - b).abs().max_element() <= 1e-6, "{b} instead of {a}");
    }
}
