//! Skies around a scene: directly, in mirrors, turned and faded.

use crate::support::shoot_all_in;
use image::{ImageBuffer, Rgb as Pixel};
use kinora::base::color::Rgb;
use std::path::Path;

fn near(found: Rgb, expected: Rgb) {
    assert!((found - expected).abs().max_element() < 1e-5, "{found}, not {expected}");
}

/// The one pixel of every frame.
fn seen(frames: u32, fields: &str) -> Vec<Rgb> {
    seen_in(Path::new(""), frames, fields)
}

/// The same of a sequence in a folder with its images.
fn seen_in(folder: &Path, frames: u32, fields: &str) -> Vec<Rgb> {
    let text = format!(
        "(timeline: (frames: {frames}, keys: Frames), output: (size: (1, 1)), quality: (antialias: 1), {fields})"
    );
    let shots = shoot_all_in(folder, &text);
    shots.iter().map(|shot| shot.pixel(0, 0)).collect()
}

/// Writes a picture of four floating-point columns: red, green, blue, white.
fn columns(folder: &Path) -> String {
    let colors = [[4.0f32, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0], [4.0, 4.0, 4.0]];
    let path = folder.join("columns.hdr");
    ImageBuffer::from_fn(4, 2, |x, _| Pixel(colors[x as usize])).save(&path).expect("a file");
    path.to_string_lossy().replace('\\', "/")
}

const AHEAD: &str = "camera: (position: (0, 0, 5), target: (0, 0, 0))";

#[test]
fn gradients_are_seen_directly_and_in_mirrors() {
    near(seen(1, &format!("background: Gradient(), {AHEAD}"))[0], Rgb::new(0.75, 0.85, 1.0));
    let down = "camera: (position: (0, 5, 0), target: (0, 0, 0))";
    near(seen(1, &format!("background: Gradient(bottom: 0.25), {down}"))[0], Rgb::splat(0.25));
    let mirror = r#"objects: { "m": (shape: Plane(), material: (ambient: 0, mirror: 0.5)) }"#;
    let up = seen(1, &format!("background: Gradient(top: (0, 1, 2)), {down}, {mirror}"));
    near(up[0], Rgb::new(0.0, 0.5, 1.0));
}

#[test]
fn images_turn_and_fade_by_keys() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = columns(folder.path());
    // At 45 degrees to the right of straight ahead is the middle of the third column.
    let camera = "camera: (position: (0, 0, 0), target: (1, 0, -1))";
    let sky = |fields: &str| format!("background: Equirect(file: {file:?}, {fields}), {camera}");
    near(seen_in(folder.path(), 1, &sky(""))[0], Rgb::Z * 4.0);
    // Turned to the right by a quarter, it shows there what was ahead on the left.
    let turned = seen_in(folder.path(), 3, &sky("rotation: [(0, 0), (2, -180)]"));
    [Rgb::Z, Rgb::Y, Rgb::X].into_iter().zip(turned).for_each(|(color, seen)| near(seen, color * 4.0));
    let faded = seen_in(folder.path(), 3, &sky("intensity: [(0, 0), (2, 1)]"));
    [0.0, 2.0, 4.0].into_iter().zip(faded).for_each(|(blue, seen)| near(seen, Rgb::Z * blue));
}

/// One of another shape is refused: tests/bad/sky-not-twice-as-wide.ron.
#[test]
fn images_of_all_directions_may_be_off_by_a_pixel() {
    let folder = tempfile::tempdir().expect("a folder");
    for (width, height) in [(7, 4), (8, 4), (9, 4), (1, 1)] {
        let path = folder.path().join(format!("{width}x{height}.png"));
        ImageBuffer::from_pixel(width, height, Pixel([255u8; 3])).save(&path).expect("a file");
        let file = path.to_string_lossy().replace('\\', "/");
        near(seen_in(folder.path(), 1, &format!("background: Equirect({file:?}), {AHEAD}"))[0], Rgb::ONE);
    }
}

#[test]
fn cube_maps_face_the_way_their_names_say_or_mirrored() {
    let folder = tempfile::tempdir().expect("a folder");
    for (face, code) in ["px", "nx", "py", "ny", "pz", "nz"].into_iter().zip([10u8, 20, 30, 40, 50, 60]) {
        let path = folder.path().join(format!("sky-{face}.png"));
        ImageBuffer::from_pixel(2, 2, Pixel([code; 3])).save(&path).expect("a file");
    }
    let files = folder.path().join("sky-*.png").to_string_lossy().replace('\\', "/");
    let sky = |more: &str| format!("background: CubeMap(files: {files:?}, encoding: Linear{more}), {AHEAD}");
    near(seen_in(folder.path(), 1, &sky(""))[0], Rgb::splat(60.0 / 255.0));
    near(seen_in(folder.path(), 1, &sky(", mirrored: true"))[0], Rgb::splat(50.0 / 255.0));
    near(
        seen_in(folder.path(), 1, &sky(", rotation: AxisAngle(axis: (1, 0, 0), angle: 90)"))[0],
        Rgb::splat(40.0 / 255.0),
    );
}
