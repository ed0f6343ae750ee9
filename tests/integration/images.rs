//! Images and patterns on surfaces: where they end, what shows through them, and how they look behind what is clear.

use crate::support::{folder, sequence_in, shoot_all_in, shoot_film};
use kinora::base::color::Rgb;
use std::path::Path;

/// Writes an image of linear codes, row by row from the top.
fn write(folder: &Path, name: &str, width: u32, texels: &[[u8; 4]]) {
    let bytes = texels.iter().flatten().copied().collect();
    let image = image::RgbaImage::from_raw(width, texels.len() as u32 / width, bytes).expect("all texels");
    image.save(folder.join(name)).expect("a disk");
}

fn grey(code: u8) -> [u8; 4] {
    [code, code, code, 255]
}

/// What one pixel shows that looks along z at a point (x, y) of what stands at z = 0.
fn seen_at(folder: &Path, integrator: &str, (x, y): (f64, f64), rest: &str) -> Rgb {
    let text = format!(
        "(output: (size: (1, 1)), ambient: 0, quality: (integrator: {integrator}, antialias: 1, samples: 256, bounces: 1),
        camera: (position: ({x:?}, {y:?}, 5), target: ({x:?}, {y:?}, 0), projection: Orthographic(height: 1e-9)), {rest})"
    );
    shoot_all_in(folder, &text)[0].pixel(0, 0)
}

/// A square from (0, 0) to (1, 1) that shines in the colours of an image.
fn square(image: &str) -> String {
    format!(
        "objects: {{ \"s\": (shape: Rectangle(corner: (0, 0, 0), u: (1, 0, 0), v: (0, 1, 0)),
        material: (color: Image({image}), ambient: 0, diffuse: 0, emission: 1)) }}"
    )
}

#[test]
fn images_end_where_their_surface_does() {
    let folder = folder();
    // Lower row: 51, 102; upper row: 153, 204.
    write(folder.path(), "four.png", 2, &[grey(153), grey(204), grey(51), grey(102)]);
    let at = |point: (f64, f64), fields: &str| {
        let image = format!("file: \"four.png\", encoding: Linear{fields}");
        (f64::from(seen_at(folder.path(), "Whitted", point, &square(&image)).x) * 255.0).round()
    };
    let edge = 1.0 / 1024.0;
    let corners = [(edge, edge), (1.0 - edge, edge), (edge, 1.0 - edge), (1.0 - edge, 1.0 - edge)];
    let at_corners = |fields: &str| corners.map(|corner| at(corner, fields));
    assert_eq!(at_corners(""), [51.0, 102.0, 153.0, 204.0]);
    assert_eq!(at_corners(", wrap: Clamp"), [51.0, 102.0, 153.0, 204.0]);
    assert_eq!(
        at_corners(", scale: 0.5"),
        [51.0, 102.0, 153.0, 204.0],
        "seen twice, it ends at the edges alone"
    );
    assert_eq!(at_corners(", scale: (-1, 1), offset: (1, 0)"), [102.0, 51.0, 204.0, 153.0], "mirrored");
    assert_eq!(at_corners(", rotation: 90, offset: (1, 0)"), [153.0, 51.0, 204.0, 102.0], "turned");
    // Who asks for it gets what lies beyond: at the corners all four are mixed, nearly.
    for corner in at_corners(", wrap: Repeat") {
        assert!((corner - 127.5).abs() < 2.0, "{corner}");
    }
    // Between two of them the image goes on.
    let between = |x: f64| at((x, 0.125), ", scale: 0.5");
    assert!((between(0.5) - 76.5).abs() <= 1.0, "{}", between(0.5));
}

