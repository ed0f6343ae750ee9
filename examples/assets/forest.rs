//! The trees of a forest on a disk: places, turns about the vertical axis and sizes.

use std::f64::consts::{PI, TAU};
use std::fmt::Write;

/// The number of trees.
const TREES: u32 = 160;

/// The radius of the disk.
const RADIUS: f64 = 9.0;

/// The turn from one tree to the next in radians: the golden angle, which leaves no rows.
const TURN: f64 = 2.399_963_229_728_653;

/// The text of the table.
pub fn table() -> String {
    let mut text = "x,y,z,qw,qx,qy,qz,width,height\n".to_owned();
    for number in 0..TREES {
        let share = |factor: f64| (f64::from(number) * factor).fract();
        // A clearing in the middle.
        let distance = RADIUS * (0.06 + 0.94 * (f64::from(number) + 0.5) / f64::from(TREES)).sqrt();
        let azimuth = TURN * f64::from(number) + 0.3 * share(0.37);
        let (x, z) = (distance * libm::cos(azimuth), distance * libm::sin(azimuth));
        let half = 0.5 * TAU * share(0.618) - 0.5 * PI;
        let (width, height) = (0.8 + 0.5 * share(0.71), 1.3 + 1.2 * share(0.29));
        let (w, y) = (libm::cos(half), libm::sin(half));
        // Writing to a text does not fail.
        let _ = writeln!(text, "{x:.4},0,{z:.4},{w:.6},0,{y:.6},0,{width:.3},{height:.3}");
    }
    text
}
