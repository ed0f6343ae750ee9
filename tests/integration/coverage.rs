//! What films record besides light: what hides the background, and what is seen first.

use crate::support::{sequence, shoot, shoot_extra};
use kinora::base::color::Rgb;
use kinora::film::{AovSet, Film};
use kinora::sequence::Sequence;

fn shoot_covered(sequence: &Sequence) -> Film {
    shoot_extra(sequence, AovSet { coverage: true, features: false, guides: false, samples: false })
}

/// The film of a frame with its coverage, as PNGs show it.
fn alphas(scene: &str, pixels: &[(u32, u32)]) -> Vec<f32> {
    let sequence = sequence(&format!("(output: (size: (9, 9), transparent: true), {scene})"));
    let film = shoot_covered(&sequence);
    pixels.iter().map(|(x, y)| film.alpha_at((y * 9 + x) as usize)).collect()
}

#[test]
fn visible_background_is_not_covered() {
    const CAMERA: &str =
        "camera: (position: (0, 0, 5), projection: Orthographic(height: 9)), background: 0.5";
    // A board from x = 0.25 to the right: it covers a quarter of the middle column.
    let board = "(shape: Box(min: (0.25, -9, -1), max: (9, 9, 0)), material: (color: 1";
    for quality in ["antialias: 8", "integrator: Path(), samples: 4096"] {
        let opaque = format!("{CAMERA}, quality: ({quality}), objects: {{ \"a\": {board})) }}");
        let found = alphas(&opaque, &[(0, 4), (4, 4), (8, 4)]);
        assert_eq!((found[0], found[2]), (0.0, 1.0));
        assert!((found[1] - 0.25).abs() < 0.01, "{quality}: {found:?}");
        // What lets half of the light pass covers half, twice; a mirror and glass hide what is behind.
        let clear =
            format!("{CAMERA}, quality: ({quality}), objects: {{ \"a\": {board}, transparency: 0.5)) }}");
        let found = alphas(&clear, &[(8, 4)]);
        assert!((found[0] - 0.75).abs() < 0.02, "{quality}: {found:?}");
        let mirror = format!("{CAMERA}, quality: ({quality}), objects: {{ \"a\": {board}, mirror: 1)) }}");
        assert_eq!(alphas(&mirror, &[(8, 4)]), [1.0]);
    }
    // Fog is there wherever the background would be.
    let fog = format!("{CAMERA}, fog: (density: 1)");
    assert_eq!(alphas(&fog, &[(0, 0)]), [1.0]);
}

/// In front of any colour, the picture is what it would be with that colour as its background.
#[test]
fn a_transparent_picture_fits_before_any_background() {
    const SCENE: &str = "quality: (antialias: 4), camera: (position: (0, 0.4, 3)), lights: { \"l\": Point(position: (3, 4, 5)) },
        objects: { \"a\": (shape: Sphere(radius: 1), material: (color: \"#c04020\", transparency: 0.3)) }";
    let with = |output: &str, background: f32| {
        sequence(&format!("(output: (size: (24, 24){output}), background: {background}, {SCENE})"))
    };
    let film = shoot_covered(&with(", transparent: true", 0.7));
    for background in [0.0_f32, 0.25, 1.0] {
        let expected = &shoot(&with("", background), [0])[0].film;
        for (pixel, wanted) in expected.radiance().enumerate() {
            let mixed = film.radiance_at(pixel) + (1.0 - film.alpha_at(pixel)) * background;
            assert!((mixed - wanted).abs().max_element() < 1e-6, "pixel {pixel}: {mixed} for {wanted}");
        }
    }
}

#[test]
fn aovs_record_first_hits_and_do_not_change_the_light() {
    let sequence = sequence(
        r#"(output: (size: (9, 9)), quality: (antialias: 2), background: 0.2,
        camera: (position: (0, 0, 5), projection: Orthographic(height: 9)),
        lights: { "l": Point(position: (3, 4, 5)) },
        objects: { "a": (shape: Box(min: (0.5, -9, -1), max: (9, 9, 2)), material: (color: 1, diffuse: 0.5, mirror: 0.1)) })"#,
    );
    let plain = &shoot(&sequence, [0])[0].film;
    let film =
        shoot_extra(&sequence, AovSet { coverage: false, features: true, guides: false, samples: false });
    assert_eq!(plain.radiance().collect::<Vec<_>>(), film.radiance().collect::<Vec<_>>());
    let (nothing, board) =
        (film.features_at(9 * 4).expect("features"), film.features_at(9 * 4 + 7).expect("features"));
    assert_eq!((nothing.depth, nothing.normal, nothing.albedo), (None, Rgb::ZERO, Rgb::ZERO));
    assert_eq!((board.depth, board.normal), (Some(3.0), Rgb::Z));
    assert!((board.albedo - 0.6).abs().max_element() < 1e-6, "{board:?}");
}
