//! What the pictures have in common: noise, mixing, and directions on a globe.

use kinora::appearance::texture::Pattern;
use kinora::base::math::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Layered gradient noise, about -1..=1.
pub fn noise(point: DVec3, octaves: u32, seed: u32) -> f64 {
    2.0 * Pattern::Noise { octaves, seed }.share(point, DVec3::ZERO, DVec3::ZERO) - 1.0
}

/// Layered noise with sharp crests, in 0..=1.
pub fn ridges(point: DVec3, octaves: u32, seed: u32) -> f64 {
    let (mut sum, mut whole, mut strength, mut scale) = (0.0, 0.0, 1.0, 1.0);
    for octave in 0..octaves {
        let crest = 1.0 - noise(point * scale, 1, seed + octave).abs();
        sum += strength * crest * crest;
        whole += strength;
        (strength, scale) = (strength * 0.5, scale * 2.0);
    }
    sum / whole
}

/// From 0 at `from` to 1 at `to`, starting and ending at rest.
pub fn smooth(from: f64, to: f64, at: f64) -> f64 {
    let s = ((at - from) / (to - from)).clamp(0.0, 1.0);
    s * s * (3.0 - 2.0 * s)
}

/// The colour "rrggbb" as numbers from 0 to 1.
pub const fn rgb(code: u32) -> DVec3 {
    let [_, red, green, blue] = code.to_be_bytes();
    DVec3::new(red as f64 / 255.0, green as f64 / 255.0, blue as f64 / 255.0)
}

/// Displayed values to codes.
pub fn codes(color: DVec3) -> [u8; 3] {
    color.to_array().map(|value| (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8)
}

/// The direction from a globe's centre that a pixel of its map belongs to, as the texture coordinates of spheres
/// in Kinora have it.
pub fn on_globe((x, y): (u32, u32), (width, height): (u32, u32)) -> DVec3 {
    let s = (f64::from(x) + 0.5) / f64::from(width);
    let t = 1.0 - (f64::from(y) + 0.5) / f64::from(height);
    let (longitude, latitude) = (0.5 + PI - TAU * s, PI * (t - 0.5));
    let level = libm::cos(latitude);
    DVec3::new(level * libm::cos(longitude), libm::sin(latitude), level * libm::sin(longitude))
}

/// The direction of a latitude and a longitude in degrees; longitude 0 is at +z, 90 at +x.
pub fn direction(latitude: f64, longitude: f64) -> DVec3 {
    let (latitude, longitude) = (latitude.to_radians(), longitude.to_radians());
    let level = libm::cos(latitude);
    DVec3::new(level * libm::sin(longitude), libm::sin(latitude), level * libm::cos(longitude))
}

/// How far `at` lies east and north of `center`, in radians; for what is near.
pub fn offset(center: DVec3, at: DVec3) -> DVec2 {
    let east = DVec3::Y.cross(center).normalize_or(DVec3::X);
    let north = center.cross(east);
    let way = (at - center).length();
    let flat = DVec2::new(at.dot(east), at.dot(north)).normalize_or_zero();
    flat * 2.0 * libm::asin((0.5 * way).min(1.0))
}
