//! A gas giant: bands of clouds that stream past each other, a great red storm and small white ones.

use crate::Picture;
use crate::paint::{codes, direction, noise, offset, on_globe, rgb, smooth};
use kinora::base::math::{DQuat, DVec3};

const SIZE: (u32, u32) = (1024, 512);

/// Degrees of latitude and the colours there.
const BANDS: [(f64, DVec3); 22] = [
    (-90.0, rgb(0x6f6a64)),
    (-66.0, rgb(0x8f8474)),
    (-56.0, rgb(0xb7a78f)),
    (-50.0, rgb(0x937c66)),
    (-42.0, rgb(0xd2c1a6)),
    (-36.0, rgb(0xa98a6c)),
    (-29.0, rgb(0xe6d8c2)),
    (-22.0, rgb(0xd8bd97)),
    (-17.0, rgb(0xa46a44)),
    (-10.0, rgb(0x8e5433)),
    (-6.0, rgb(0xecdfc9)),
    (2.0, rgb(0xf5eddd)),
    (6.0, rgb(0xd7b78c)),
    (9.0, rgb(0x97572f)),
    (15.0, rgb(0xab7044)),
    (19.0, rgb(0xeadcc6)),
    (27.0, rgb(0xd5bb97)),
    (31.0, rgb(0xb08f6c)),
    (36.0, rgb(0xdccbb0)),
    (46.0, rgb(0xa8947b)),
    (60.0, rgb(0x968b7c)),
    (90.0, rgb(0x6a6660)),
];

/// An oval storm that stirs the clouds around it.
struct Storm {
    center: DVec3,
    /// Half its width and height in radians.
    reach: (f64, f64),
    color: DVec3,
    /// Radians by which its middle is turned.
    turn: f64,
}

pub fn picture() -> Picture {
    let storms = storms();
    let pixel = move |x, y| codes(color(on_globe((x, y), SIZE), &storms));
    Picture { name: "textures/planet.png".to_owned(), size: SIZE, pixel: Box::new(pixel) }
}

fn storms() -> Vec<Storm> {
    let red =
        Storm { center: direction(-22.0, -14.0), reach: (0.25, 0.135), color: rgb(0xb9522c), turn: 3.4 };
    // A string of pearls in the south, and one in the north.
    let white =
        [(-40.5, 20.0), (-41.5, 47.0), (-40.0, 82.0), (-41.0, 118.0), (-40.5, -64.0), (-41.0, -111.0)];
    let north = [(33.0, 36.0), (34.0, 152.0), (33.5, -85.0)];
    let small = white.into_iter().chain(north).map(|(latitude, longitude)| Storm {
        center: direction(latitude, longitude),
        reach: (0.055, 0.036),
        color: rgb(0xf6eee0),
        turn: 2.0,
    });
    std::iter::once(red).chain(small).collect()
}

fn color(at: DVec3, storms: &[Storm]) -> DVec3 {
    let mut stirred = at;
    let mut eye = None;
    for storm in storms {
        let offset = offset(storm.center, at);
        let radius = libm::hypot(offset.x / storm.reach.0, offset.y / storm.reach.1);
        if radius < 2.0 {
            let angle = storm.turn * (1.0 - 0.5 * radius) * (1.0 - 0.5 * radius);
            stirred = DQuat::from_axis_angle(storm.center, angle) * at;
            eye = Some((storm, radius));
        }
    }
    let clouds = clouds(stirred, at);
    let Some((storm, radius)) = eye else { return clouds };
    // Rings of the storm's own, a pale collar, then the clouds.
    let grain = noise(stirred * DVec3::new(22.0, 34.0, 22.0), 4, 77);
    let ring = if storm.reach.0 > 0.1 { 0.09 } else { 0.02 };
    let rings = 1.0 + ring * libm::sin(11.0 * radius + 3.0 * grain) + 0.10 * grain;
    let collar = rgb(0xf2e7d4) * (0.97 + 0.05 * grain);
    let outside = collar.lerp(clouds, smooth(1.15, 1.75, radius + 0.12 * grain));
    (storm.color * rings).lerp(outside, smooth(0.75, 1.1, radius + 0.08 * grain))
}

/// The bands, blown about. Noise that is stretched along the equator makes them stream.
fn clouds(at: DVec3, true_place: DVec3) -> DVec3 {
    let warp = DVec3::new(noise(at * 3.0, 3, 1), noise(at * 3.0, 3, 11), noise(at * 3.0, 3, 21));
    let streams = noise(at * DVec3::new(3.0, 26.0, 3.0) + warp * 0.9, 5, 31);
    let curls = noise(at * DVec3::new(9.0, 17.0, 9.0) + warp * 2.2, 5, 41);
    let latitude = libm::asin(at.y.clamp(-1.0, 1.0)).to_degrees();
    // Fast bands near the equator, turmoil between them; both die down towards the poles.
    let calm = smooth(70.0, 40.0, latitude.abs());
    let moved = latitude + calm * (1.1 * streams + 2.4 * curls) + 0.8 * noise(at * 2.0, 2, 51);
    let fine = noise(at * DVec3::new(14.0, 90.0, 14.0) + warp * 3.0, 4, 61);
    let festoons = curls * smooth(12.0, 5.0, (latitude - 7.0).abs());
    let shade = 1.0 + 0.09 * streams + 0.07 * fine + 0.06 * curls;
    let tint = DVec3::new(1.0, 1.0 - 0.03 * curls, 1.0 - 0.09 * curls - 0.04 * streams);
    let blue = rgb(0x8a8fa0);
    let polar = smooth(55.0, 85.0, libm::asin(true_place.y.clamp(-1.0, 1.0)).to_degrees().abs());
    let band = band(moved) * tint * shade;
    band.lerp(blue, (0.5 * festoons.max(0.0)).min(0.35)).lerp(blue * (0.72 + 0.2 * curls), 0.35 * polar)
}

fn band(latitude: f64) -> DVec3 {
    let latitude = latitude.clamp(-90.0, 89.999);
    let above = BANDS.iter().position(|(edge, _)| *edge > latitude).unwrap_or(BANDS.len() - 1).max(1);
    let ((south, below), (north, color)) = (BANDS[above - 1], BANDS[above]);
    below.lerp(color, smooth(south, north, latitude))
}
