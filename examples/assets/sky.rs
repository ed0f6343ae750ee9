//! A mountain lake in the morning, in all directions: a cube map for `mirrored: true`, with `pz` at -z.
//!
//! Every pixel is computed from its direction, so that there is nothing to join at the edges.

use crate::Picture;
use crate::paint::{codes, direction, noise, ridges, smooth};
use kinora::base::color::linear_to_srgb;
use kinora::base::math::DVec3;

/// Pixels along an edge of a face.
const EDGE: u32 = 512;

/// Names of the faces, and what is ahead, to the right and downwards in their pictures.
const FACES: [(&str, [DVec3; 3]); 6] = [
    ("px", [DVec3::X, DVec3::Z, DVec3::NEG_Y]),
    ("nx", [DVec3::NEG_X, DVec3::NEG_Z, DVec3::NEG_Y]),
    ("py", [DVec3::Y, DVec3::X, DVec3::NEG_Z]),
    ("ny", [DVec3::NEG_Y, DVec3::X, DVec3::Z]),
    ("pz", [DVec3::NEG_Z, DVec3::X, DVec3::NEG_Y]),
    ("nz", [DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y]),
];

pub fn pictures() -> impl Iterator<Item = Picture> {
    FACES.into_iter().map(|(name, [ahead, right, down])| Picture {
        name: format!("sky/{name}.png"),
        size: (EDGE, EDGE),
        pixel: Box::new(move |x, y| {
            let mut sum = DVec3::ZERO;
            // 2 x 2 samples, so that crests are smooth.
            for (i, j) in [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)] {
                let along =
                    |pixel: u32, inside: f64| 2.0 * (f64::from(pixel) + inside) / f64::from(EDGE) - 1.0;
                sum += seen((ahead + right * along(x, i) + down * along(y, j)).normalize());
            }
            codes((0.25 * sum).min(DVec3::ONE).map(linear_to_srgb))
        }),
    })
}

/// Towards the sun: ahead to the right.
fn sun() -> DVec3 {
    direction(24.0, 140.0)
}

/// What is seen in a direction, as linear light.
fn seen(towards: DVec3) -> DVec3 {
    if towards.y >= 0.0 {
        return land_or_sky(towards);
    }
    // The eye is one unit above the water; a grassy islet is around it.
    let place = DVec3::new(towards.x, 0.0, towards.z) / -towards.y.min(-1e-4);
    let shore = place.length() + 0.8 * noise(place * 0.9, 4, 201);
    if shore < 2.4 {
        return meadow(place).lerp(DVec3::new(0.30, 0.25, 0.16), smooth(1.9, 2.3, shore));
    }
    water(towards, place).lerp(DVec3::new(0.16, 0.17, 0.13), 0.6 * smooth(3.3, 2.4, shore))
}

fn meadow(place: DVec3) -> DVec3 {
    let blades = noise(place * DVec3::new(22.0, 1.0, 22.0), 3, 211);
    let patches = noise(place * 2.3, 3, 212);
    let green = DVec3::new(0.07, 0.16, 0.03).lerp(DVec3::new(0.22, 0.27, 0.06), 0.5 + 0.5 * patches);
    let flowers = smooth(0.46, 0.52, noise(place * 16.0, 2, 213));
    (green * (1.0 + 0.5 * blades)).lerp(DVec3::new(0.85, 0.8, 0.55), 0.7 * flowers)
}

/// The lake: the land and sky mirrored in small waves, more of them the flatter the view (Schlick 1994).
fn water(towards: DVec3, place: DVec3) -> DVec3 {
    // Waves that are smaller than a pixel even out.
    let near = 1.0 / (1.0 + 0.02 * place.length_squared());
    let wave = |seed| 0.05 * near * noise(place * DVec3::new(1.4, 1.0, 2.6), 3, seed);
    let mirrored = DVec3::new(towards.x + wave(221), -towards.y + 0.012, towards.z + wave(222)).normalize();
    let grazing = 1.0 + towards.y.max(-1.0);
    let share = 0.04 + 0.96 * grazing * grazing * grazing * grazing * grazing;
    let depth = DVec3::new(0.015, 0.06, 0.075);
    depth.lerp(land_or_sky(mirrored), share.max(0.25))
}

/// Ranges of mountains from far to near: how high they are in radians, how coarse, their seed and haze.
const RANGES: [(f64, f64, u32, f64); 3] =
    [(0.66, 2.2, 301, 0.44), (0.38, 3.4, 321, 0.24), (0.13, 6.5, 341, 0.08)];

