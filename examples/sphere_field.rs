//! Writes a sequence of some 480 small spheres around three large ones:
//!
//! ```text
//! cargo run --release --example sphere_field -- orbit sequences/field-orbit.ron
//! cargo run --release --example sphere_field -- moves sequences/field-moves.ron
//! ```
//!
//! The small ones stand on a grid of pitch 1, one in every cell of a round field, each moved by up to a quarter
//! along both axes. Their radii are a quarter at most, so no two of them overlap; those that would touch a large
//! one are left out. All random numbers come from one generator with a fixed start: every run writes the
//! same bytes.

use std::error::Error;
use std::fmt::{self, Write};

/// Distance from the middle within which cells have a sphere.
const FIELD: f64 = 12.4;

/// Free way between small spheres and large ones, at least.
const GAP: f64 = 0.04;

/// Where the large spheres stand, of radius 1.
const LARGE: [(f64, f64); 3] = [(0.0, 1.7), (-1.5, -0.85), (1.5, -0.85)];

/// Colours of paper and of metal, linear.
const PAPER: [[f64; 3]; 7] = [
    [0.72, 0.10, 0.06],
    [0.80, 0.33, 0.05],
    [0.82, 0.60, 0.12],
    [0.10, 0.42, 0.20],
    [0.04, 0.35, 0.45],
    [0.08, 0.16, 0.50],
    [0.80, 0.76, 0.68],
];
const METAL: [[f64; 3]; 4] = [[0.90, 0.91, 0.92], [0.95, 0.76, 0.42], [0.93, 0.58, 0.45], [0.62, 0.70, 0.82]];

const ORBIT: &str = r##"// About 480 small spheres around three large ones under an open sky. The camera orbits them once. Meanwhile its lens
// opens, so the field blurs in front of and behind the glass ball, and closes again.
//
//     kinora render sequences/field-orbit.ron
//
// A program writes this file; the spheres are random:
//
//     cargo run --release --example sphere_field -- orbit sequences/field-orbit.ron
(
    timeline: (frames: 48, fps: 12, keys: Frames),
    output: (size: (480, 270)),

    // Path tracing with up to 8 bounces and 48 samples per pixel.
    quality: (integrator: Path, bounces: 8, samples: 48),
    background: Gradient(), // white below to light blue above: the only light

    camera: (
        position: (0, 2.6, 11.5),
        target: (0, 0.6, 0),
        projection: Perspective(fov: 28),
        path: Orbit(),
        // Diameter of the lens. The glass ball stays sharp.
        aperture: [(0, 0, Smooth), (24, 0.45, Smooth), (48, 0)],
        focus: "glass",
    ),

"##;

const MOVES: &str = r##"// The field of field-orbit.ron and the moves of a camera, one after the other: it steps closer, narrows its field of
// view, looks up and down, and opens its lens.
//
//     kinora render sequences/field-moves.ron
//
// A program writes this file; the spheres are random:
//
//     cargo run --release --example sphere_field -- moves sequences/field-moves.ron
(
    timeline: (frames: 72, fps: 12, keys: Frames),
    output: (size: (480, 270)),
    quality: (integrator: Path, bounces: 8, samples: 32),
    background: Gradient(),

    camera: (
        // Closer until frame 14.
        position: [(2, (0.6, 2.4, 13), Smooth), (14, (0.4, 1.6, 7.5))],
        // Up and down from 30 to 54: the target moves, the camera does not.
        target: [(30, (0, 0.8, 0), Smooth), (38, (0, 2.4, 0), Smooth), (46, (0, -0.8, 0), Smooth), (54, (0, 0.8, 0))],
        // A narrower view from 16 to 28.
        projection: Perspective(fov: [(16, 40, Smooth), (28, 24)]),
        // The lens opens from 56 to 68. The glass ball stays sharp.
        aperture: [(56, 0, Smooth), (68, 0.4)],
        focus: "glass",
    ),

"##;

const SCENE: &str = r##"    objects: {
        "ground": (shape: Plane(), material: Lambertian(color: (0.5, 0.47, 0.42))),
        "glass": (shape: Sphere(center: (0, 1, 1.7)), material: Dielectric(ior: 1.5, fresnel: Schlick)),
        "paper": (shape: Sphere(center: (-1.5, 1, -0.85)), material: Lambertian(color: (0.62, 0.12, 0.06))),
        "metal": (shape: Sphere(center: (1.5, 1, -0.85)), material: Metal(color: (0.85, 0.78, 0.68))),

"##;

/// splitmix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    /// Evenly in 0..1.
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.unit()
    }

    fn one_of<T: Copy, const N: usize>(&mut self, all: [T; N]) -> T {
        all[(self.unit() * N as f64) as usize]
    }
}

