//! The pressure of two sources of waves in step, on a square sheet that it bends: a structured grid in a binary legacy
//! VTK file, as solvers write it. Also one period of longer waves, as a series of files.

use std::f64::consts::TAU;

/// A moment of the waves on a sheet.
struct Sheet {
    /// Points along each side, from -1 to 1.
    points: u32,
    /// Wave number.
    waves: f64,
    /// Phase in radians.
    phase: f64,
}

/// How fast waves fade with distance.
const FADING: f64 = 1.2;

/// Steps of a period.
pub const STEPS: u32 = 12;

/// The sources on the sheet.
const SOURCES: [[f64; 2]; 2] = [[-0.45, -0.3], [0.4, 0.35]];

/// The height of the sheet where the pressure is 1.
const HEIGHT: f64 = 0.12;

/// The bytes of the file.
pub fn file() -> Vec<u8> {
    Sheet { points: 81, waves: 16.0, phase: 0.0 }.file()
}

/// The bytes of a step of the series.
pub fn step(step: u32) -> Vec<u8> {
    Sheet { points: 41, waves: 9.0, phase: TAU * f64::from(step) / f64::from(STEPS) }.file()
}

/// The list of the series, for times in seconds. Its end is its first step again.
pub fn list() -> String {
    let step = |step: u32| {
        let (time, number) = (f64::from(step) / f64::from(STEPS), step % STEPS);
        format!("    <DataSet timestep=\"{time:.6}\" part=\"0\" file=\"step-{number:02}.vtk\"/>\n")
    };
    let steps: String = (0..=STEPS).map(step).collect();
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n  <Collection>\n{steps}  </Collection>\n</VTKFile>\n"
    )
}

impl Sheet {
    fn file(&self) -> Vec<u8> {
        let points = self.points;
        let pressure = |x, z| self.pressure(x, z);
        let at = |step: u32| 2.0 * f64::from(step) / f64::from(points - 1) - 1.0;
        let grid: Vec<[f64; 2]> =
            (0..points).flat_map(|z| (0..points).map(move |x| [at(x), at(z)])).collect();
        let count = grid.len();
        let mut bytes = format!(
            "# vtk DataFile Version 3.0\npressure of two sources\nBINARY\nDATASET STRUCTURED_GRID\n\
         DIMENSIONS {points} {points} 1\nPOINTS {count} float\n"
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
    fn pressure(&self, x: f64, z: f64) -> f64 {
        let of = |[sx, sz]: [f64; 2]| {
            let distance = ((x - sx) * (x - sx) + (z - sz) * (z - sz)).sqrt();
            libm::cos(self.waves * distance - self.phase) * libm::exp(-FADING * distance)
        };
        SOURCES.into_iter().map(of).sum()
    }
}
