//! Bump maps and normal maps: shading normals that textures turn.

use crate::support::{radiance_at_target, sequence_in, shoot, shoot_film};
use kinora::base::color::Rgb;
use std::path::Path;
use tempfile::TempDir;

/// A folder with an image of these texels, from left to right.
fn folder(texels: &[[u8; 3]]) -> TempDir {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let image = image::RgbImage::from_fn(texels.len() as u32, 1, |x, _| image::Rgb(texels[x as usize]));
    image.save(folder.path().join("map.png")).expect("a disk");
    folder
}

/// A white square from -1 to 1 that faces the camera, with this relief, lit along `direction`.
fn lit(folder: &Path, relief: &str, direction: &str) -> f64 {
    let text = format!(
        "(output: (size: (1, 1)), quality: (antialias: 1), background: 0, ambient: 0,
        camera: (position: (0.2, 0, 5), target: (0.2, 0, 0), projection: Orthographic(height: 0.001)),
        lights: {{ \"sun\": Directional(direction: {direction}) }},
        objects: {{ \"square\": (shape: Rectangle(corner: (-1, -1, 0), u: (2, 0, 0), v: (0, 2, 0)),
            material: (color: 1, diffuse: 1, ambient: 0{relief})) }})"
    );
    f64::from(shoot(&sequence_in(folder, &text), [0]).remove(0).pixel(0, 0).x)
}

#[test]
fn normal_maps_turn_normals_by_their_colours() {
    let folder = folder(&[[230, 128, 200]]);
    let folder = folder.path();
    let component = |code: f64| 2.0 * code / 255.0 - 1.0;
    let (x, y, z) = (component(230.0), component(128.0), component(200.0));
    let length = |strength: f64| (strength * strength * (x * x + y * y) + z * z).sqrt();
    // A light from the front, which no relief shadows.
    let front = |relief: &str| lit(folder, relief, "(0, 0, -1)");
    assert!((front(", normal_map: \"map.png\"") - z / length(1.0)).abs() < 1e-6);
    assert!((front(", normal_map: (file: \"map.png\", strength: 0.5)") - z / length(0.5)).abs() < 1e-6);
    assert_eq!(front(", normal_map: (file: \"map.png\", strength: 0)"), 1.0);
    // Light from the right, towards which the normal leans, is brighter than light from the left.
    let side = |direction: &str| lit(folder, ", normal_map: \"map.png\"", direction);
    assert!(side("(-1, 0, -1)") > 0.9 && side("(1, 0, -1)") < 0.4, "{}", side("(-1, 0, -1)"));
}

#[test]
fn bumps_turn_normals_by_their_slope() {
    // From black to white between the centres of two texels, that is over a length of 1.
    let folder = folder(&[[0, 0, 0], [255, 255, 255]]);
    let front = |depth: f64| {
        let relief = format!(", bump: (height: Image(\"map.png\"), depth: {depth})");
        lit(folder.path(), &relief, "(0, 0, -1)")
    };
    // Colours are f32: off by 2^-25, over a distance of half a pixel of 0.001, times the depth.
    for depth in [0.75, -0.75] {
        assert!((front(depth) - 0.8).abs() < 2e-5, "{}", front(depth));
    }
    assert_eq!(front(0.0), 1.0);
}

/// Moved, turned and scaled objects have the relief of their own space.
#[test]
fn relief_moves_with_its_object() {
    let scene = |object: &str| {
        radiance_at_target(&format!(
            "camera: (position: (0.1, 0.2, 5), target: (0.1, 0.2, 0), projection: Orthographic(height: 0.01)),
            background: 0, ambient: 0, lights: {{ \"sun\": Directional(direction: (0.2, -0.3, -1)) }},
            objects: {{ \"square\": ({object}, material: (color: 1, diffuse: 1, ambient: 0,
                bump: (height: Noise(a: 0, b: 1, scale: 0.3), depth: 0.2))) }}"
        ))
    };
    let square = "shape: Rectangle(corner: (-1, -1, 0), u: (2, 0, 0), v: (0, 2, 0))";
    let plain = scene(square);
    let parted = scene(&format!("{square}, translation: (0, 0, -3)"));
    assert!((plain - parted).length() < 1e-4, "{plain} {parted}");
    assert!(plain != Rgb::ZERO);
}

/// A lossless mirror is invisible in uniform light, whatever its relief: light that it would reflect into itself is
/// reflected once more.
#[test]
fn mirrors_with_relief_lose_no_light() {
    let film = shoot_film(
        "(output: (size: (48, 48)), quality: (antialias: 1, bounces: 64), background: 0.5, ambient: 0,
        camera: (position: (0, 1, 4), target: (0, 0, 0)),
        objects: { \"ball\": (shape: Sphere(), material: (diffuse: 0, ambient: 0, mirror: 1,
            bump: (height: Noise(a: 0, b: 1, scale: 0.2), depth: 0.2))) })",
    );
    for radiance in film.radiance() {
        assert!((radiance - Rgb::splat(0.5)).length() < 1e-4, "{radiance}");
    }
}

/// In a white furnace, a diffuse surface with relief reflects at most what arrives, and not much less.
#[test]
fn diffuse_relief_gains_no_light() {
    let film = shoot_film(
        "(output: (size: (16, 16)), quality: (integrator: Path, samples: 64, bounces: 1), background: 1, ambient: 0,
        camera: (position: (0, 0, 3), target: (0, 0, 0), projection: Orthographic(height: 1)),
        objects: { \"square\": (shape: Rectangle(corner: (-1, -1, 0), u: (2, 0, 0), v: (0, 2, 0)),
            material: (color: 1, diffuse: 1, ambient: 0, bump: (height: Noise(a: 0, b: 1, scale: 0.3), depth: 0.1))) })",
    );
    let all: Vec<f64> = film.radiance().map(|radiance| f64::from(radiance.x)).collect();
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    assert!((0.6..=1.0 + 1e-6).contains(&mean), "{mean}");
}

/// Light from behind the flat surface arrives nowhere, however normals lean; at the horizon it fades.
#[test]
fn light_fades_towards_the_horizon() {
    let folder = folder(&[[255, 128, 160]]);
    let at = |height: f64| lit(folder.path(), ", normal_map: \"map.png\"", &format!("(-1, 0, {})", -height));
    assert_eq!(at(-0.01), 0.0);
    let values = [0.001, 0.01, 0.1, 0.5].map(at);
    assert!(values[0] < 0.02 && values.is_sorted(), "{values:?}");
}