fn land_or_sky(towards: DVec3) -> DVec3 {
    let height = libm::asin(towards.y.clamp(-1.0, 1.0));
    let level = DVec3::new(towards.x, 0.0, towards.z).normalize_or(DVec3::X);
    let mut color = sky(towards);
    for (tall, scale, seed, haze) in RANGES {
        let crest = |at: DVec3| {
            let rough = ridges(at * scale, 6, seed);
            let broad = 0.55 + 0.45 * noise(at * 1.6, 2, seed + 9);
            tall * broad * (0.25 + 0.75 * rough)
        };
        let top = crest(level);
        if height < top {
            color = slope(level, height, top, (scale, seed, haze));
        }
    }
    color
}

/// The side of a mountain: forest, rock and, up high, snow, behind haze.
fn slope(level: DVec3, height: f64, top: f64, (scale, seed, haze): (f64, u32, f64)) -> DVec3 {
    let place = level * (scale * 3.0) + DVec3::Y * (height * 22.0);
    // Faces towards the sun are lit; gullies run down the slope.
    let step = DVec3::new(sun().x, 0.35, sun().z) * 0.12;
    let facing = ridges(place, 5, seed + 20) - ridges(place + step, 5, seed + 20);
    let light = (0.62 + 2.2 * facing).clamp(0.12, 1.3);
    let grain = noise(place * 3.0, 3, seed + 30);
    let forest = DVec3::new(0.035, 0.075, 0.03) * (1.0 + 0.5 * grain);
    let rock = DVec3::new(0.26, 0.23, 0.21) * (1.0 + 0.3 * grain);
    let snow = DVec3::new(0.92, 0.95, 1.0);
    let above = height + 0.02 * grain;
    let bare = forest.lerp(rock, smooth(0.11, 0.18, above));
    let white = smooth(0.20, 0.26, above) * smooth(-0.05, 0.03, facing + 0.25 * (above - 0.22));
    let near_top = smooth(0.0, 0.02, top - height);
    let color = bare.lerp(snow, white) * light * (0.9 + 0.1 * near_top);
    let color = color * DVec3::new(1.0, 0.95, 0.88);
    // Haze is thickest above the water.
    let thick = haze + (1.0 - haze) * 0.45 * smooth(0.05, 0.0, height);
    color.lerp(air(sun().dot(level)), thick)
}

/// The colour of far air, warmer towards the sun.
fn air(cosine: f64) -> DVec3 {
    DVec3::new(0.50, 0.63, 0.80).lerp(DVec3::new(0.92, 0.80, 0.66), smooth(0.2, 1.0, cosine))
}

fn sky(towards: DVec3) -> DVec3 {
    let cosine = towards.dot(sun());
    let high = 1.0 - towards.y.max(0.0);
    let pale = high * high * high;
    let blue = DVec3::new(0.055, 0.19, 0.52).lerp(air(cosine) * 1.05, pale);
    let glow = smooth(0.86, 1.0, cosine);
    let disc = smooth(0.9988, 0.9994, cosine);
    let blue = blue + DVec3::new(0.9, 0.72, 0.45) * (0.30 * glow * glow + 0.25 * smooth(0.985, 1.0, cosine));
    // Clouds on a sheet above, bent down towards the horizon.
    let sheet = DVec3::new(towards.x, 0.0, towards.z) / (towards.y.max(0.0) + 0.14);
    let warp = DVec3::new(noise(sheet * 1.1, 3, 401), 0.0, noise(sheet * 1.1, 3, 402));
    let thickness = |at: DVec3| noise(at * 0.85 + warp * 0.35, 6, 410) + 0.25 * noise(at * 0.3, 2, 420);
    let cloud = thickness(sheet);
    let covered = smooth(0.06, 0.34, cloud) * smooth(0.02, 0.16, towards.y);
    let towards_sun = DVec3::new(sun().x, 0.0, sun().z);
    let shade = (0.86 + 0.9 * (cloud - thickness(sheet + towards_sun * 0.25))).clamp(0.55, 1.0);
    let white = DVec3::new(1.0, 0.97, 0.93) * shade;
    let white = white + DVec3::new(0.5, 0.35, 0.15) * 0.5 * glow;
    (blue + DVec3::splat(2.0 * disc)).lerp(white, 0.92 * covered)
}
