//! A sea snail's shell: a tube that winds down a cone and widens by the same factor with every turn, with ribs
//! across and cords along it. It begins at the tip and ends in a lip that turns inwards.

use crate::paint::{noise, rgb, smooth};
use kinora::base::color::{Rgb, srgb_to_linear};
use kinora::base::math::DVec3;
use kinora::geometry::mesh::MeshData;
use std::f64::consts::TAU;

const TURNS: f64 = 7.5;
/// The factor by which a turn is larger than the one before.
const GROWTH: f64 = 1.5;
/// How far the tube's middle is from the axis, and below the tip, for a tube of size 1.
const OUT: f64 = 1.0;
const DOWN: f64 = 2.75;
/// The tube's own radius.
const TUBE: f64 = 0.72;

/// Points along the tube and around it: 2 x 1850 x 144 triangles.
const ALONG: u32 = 1850;
const AROUND: u32 = 144;
/// The part of `ALONG` that is the inner side, behind the lip.
const INNER: u32 = 250;

/// About 533,000 triangles, 3 high, with its lower end at y = 0.
pub fn parts() -> MeshData {
    let mut parts = MeshData::default();
    for row in 0..=ALONG {
        for column in 0..AROUND {
            let (point, color) = vertex(row, TAU * f64::from(column) / f64::from(AROUND));
            parts.positions.push(point);
            parts.colors.push(color);
        }
    }
    let bottom = parts.positions.iter().map(|point| point.y).fold(f64::INFINITY, f64::min);
    let top = parts.positions.iter().map(|point| point.y).fold(f64::NEG_INFINITY, f64::max);
    for point in &mut parts.positions {
        // As f32 numbers, which is what the file holds.
        *point = ((*point - DVec3::Y * bottom) * (3.0 / (top - bottom))).as_vec3().as_dvec3();
    }
    for row in 0..ALONG {
        for column in 0..AROUND {
            let at = |row: u32, column: u32| row * AROUND + column % AROUND;
            let (a, b) = (at(row, column), at(row, column + 1));
            let (c, d) = (at(row + 1, column), at(row + 1, column + 1));
            parts.triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    parts
}

/// A point of the surface and its colour. `around` is 0 outwards, a quarter turn on upwards.
fn vertex(row: u32, around: f64) -> (DVec3, Rgb) {
    let outer = ALONG - INNER;
    let inside = row.saturating_sub(outer);
    // The inner side goes back half a turn.
    let turns = match inside {
        0 => TURNS * f64::from(row) / f64::from(outer),
        inside => TURNS - 0.5 * f64::from(inside) / f64::from(INNER),
    };
    let size = libm::pow(GROWTH, turns - TURNS);
    let angle = TAU * turns;
    let (sine, cosine) = (libm::sin(around), libm::cos(around));

    // Ribs fade out on the inner side and towards the tip; cords run along the tube.
    let outside = if inside == 0 { 1.0 } else { 0.0 };
    let rib = libm::sin(angle * 11.0 + 0.5 * sine);
    let rib = rib.max(0.0) * rib.max(0.0) * smooth(-0.75, 0.35, cosine + 0.35 * sine);
    let cord = 0.5 + 0.5 * libm::cos(around * 18.0);
    let shoulder = smooth(0.5, 0.0, (around - 0.95).abs()) + smooth(0.5, 0.0, (around - 0.95 - TAU).abs());
    let grain =
        noise(DVec3::new(libm::cos(angle), 3.0 * turns, libm::sin(angle)) * 2.0 + DVec3::Y * sine, 4, 5);
    let relief = outside * (0.075 * rib + 0.022 * cord + 0.075 * shoulder * (0.4 + rib) + 0.01 * grain);

    // The lip flares a little, then turns in.
    let to_lip = (TURNS - turns) * TAU;
    let flare = 0.13 * smooth(0.55, 0.0, to_lip);
    let thickness = match inside {
        0 => 0.0,
        inside => 0.075 * smooth(0.0, 14.0, f64::from(inside)) + 0.05 * smooth(0.0, 60.0, f64::from(inside)),
    };
    let radius = TUBE * (1.0 + relief + flare - thickness);
    let (out, up) = (OUT + radius * 0.98 * cosine, -DOWN + radius * 1.28 * sine);
    let point = DVec3::new(libm::sin(angle) * out, up, libm::cos(angle) * out) * size;
    (point, color((turns, around, inside), rib, grain))
}

fn color((turns, around, inside): (f64, f64, u32), rib: f64, grain: f64) -> Rgb {
    let cream = rgb(0xf3e4cb);
    let brown = rgb(0x9a5a2e);
    let rose = rgb(0xe8a98d);
    // Flames along the growth lines, in broken bands.
    let flame = libm::sin(TAU * turns * 7.0 + 2.6 * libm::sin(2.0 * around) + 3.0 * grain);
    let band = 0.55 + 0.45 * libm::cos(4.0 * around + 0.6);
    let share = smooth(0.15, 0.75, flame) * band;
    let shell = cream.lerp(brown, 0.85 * share) * (0.93 + 0.07 * grain + 0.06 * rib);
    let tip = smooth(2.5, 0.0, turns);
    let shell = shell.lerp(rgb(0x7d4a3a), 0.7 * tip);
    let lip = smooth(7.35, 7.5, turns);
    let inner = if inside > 0 { 1.0 } else { 0.6 * lip };
    let color = shell.lerp(rose, inner).clamp(DVec3::ZERO, DVec3::ONE);
    color.map(srgb_to_linear).as_vec3()
}
