//! Clear coats: what they reflect is taken from what is below.

use crate::support::radiance_at_target;
use kinora::base::color::Rgb;

const LEVEL: &str = "camera: (position: (0, 0, 5), target: (0, 0, 0))";

/// Some roundings of f32, of light up to 1.
const ROUNDINGS: f32 = 4.0 * f32::EPSILON;

fn near(found: Rgb, expected: f32, what: &str) {
    assert!(
        (found - Rgb::splat(expected)).abs().max_element() < ROUNDINGS,
        "{what}: {found}, not {expected}"
    );
}

/// Under a white sky, surfaces that lose no light stay white with a sharp coat, at any angle.
#[test]
fn sharp_coats_lose_no_light() {
    for material in [
        "(diffuse: 0, ambient: 0, transparency: 1, coat: 1)",
        "(diffuse: 0, ambient: 0, transparency: 1, coat: 0.5)",
        "Metal(color: 1, coat: 1)",
        "MetallicRoughness(color: 1, roughness: 0, coat: 0.75)",
    ] {
        for camera in [LEVEL, "camera: (position: (5, 0, 1), target: (0, 0, 0))"] {
            let rest = format!(
                "{camera}, background: 1, ambient: 0, objects: {{ \"sheet\": (material: {material},
                shape: Rectangle(corner: (-1, -1, 0), u: (2, 0, 0), v: (0, 2, 0))) }}"
            );
            near(radiance_at_target(&rest), 1.0, material);
        }
    }
}

/// Light passes a coated sheet to the floor and to the eye, and loses 4 % each time.
#[test]
fn coats_dim_what_passes() {
    let seen = |coat: &str, color: &str| {
        radiance_at_target(&format!(
            "{LEVEL}, background: 0, ambient: 0, lights: {{ \"sun\": Directional(direction: (0, 0, -1)) }},
            objects: {{
                \"floor\": (shape: Plane(normal: (0, 0, 1)), material: (color: 1, diffuse: 0.5, ambient: 0)),
                \"sheet\": (shape: Rectangle(corner: (-1, -1, 1), u: (2, 0, 0), v: (0, 2, 0)),
                    material: (color: {color}, diffuse: 0, ambient: 0, transparency: 1{coat})),
            }}"
        ))
    };
    near(seen("", "1"), 0.5, "without a coat");
    near(seen(", coat: 1", "1"), 0.5 * 0.96 * 0.96, "with a coat");
    // The whole sheet is in one of two bands.
    let halves = |a: u8, b: u8| format!(", coat: Stripes(a: {a}, b: {b}, scale: 1000, offset: (-500, 0))");
    let both = [seen(&halves(0, 1), "1"), seen(&halves(1, 0), "1")].map(|light| light.x);
    assert!(
        both.contains(&0.5) && both.iter().any(|light| (light - 0.5 * 0.96 * 0.96).abs() < ROUNDINGS),
        "{both:?}"
    );
}