/// Whether a sphere on the ground is clear of the large ones: the distance of their centres, across and up,
/// exceeds the sum of their radii by the gap.
fn is_free(x: f64, z: f64, radius: f64, gap: f64) -> bool {
    let apart = 1.0 + radius + gap;
    LARGE.iter().all(|(a, b)| {
        let (across, along, up) = (x - a, z - b, 1.0 - radius);
        across * across + along * along + up * up > apart * apart
    })
}

/// A material: two of three are paper, one of four is metal, and the rest is glass.
fn material(random: &mut Random) -> String {
    let kind = random.unit();
    let shade = random.between(0.6, 1.0);
    if kind < 0.66 {
        return format!("Lambertian(color: {})", shown(random.one_of(PAPER), shade));
    }
    if kind < 0.91 {
        let color = shown(random.one_of(METAL), 0.75 + 0.25 * shade);
        // Every second one is polished.
        let fuzz = (random.between(-0.4, 0.4)).max(0.0);
        return format!("Metal(color: {color}, fuzz: {fuzz:.2})");
    }
    "Dielectric(fresnel: Schlick)".to_owned()
}

fn shown(color: [f64; 3], shade: f64) -> String {
    let [r, g, b] = color.map(|channel| channel * shade);
    format!("({r:.3}, {g:.3}, {b:.3})")
}

/// The small spheres, a line each.
fn small_spheres(text: &mut String) -> fmt::Result {
    let mut random = Random(20);
    let mut count = 0;
    for row in -13i8..=13 {
        for column in -13i8..=13 {
            let (x, z) = (f64::from(column), f64::from(row));
            let [x_off, z_off, size] = [(); 3].map(|()| random.unit());
            let material = material(&mut random);
            let radius = 0.15 + 0.1 * size * size;
            let (near_x, near_z) = (x + 0.5 * x_off - 0.25, z + 0.5 * z_off - 0.25);
            if x * x + z * z > FIELD * FIELD || !is_free(near_x, near_z, radius, GAP) {
                continue;
            }
            count += 1;
            write!(
                text,
                "        \"{count}\": (shape: Sphere(center: ({near_x:.3}, {radius:.3}, {near_z:.3}), "
            )?;
            writeln!(text, "radius: {radius:.3}), material: {material}),")?;
        }
    }
    Ok(())
}

fn sequence(head: &str) -> Result<String, fmt::Error> {
    let mut text = format!("{head}{SCENE}");
    small_spheres(&mut text)?;
    text.push_str("    },\n)\n");
    Ok(text)
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let arguments: Vec<_> = arguments.iter().map(String::as_str).collect();
    let (head, name) = match arguments[..] {
        ["orbit", name] => (ORBIT, name),
        ["moves", name] => (MOVES, name),
        _ => return Err("usage: sphere_field orbit|moves FILE".into()),
    };
    std::fs::write(name, sequence(head)?)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sequences_are_as_written_here() {
        for (head, file) in [
            (ORBIT, include_str!("../sequences/field-orbit.ron")),
            (MOVES, include_str!("../sequences/field-moves.ron")),
        ] {
            assert!(sequence(head).expect("a text") == file, "write the files again");
        }
    }

    #[test]
    fn spheres_stand_apart() {
        let mut text = String::new();
        small_spheres(&mut text).expect("a text");
        let number = |part: &str| part.parse::<f64>().expect("a number");
        let spheres: Vec<[f64; 3]> = text
            .lines()
            .map(|line| {
                let inner = line.split("center: (").nth(1).and_then(|rest| rest.split(')').next());
                let parts: Vec<f64> = inner.expect("a centre").split(", ").map(number).collect();
                [parts[0], parts[1], parts[2]]
            })
            .collect();
        assert!((460..=484).contains(&spheres.len()), "{} spheres", spheres.len());
        for (index, [x, radius, z]) in spheres.iter().enumerate() {
            assert!(is_free(*x, *z, *radius, 0.0), "{x} {z}");
            for [a, other, b] in &spheres[..index] {
                let (across, along, up) = (x - a, z - b, radius - other);
                let apart = radius + other;
                assert!(across * across + along * along + up * up >= apart * apart, "{x} {z} and {a} {b}");
            }
        }
    }
}
