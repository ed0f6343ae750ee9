//! The pressure of two sources of waves in step, on a square sheet that it bends: a structured grid in a binary legacy
//! VTK file, as solvers write it.

/// Points along each side of the sheet, from -1 to 1.
const POINTS: u32 = 81;

/// Wave number, and how fast waves fade with distance.
const WAVES: f64 = 16.0;
const FADING: f64 = 1.2;

/// The sources on the sheet.
const SOURCES: [[f64; 2]; 2] = [[-0.45, -0.3], [0.4, 0.35]];

/// The height of the sheet where the pressure is 1.
const HEIGHT: f64 = 0.12;

/// The bytes of the file.
pub fn file() -> Vec<u8> {
    let at = |step: u32| 2.0 * f64::from(step) / f64::from(POINTS - 1) - 1.0;
    let grid: Vec<[f64; 2]> = (0..POINTS).flat_map(|z| (0..POINTS).map(move |x| [at(x), at(z)])).collect();
    let count = grid.len();
    let mut bytes = format!(
        "# vtk DataFile Version 3.0\npressure of two sources\nBINARY\nDATASET STRUCTURED_GRID\n\
         DIMENSIONS {POINTS} {POINTS} 1\nPOINTS {count} float\n"
    )
    .into_bytes();
    let mut push = |value: f64| bytes.extend((value as f32).to_be_bytes());
    // Rows follow -z, so that faces are seen from above counter-clockwise.
    for &[x, z] in &grid {
        [x, HEIGHT * pressure(x, -z), -z].into_iter().for_each(&mut push);
    }
    bytes.extend(format!("\nPOINT_DATA {count}\nSCALARS pressure float\nLOOKUP_TABLE default\n").bytes());
    grid.iter().for_each(|&[x, z]| bytes.extend((pressure(x, -z) as f32).to_be_bytes()));
    bytes.push(b'\n');
    bytes
}

/// The sum of both sources.
fn pressure(x: f64, z: f64) -> f64 {
    let of = |[sx, sz]: [f64; 2]| {
        let distance = ((x - sx) * (x - sx) + (z - sz) * (z - sz)).sqrt();
        libm::cos(WAVES * distance) * libm::exp(-FADING * distance)
    };
    SOURCES.into_iter().map(of).sum()
}
