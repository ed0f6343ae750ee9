//! The drops of a fountain, as a solver of equations of motion writes them: one row per time and drop.

use std::f64::consts::TAU;
use std::fmt::Write;

/// Drops per second, and seconds of the whole table.
const RATE: f64 = 60.0;
const SECONDS: u32 = 3;

/// Rows per second.
const ROWS: u32 = 20;

/// Gravity, in lengths per second squared.
const GRAVITY: f64 = 9.81;

/// The golden section spreads directions evenly.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// The text of the table.
pub fn table() -> String {
    let mut text = "t,id,x,y,z,r,speed\n".to_owned();
    for row in 0..=ROWS * SECONDS {
        let time = f64::from(row) / f64::from(ROWS);
        // The fountain has been on for longer than any drop flies.
        for number in 0..(RATE * f64::from(SECONDS + 2)) as u32 {
            let age = time + 2.0 - f64::from(number) / RATE;
            if let Some([x, y, z, radius, speed]) = drop_at(number, age) {
                // Writing to a text does not fail.
                let _ = writeln!(text, "{time},{number},{x:.4},{y:.4},{z:.4},{radius:.3},{speed:.3}");
            }
        }
    }
    text
}

/// Place, radius and speed of a drop at an age; none before it leaves the nozzle and after it has fallen into the basin.
fn drop_at(number: u32, age: f64) -> Option<[f64; 5]> {
    let share = |factor: f64| (f64::from(number) * factor).fract();
    let (azimuth, lean) = (TAU * share(GOLDEN), 0.08 + 0.22 * share(GOLDEN * GOLDEN));
    let start = 6.0 + 1.2 * share(0.37);
    let (across, up) = (start * libm::sin(lean), start * libm::cos(lean));
    let (height, fall) = (0.3 + up * age - 0.5 * GRAVITY * age * age, up - GRAVITY * age);
    let is_flying = age >= 0.0 && height >= 0.0;
    let reach = across * age;
    let radius = 0.028 + 0.03 * share(0.71);
    let speed = (across * across + fall * fall).sqrt();
    is_flying.then(|| [reach * libm::cos(azimuth), height, reach * libm::sin(azimuth), radius, speed])
}
