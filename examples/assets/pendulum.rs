//! A double pendulum, as a solver of equations of motion writes it: poses of both rods over time.

use crate::equations::{State, step};
use std::f64::consts::PI;
use std::fmt::Write;

/// Seconds of motion, and rows per second. Steps of the solver per row.
const SECONDS: u32 = 8;
const RATE: u32 = 60;
const STEPS: u32 = 64;

/// The states at all rows.
fn states() -> impl Iterator<Item = (f64, State)> {
    let h = 1.0 / f64::from(RATE * STEPS);
    let rest = [0.72 * PI, 0.98 * PI, 0.0, 0.0];
    let states = std::iter::successors(Some(rest), move |state| {
        Some((0..STEPS).fold(*state, |state, _| step(state, h)))
    });
    (0..=SECONDS * RATE).map(|row| f64::from(row) / f64::from(RATE)).zip(states)
}

/// The table: the time, the orientation of the upper rod, and position and orientation of the lower one. Rods hang
/// along -y in their own axes and turn about z.
pub fn table() -> String {
    let mut text = String::from("t,upper_w,upper_z,zero,x,y,lower_w,lower_z\n");
    for (t, [a, b, ..]) in states() {
        let half = |angle: f64| (libm::cos(angle * 0.5), libm::sin(angle * 0.5));
        let ((aw, az), (bw, bz)) = (half(a), half(b));
        let (x, y) = (libm::sin(a), -libm::cos(a));
        // Writing to a text does not fail.
        let _ = writeln!(text, "{t:.6},{aw:.6},{az:.6},0,{x:.6},{y:.6},{bw:.6},{bz:.6}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equations::GRAVITY as G;

    fn energy([a, b, u, v]: State) -> f64 {
        u * u + 0.5 * v * v + u * v * libm::cos(a - b) - 2.0 * G * libm::cos(a) - G * libm::cos(b)
    }

    #[test]
    fn energy_is_kept() {
        let all: Vec<_> = states().map(|(_, state)| energy(state)).collect();
        let spread = all.iter().map(|energy| (energy - all[0]).abs()).fold(0.0, f64::max);
        assert!(spread < 1e-6, "{spread}");
    }

    #[test]
    fn the_table_is_up_to_date() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/tables/pendulum.csv");
        assert_eq!(std::fs::read_to_string(path).expect("a table"), table());
    }
}
