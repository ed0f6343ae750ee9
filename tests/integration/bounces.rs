//! What `bounces` means is the same for every source of light: light of 0 bounces comes straight from its source to
//! the surface that is seen.

use crate::support::{shoot_all, shoot_all_in};
use kinora::base::color::Rgb;
use std::fs;
use std::path::Path;

const COUNTS: [u32; 4] = [0, 1, 2, 5];

/// The mean of `samples` paths of so many bounces to a small patch around the target.
fn patch(folder: &Path, samples: u32, bounces: u32, camera: &str, rest: &str) -> f64 {
    let text = format!(
        "(output: (size: (1, 1)), ambient: 0,
        quality: (integrator: Path(roulette: Off), samples: {samples}, bounces: {bounces}),
        camera: ({camera}, projection: Orthographic(height: 1e-6)), {rest})"
    );
    f64::from(shoot_all_in(folder, &text)[0].pixel(0, 0).element_sum()) / 3.0
}

/// One pixel that looks from (0, 2, 5) at the origin.
fn seen(integrator: &str, bounces: u32, rest: &str) -> Rgb {
    let text = format!(
        "(output: (size: (1, 1)), ambient: 0, quality: (integrator: {integrator}, samples: 256, bounces: {bounces}),
        camera: (position: (0, 2, 5), projection: Orthographic(height: 1e-9)), {rest})"
    );
    shoot_all(&text)[0].pixel(0, 0)
}

#[track_caller]
fn near(found: f64, expected: f64, within: f64, what: &str) {
    assert!((found - expected).abs() <= within, "{what}: {found} is not {expected} within {within}");
}

/// A square above a corner of two surfaces, as a lamp and as objects that are asked for light or only found.
#[test]
fn lamps_and_emitting_objects_are_alike() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let mesh = "mtllib a.mtl\nv -1 1.5 -1\nv 1 1.5 -1\nv 1 1.5 1\nv -1 1.5 1\nusemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\n";
    fs::write(folder.path().join("a.obj"), mesh).expect("a disk");
    let library = "newmtl a\nKd 0 0 0\nKe 1 1 1\nnewmtl b\nKd 0 0 0\nKe 1 1 1\n";
    fs::write(folder.path().join("a.mtl"), library).expect("a disk");
    const SQUARE: &str = "Rectangle(corner: (-1, 1.5, -1), u: (2, 0, 0), v: (0, 0, 2)";
    const SHINES: &str = "material: (color: 1, diffuse: 0, emission: 1)";
    const TRIANGLES: &str = "Mesh(vertices: [(-1, 1.5, -1), (1, 1.5, -1), (1, 1.5, 1), (-1, 1.5, 1)],
        triangles: [(0, 1, 2), (0, 2, 3)])";
    let sources = [
        (format!("lights: {{ \"l\": {SQUARE}) }}"), String::new()),
        (String::new(), format!("\"l\": (shape: {SQUARE}), {SHINES}),")),
        (String::new(), format!("\"l\": (shape: {TRIANGLES}, {SHINES}),")),
        (String::new(), "\"l\": (shape: Mesh(\"a.obj\")),".to_owned()),
    ];
    let mut before = 0.0;
    for bounces in COUNTS {
        let lit = |(lights, object): &(String, String)| {
            let rest = format!(
                "{lights}, objects: {{ {object}
                \"floor\": (shape: Rectangle(corner: (-2, 0, -2), u: (4, 0, 0), v: (0, 0, 4)), material: Lambertian(color: 0.8)),
                \"wall\": (shape: Rectangle(corner: (-2, 0, -1.2), u: (4, 0, 0), v: (0, 1.2, 0)), material: Lambertian(color: 0.8)) }}"
            );
            let rest = rest.trim_start_matches([',', ' ']);
            patch(folder.path(), 1 << 16, bounces, "position: (3, 1, 0)", rest)
        };
        let lamp = lit(&sources[0]);
        assert!(lamp > before, "{bounces} bounces: {lamp} after {before}");
        for source in &sources[1..] {
            near(lit(source), lamp, 0.01 * lamp, &format!("{bounces} bounces, {}", source.1));
        }
        before = lamp;
    }
}