#[test]
fn images_do_not_go_over_the_poles() {
    let folder = folder();
    let rows: Vec<_> = [240, 160, 80, 10].into_iter().flat_map(|code| [grey(code); 4]).collect();
    write(folder.path(), "rows.png", 4, &rows);
    let columns: Vec<_> = [240, 160, 80, 0].map(grey).repeat(2);
    write(folder.path(), "columns.png", 4, &columns);
    let seen = |eye: &str, shape: &str, image: &str| {
        let text = format!(
            "(output: (size: (1, 1)), quality: (antialias: 1), camera: (position: {eye}, up: (1, 1, 1), projection: Orthographic(height: 1e-9)),
            objects: {{ \"s\": (shape: {shape}, material: (color: Image(file: \"{image}\", encoding: Linear), ambient: 0, diffuse: 0, emission: 1)) }})"
        );
        f64::from(shoot_all_in(folder.path(), &text)[0].pixel(0, 0).x) * 255.0
    };
    assert!((seen("(1e-4, 5, 0)", "Sphere()", "rows.png") - 240.0).abs() < 0.1);
    assert!((seen("(1e-4, -5, 0)", "Sphere()", "rows.png") - 10.0).abs() < 0.1);
    // Around the sphere it goes on: the seam lies half a radian before -x.
    let seam = format!("({:?}, 0, {:?})", -5.0 * libm::cos(0.5), -5.0 * libm::sin(0.5));
    let (left, right) = (seen(&seam, "Sphere()", "columns.png"), 120.0);
    assert!((left - right).abs() < 1.0, "{left}");
    // A tube ends at its rims, and goes on around: its seam is at -x.
    let tube = "Cylinder(capped: false)";
    assert!((seen("(-5, 0, 0)", tube, "columns.png") - 120.0).abs() < 1.0);
    let rim = |y: f64| {
        let text = format!(
            "(output: (size: (1, 1)), quality: (antialias: 1), camera: (position: (5, {y:?}, 0), target: (0, {y:?}, 0), projection: Orthographic(height: 1e-9)),
            objects: {{ \"s\": (shape: {tube}, material: (color: Image(file: \"rows.png\", encoding: Linear), ambient: 0, diffuse: 0, emission: 1)) }})"
        );
        f64::from(shoot_all_in(folder.path(), &text)[0].pixel(0, 0).x) * 255.0
    };
    assert!((rim(0.999) - 240.0).abs() < 0.1 && (rim(-0.999) - 10.0).abs() < 0.1);
}

/// What stands before a background of 0.25: its share is there, and the rest is not.
#[test]
fn transparent_texels_are_holes() {
    let folder = folder();
    let red = |alpha: u8| [255, 0, 0, alpha];
    write(folder.path(), "logo.png", 3, &[red(255), red(51), [0, 0, 0, 0]]);
    for integrator in ["Whitted", "Path"] {
        let seen = |x: f64, material: &str| {
            let rest = format!(
                "background: 0.25, objects: {{ \"s\": (shape: Rectangle(corner: (0, 0, 0), u: (3, 0, 0), v: (0, 3, 0)), material: {material}) }}"
            );
            seen_at(folder.path(), integrator, (x, 1.5), &rest)
        };
        let near = |found: Rgb, expected: [f64; 3]| {
            let off = found.as_dvec3() - kinora::base::math::DVec3::from_array(expected);
            let within = if integrator == "Path" { 0.02 } else { 1e-6 };
            assert!(off.abs().max_element() <= within, "{integrator}: {found}, not {expected:?}");
        };
        const LOGO: &str = "Image(file: \"logo.png\", encoding: Linear, filter: Nearest)";
        let shines = format!("(color: {LOGO}, ambient: 0, diffuse: 0, emission: 2)");
        near(seen(0.5, &shines), [2.0, 0.0, 0.0]);
        near(seen(1.5, &shines), [0.4 + 0.2, 0.2, 0.2]);
        near(seen(2.5, &shines), [0.25; 3]);
        // What lets light pass does so in its share of what is there.
        let veil = format!("(color: {LOGO}, ambient: 0, diffuse: 0, transparency: 0.5)");
        near(seen(1.5, &veil), [0.25 * (0.8 + 0.2 * 0.5); 3]);
        near(seen(2.5, &format!("Metal(color: {LOGO})")), [0.25; 3]);
        near(seen(2.5, &format!("MetallicRoughness(color: {LOGO})")), [0.25; 3]);
        // Of a part, that part alone: the surface is there, and black.
        let part =
            format!("(color: 0, mirror: 1, mirror_color: {LOGO}, emission: 2, emission_color: {LOGO})");
        near(seen(2.5, &part), [0.0; 3]);
        near(seen(1.5, &part), [0.4 + 0.25 * 0.2, 0.0, 0.0]);
        let inner = "Checker(a: LOGO, b: (0, 1, 0), scale: 3)".replace("LOGO", LOGO);
        near(seen(2.5, &format!("(color: {inner}, ambient: 0, diffuse: 0, emission: 2)")), [0.25; 3]);
        let ignored = LOGO.replace("encoding", "alpha: false, encoding");
        near(seen(1.5, &format!("(color: {ignored}, ambient: 0, diffuse: 0, emission: 2)")), [2.0, 0.0, 0.0]);
    }
}

/// Half way from red to nothing there is half of the red, and nothing of the colour that nothing has in the file.
#[test]
fn soft_edges_have_the_colour_of_opaque_texels() {
    let folder = folder();
    write(folder.path(), "soft.png", 2, &[[255, 0, 0, 255], [0, 255, 0, 0]]);
    let half = seen_at(folder.path(), "Whitted", (0.5, 0.5), &square("file: \"soft.png\", encoding: Linear"));
    assert!((half - Rgb::new(0.5, 0.0, 0.0)).abs().max_element() < 1e-6, "{half}");
}

/// The light of a lamp on a floor below a picture.
#[test]
fn cut_outs_cast_the_shadow_of_their_opaque_part() {
    let folder = folder();
    write(folder.path(), "logo.png", 3, &[[255; 4], [255, 255, 255, 51], [0, 0, 0, 0]]);
    for integrator in ["Whitted", "Path"] {
        let lit = |x: f64| {
            let text = format!(
                "(output: (size: (1, 1)), ambient: 0, quality: (integrator: {integrator}, antialias: 1, samples: 1, bounces: 0),
                camera: (position: ({x:?}, 0.5, 5), target: ({x:?}, 0, 0), projection: Orthographic(height: 1e-9)),
                lights: {{ \"sun\": Directional(direction: (0, -1, 0)) }},
                objects: {{ \"floor\": (shape: Plane(), material: Lambertian(color: 1)),
                    \"picture\": (shape: Rectangle(corner: (0, 1, 1), u: (3, 0, 0), v: (0, 0, -2)),
                    material: (color: Image(file: \"logo.png\", filter: Nearest))) }})"
            );
            shoot_all_in(folder.path(), &text)[0].pixel(0, 0).x
        };
        assert_eq!([0.5, 2.5].map(lit), [0.0, 1.0], "{integrator}");
        assert!((lit(1.5) - 0.8).abs() < 1e-6, "{integrator}: {}", lit(1.5));
    }
}

/// Where all of an image is there, its alpha costs nothing and changes nothing.
#[test]
fn opaque_alpha_has_no_effect() {
    let folder = folder();
    let texels = [grey(40), grey(90), grey(200), grey(250)];
    write(folder.path(), "alpha.png", 2, &texels);
    let bytes = texels.iter().flat_map(|texel| texel[..3].to_vec()).collect();
    let plain = image::RgbImage::from_raw(2, 2, bytes).expect("all texels");
    plain.save(folder.path().join("plain.png")).expect("a disk");
    for integrator in ["Whitted", "Path"] {
        let shot = |name: &str| {
            let text = format!(
                "(output: (size: (16, 12)), quality: (integrator: {integrator}, samples: 2),
                lights: {{ \"l\": Point(position: (3, 4, 5)) }},
                objects: {{ \"ball\": (shape: Sphere(), material: (color: Image(\"{name}\"))), \"floor\": (shape: Plane(point: (0, -1, 0))) }})"
            );
            shoot_all_in(folder.path(), &text).remove(0)
        };
        let (with, without) = (shot("alpha.png"), shot("plain.png"));
        assert!(with.film == without.film && with.work == without.work, "{integrator}");
        assert_eq!(with.work.transmitted, 0);
    }
}

#[test]
fn useless_alpha_is_noted() {
    let folder = folder();
    write(folder.path(), "clear.png", 2, &[[255, 0, 0, 255], [0, 0, 0, 0]]);
    let notes = |text: &str| sequence_in(folder.path(), text).notes();
    let of =
        |material: &str| notes(&format!("(objects: {{ \"a\": (shape: Sphere(), material: {material}) }})"));
    let image = "Image(\"clear.png\")";
    assert_eq!(of(&format!("(color: {image})")), [""; 0]);
    assert_eq!(of("(color: Image(file: \"clear.png\", alpha: false))"), [""; 0]);
    let printed = of(&format!("(mirror: 1, fuzz: {image})"));
    assert!(
        printed.len() == 1 && printed[0].contains("`fuzz`") && printed[0].contains("alpha"),
        "{printed:?}"
    );
    let printed = of(&format!("MetallicRoughness(roughness: {image}, metallic: {image})"));
    assert!(printed[0].contains("`metallic`") && printed[0].contains("`roughness`"), "{printed:?}");
    let printed = notes("(background: Equirect(file: \"clear.png\"))");
    assert!(
        printed.len() == 1 && printed[0].contains("`background`") && printed[0].contains("alpha"),
        "{printed:?}"
    );
}

/// Rays pass clear panes without a bend, so a pattern behind them is as wide in a pixel as without.
#[test]
fn patterns_keep_their_contrast_behind_clear_panes() {
    let seen = |integrator: &str, panes: &str| -> Vec<Rgb> {
        let text = format!(
            r#"(output: (size: (24, 16)), quality: (integrator: {integrator}, samples: 16), ambient: 0,
            camera: (position: (0, 2, 12), target: (0, 0, 0)),
            objects: {{ "floor": (shape: Plane(), material: (ambient: 0, diffuse: 0, emission: 1,
                color: Checker(a: 1, b: 0, scale: 0.5))), {panes} }})"#
        );
        shoot_film(&text).radiance().collect()
    };
    let pane = |z: u32| {
        format!(
            "\"{z}\": (shape: Rectangle(corner: (-99, -99, {z}), u: (198, 0, 0), v: (0, 198, 0)),
            material: (ambient: 0, diffuse: 0, transparency: 1)),"
        )
    };
    for integrator in ["Whitted", "Path()"] {
        let open = seen(integrator, "");
        assert!(open.iter().any(|light| light.x > 0.1 && light.x < 0.9), "the pattern fades somewhere");
        assert_eq!(seen(integrator, &format!("{}{}{}", pane(4), pane(7), pane(10))), open, "{integrator}");
    }
}
