//! A moon: bright highlands, dark seas and craters, of which the youngest have rays.

use crate::Picture;
use crate::paint::{codes, direction, noise, offset, on_globe, rgb, smooth};
use kinora::base::math::DVec3;
use std::f64::consts::TAU;

const SIZE: (u32, u32) = (512, 256);

struct Crater {
    center: DVec3,
    /// Of its rim, in radians.
    radius: f64,
    rays: bool,
}

pub fn picture() -> Picture {
    let craters = craters();
    let pixel = move |x, y| codes(color(on_globe((x, y), SIZE), &craters));
    Picture { name: "textures/moon.png".to_owned(), size: SIZE, pixel: Box::new(pixel) }
}

/// Many small craters and few large ones, anywhere; three young ones.
fn craters() -> Vec<Crater> {
    let mut state = 1969u64;
    // A linear congruential generator (Knuth's MMIX), whose high bits are good enough for craters.
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let old = (0..420).map(|_| {
        let (height, longitude, size) = (2.0 * random() - 1.0, TAU * random(), random());
        let level = ((1.0 - height) * (1.0 + height)).sqrt();
        let center = DVec3::new(level * libm::cos(longitude), height, level * libm::sin(longitude));
        let small = 1.0 - size;
        Crater { center, radius: 0.018 + 0.13 * small * small * small * small, rays: false }
    });
    let young = [(-43.0, -11.0, 0.075), (10.0, -32.0, 0.06), (24.0, 47.0, 0.045)];
    let young = young.map(|(latitude, longitude, radius)| Crater {
        center: direction(latitude, longitude),
        radius,
        rays: true,
    });
    old.collect::<Vec<_>>().into_iter().chain(young).collect()
}

fn color(at: DVec3, craters: &[Crater]) -> DVec3 {
    let warp = DVec3::new(noise(at * 4.0, 3, 101), noise(at * 4.0, 3, 102), noise(at * 4.0, 3, 103));
    // Seas lie mostly on the side towards +z, as they do on the near side of ours.
    let sea = noise(at * 1.7 + warp * 0.25, 4, 110) + 0.30 * at.z + 0.12 * at.y;
    let sea = smooth(0.06, 0.30, sea);
    let grain = noise(at * 24.0, 4, 120);
    let highland = rgb(0xb9b4ab) * (1.0 + 0.16 * noise(at * 7.0, 4, 130) + 0.12 * grain);
    let basalt = rgb(0x67676c) * (1.0 + 0.14 * noise(at * 5.0, 3, 140) + 0.08 * grain);
    let ground = highland.lerp(basalt, sea);
    let (mut relief, mut bright) = (0.0, 0.0);
    for crater in craters {
        if at.dot(crater.center) < 0.5 {
            continue;
        }
        let offset = offset(crater.center, at);
        let radius = offset.length() / crater.radius;
        // Walls towards the west are in the light, those towards the east in the shade: as if in the morning.
        let side = offset.normalize_or_zero().x;
        let wall = smooth(0.35, 0.85, radius) * smooth(1.08, 0.92, radius);
        let slope = smooth(0.95, 1.08, radius) * smooth(1.5, 1.08, radius);
        let worn = if crater.rays { 1.0 } else { 0.75 };
        relief += worn * side * (0.22 * wall - 0.16 * slope);
        relief += 0.09 * worn * smooth(0.16, 0.04, (radius - 1.0).abs()) - 0.06 * smooth(1.0, 0.6, radius);
        if crater.rays && radius < 9.0 {
            let around = noise((at - crater.center).normalize_or_zero() * 5.0, 3, 150);
            let ray = smooth(0.05, 0.5, around) * smooth(9.0, 1.0, radius);
            bright += 0.7 * ray + 0.8 * smooth(1.9, 1.0, radius);
        }
    }
    // The seas have drowned what was there before them.
    let relief = relief.clamp(-0.5, 0.4) * (1.0 - 0.55 * sea);
    let lit = ground * (1.0 + relief);
    lit.lerp(rgb(0xe6e2da), 0.55 * (bright * (1.0 + 0.4 * grain)).clamp(0.0, 1.0))
}
