// Reads the linear light of a frame, and changes the brightness of a lamp without tracing again.

use kinora::{FilmCollector, FrameLoop, RenderError, Rgb, parse};
use std::error::Error;

/// Keys give the lamp a layer of its own on the film.
const SCENE: &str = r#"(
    timeline: (frames: 2, fps: 1),
    output: (size: (64, 36)),
    camera: (position: (0, 2, 6), target: (0, 1, 0)),
    lights: {
        "sun": Directional(direction: (-1, -3, -2)),
        "lamp": Point(position: (2, 3, 2), color: (1, 0.5, 0.2), intensity: [(0, 1), (1, 0)]),
    },
    objects: { "floor": (shape: Plane()), "ball": (shape: Sphere(center: (0, 1, 0))) },
)"#;

fn mean(light: impl Iterator<Item = Rgb>, pixels: u32) -> Rgb {
    light.sum::<Rgb>() / pixels as f32
}

fn main() -> Result<(), Box<dyn Error>> {
    let sequence = parse("lamp.ron", SCENE)?;
    let mut frames = FrameLoop::new(&sequence, FilmCollector::default(), Default::default());
    frames.frame(0).map_err(RenderError::from)?;
    let films = frames.into_sink().ok_or("no films")?.0;
    let film = &films[0];

    // Pixels are row by row from the top left, in radiance before exposure and tone mapping.
    assert_eq!((film.width, film.height), (64, 36));
    let bottom = film.radiance_at(35 * 64 + 32);
    assert!(bottom.x > bottom.z && bottom.min_element() > 0.0, "the floor in warm light: {bottom}");

    // Layer 0 is all light without keys, layer 1 is the lamp. A picture is the weighted sum of its layers.
    let [constant, lamp] =
        [0, 1].map(|layer| mean((0..64 * 36).map(|pixel| film.radiance_of(pixel, layer)), 64 * 36));
    let brighter = film.weighted_by(&[film.weights[0], film.weights[1] * 3.0]);
    let expected = constant + lamp * 3.0;
    assert!((mean(brighter.radiance(), 64 * 36) - expected).length() < 1e-4);
    Ok(())
}