/// Light from everywhere, whatever it comes from.
#[test]
fn skies_and_emitting_domes_are_alike() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let white = image::RgbImage::from_pixel(8, 4, image::Rgb([255; 3]));
    white.save(folder.path().join("sky.png")).expect("a disk");
    let dome = "\"dome\": (shape: Sphere(radius: 100), material: (color: 1, diffuse: 0, emission: 1)),";
    let sources = [
        ("background: 1,", ""),
        ("background: Gradient(bottom: 1, top: 1),", ""),
        ("background: Equirect(file: \"sky.png\"),", ""),
        ("", dome),
    ];
    for bounces in COUNTS {
        let lit = |(sky, object): (&str, &str)| {
            let rest = format!(
                "{sky} objects: {{ {object}
                \"floor\": (shape: Disk(radius: 20), material: Lambertian(color: 0.8)),
                \"ball\": (shape: Sphere(center: (0, 1, -1)), material: Lambertian(color: 0.8)) }}"
            );
            patch(folder.path(), 1 << 14, bounces, "position: (3, 1, 0)", &rest)
        };
        let plain = lit(sources[0]);
        assert!(plain > 0.3, "{bounces} bounces: {plain}");
        for source in &sources[1..] {
            near(lit(*source), plain, 0.01 * plain, &format!("{bounces} bounces, {source:?}"));
        }
    }
}

/// Inside a closed sphere that gives off 0.2 and reflects 0.8, light of n bounces has been scattered n + 1 times:
/// 0.2 (1 + 0.8 + ... + 0.8^(n + 1)) = 1 - 0.8^(n + 2).
#[test]
fn sa_03_furnaces_with_few_bounces() {
    for bounces in [0, 1, 2, 5, 10] {
        let hull = "objects: { \"hull\": (shape: Sphere(), material: (diffuse: 0.8, ambient: 0, emission: 0.2, color: 1)) }";
        let found =
            patch(Path::new(""), 1 << 14, bounces, "position: (0.3, 0.1, 0), target: (0, 0, -1)", hull);
        let expected = 1.0 - (0..bounces + 2).fold(1.0, |left, _| left * 0.8);
        near(found, expected, 2e-3, &format!("{bounces} bounces"));
    }
}

#[test]
fn skies_light_surfaces_without_a_bounce() {
    let floor = |sheet: &str| {
        let rest = format!(
            "background: 1, objects: {{ \"floor\": (shape: Plane(), material: Lambertian(color: 0.5)), {sheet} }}"
        );
        f64::from(seen("Path", 0, &rest).x)
    };
    near(floor(""), 0.5, 1e-6, "a floor");
    let sheet = "\"sheet\": (shape: Disk(center: (0, 0.5, 0), radius: 1000),
        material: (ambient: 0, diffuse: 0, transparency: 0.5))";
    // From above as well.
    near(floor(sheet), 0.5 * 0.5 * 0.5, 1e-6, "a floor below a sheet that lets half of the light pass");
}

/// A mirror shows a source without a bounce, and what the source shines on with one.
#[test]
fn mirrors_show_sources_without_a_bounce_and_lit_surfaces_with_one() {
    // The mirror at the origin shows what lies towards (0, 2, -5).
    const WALL: &str = "corner: (-4, -1, -5), u: (8, 0, 0), v: (0, 6, 0)";
    const MIRROR: &str = "\"mirror\": (shape: Plane(), material: Metal(color: 0.5))";
    let wall = |material: &str| {
        format!("objects: {{ {MIRROR}, \"wall\": (shape: Rectangle({WALL}), material: {material}) }}")
    };
    let boundary = "\"glass\": (shape: Plane(), material: Dielectric(fresnel: Off))";
    let sources = [
        ("the sky", format!("background: 3, objects: {{ {MIRROR} }}"), 1.5),
        ("the sky below a boundary", format!("background: 3, objects: {{ {boundary} }}"), 3.0),
        ("an object", wall("(color: 1, diffuse: 0, emission: 3)"), 1.5),
        (
            "a lamp",
            format!("lights: {{ \"l\": Rectangle({WALL}, intensity: 3) }}, objects: {{ {MIRROR} }}"),
            1.5,
        ),
    ];
    let lit = "lights: { \"sun\": Directional(direction: (0, 0, -1)) }, ".to_owned()
        + &wall("(color: 1, ambient: 0, diffuse: 1)");
    for integrator in ["Whitted", "Path"] {
        for bounces in [0, 1, 4] {
            for (what, scene, expected) in &sources {
                let shown = seen(integrator, bounces, scene);
                assert_eq!(shown, Rgb::splat(*expected), "{integrator}, {bounces} bounces: {what}");
            }
            let expected = if bounces == 0 { 0.0 } else { 0.5 };
            assert_eq!(
                seen(integrator, bounces, &lit),
                Rgb::splat(expected),
                "{integrator}, {bounces} bounces"
            );
        }
    }
}
