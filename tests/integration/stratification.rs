//! Samples of a pixel are drawn so that they complete each other, in every pixel: no column, ring or point of a picture
//! is noisier than its surroundings because a frame of reference jumps or spins there.

use crate::support::{sequence, shoot};
use kinora::sequence::Sequence;

/// Width and height of the pictures.
const SIDE: usize = 21;

/// Pictures whose errors are measured.
const SEEDS: u32 = if cfg!(debug_assertions) { 12 } else { 48 };

/// The variance of every pixel over pictures with different seeds.
fn variances(sequence: &Sequence, samples: u32) -> Vec<f64> {
    let mut sequence = sequence.clone();
    sequence.quality.samples = samples;
    let (mut sums, mut squares) = (vec![0.0; SIDE * SIDE], vec![0.0; SIDE * SIDE]);
    for seed in 0..SEEDS {
        sequence.quality.seed = seed;
        let film = shoot(&sequence, [0]).remove(0).film;
        for (index, pixel) in film.radiance().enumerate() {
            let value = f64::from(pixel.x);
            sums[index] += value;
            squares[index] += value * value;
        }
    }
    let n = f64::from(SEEDS);
    sums.iter().zip(squares).map(|(sum, square)| (square - sum * sum / n) / (n - 1.0)).collect()
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / count
}

/// The largest error of a line of pixels as a multiple of that of the lines two to four pixels away.
fn worst_line(variances: &[f64], at: impl Fn(usize, usize) -> usize) -> f64 {
    let lines: Vec<_> =
        (0..SIDE).map(|line| mean((0..SIDE).map(|across| variances[at(line, across)]))).collect();
    let ratio = |line: usize| {
        let near = (0..SIDE).filter(|&other| (2..=4).contains(&line.abs_diff(other)));
        (lines[line] / mean(near.map(|other| lines[other]))).sqrt()
    };
    (0..SIDE).map(ratio).fold(0.0, f64::max)
}

/// The largest error of a pixel as a multiple of that of the pixels around it.
fn worst_pixel(variances: &[f64]) -> f64 {
    let ratio = |x: usize, y: usize| {
        let around = (0..SIDE * SIDE).filter(|&other| {
            let away = x.abs_diff(other % SIDE).max(y.abs_diff(other / SIDE));
            (2..=4).contains(&away)
        });
        (variances[y * SIDE + x] / mean(around.map(|other| variances[other]))).sqrt()
    };
    (0..SIDE * SIDE).map(|index| ratio(index % SIDE, index / SIDE)).fold(0.0, f64::max)
}

/// A picture of some fields of a sequence. One that sees light after one bounce, without roulette.
fn pictured(fields: &str, bounces: u32) -> Sequence {
    sequence(&format!(
        "(output: (size: ({SIDE}, {SIDE})), quality: (integrator: Path(roulette: Off), bounces: {bounces}), ambient: 0,
        {fields})"
    ))
}

/// Samples of a pixel.
const FEW: [u32; 2] = [16, 64];

const SKY: &str = "background: Gradient(bottom: 0, top: 2, up: (0, 1, 0.4))";

/// No line of pixels stands out, and no pixel by more than what its error is known to.
#[track_caller]
fn assert_even(name: &str, sequence: &Sequence, samples: &[u32]) {
    for &samples in samples {
        let variances = variances(sequence, samples);
        let columns = worst_line(&variances, |x, y| y * SIDE + x);
        let rows = worst_line(&variances, |y, x| y * SIDE + x);
        assert!(columns <= 1.5 && rows <= 1.5, "{name}: {samples} samples: {columns} {rows}");
        // The error of a variance over so few pictures is large: 3.5 standard deviations for the worst of all pixels.
        let certain = 1.5 * (1.0 + 3.5 * (2.0 / f64::from(SEEDS - 1)).sqrt()).sqrt();
        let pixel = worst_pixel(&variances);
        assert!(pixel <= certain, "{name}: {samples} samples: a pixel stands out by {pixel}");
    }
}

/// A matt ball, whose normals lead along each axis of space somewhere, seen along and across these.
#[test]
fn matt_balls_have_no_seam() {
    let seen = |eye: &str, up: &str, projection: &str, samples: &[u32]| {
        let fields = format!(
            "{SKY}, camera: (position: {eye}, up: {up}, projection: {projection}),
            objects: {{ \"ball\": (shape: Sphere(), material: Lambertian(color: 0.5)) }}"
        );
        assert_even(&format!("ball from {eye} by {projection}"), &pictured(&fields, 1), samples);
    };
    seen("(5, 0, 0)", "(0, 1, 0)", "Perspective(fov: 2)", &[16, 64, 256, 1024]);
    for eye in ["(0, 0, 5)", "(0, 5, 0)", "(0, 0, -5)", "(-3, 3, 3)"] {
        seen(eye, "(0, 0.8, 0.6)", "Perspective(fov: 12)", &FEW);
    }
    seen("(0, 0, -5)", "(0, 1, 0)", "Orthographic(height: 1)", &FEW);
    seen("(5, 0, 0)", "(0, 1, 0)", "Orthographic(height: 0.1)", &FEW);
}

/// What is seen by a mirror or through glass is drawn as what is seen directly, on the mirror's axis as well.
#[test]
fn reflections_and_glass_have_no_seam() {
    let ball = "\"ball\": (shape: Sphere(), material: Lambertian(color: 0.5))";
    // The eye looks straight into a mirror, and sees the side of the ball that is turned away from it.
    let mirror = format!(
        "{SKY}, camera: (position: (0, 0, 3), target: (0, 0, 6), projection: Perspective(fov: 4)), objects: {{ {ball},
        \"mirror\": (shape: Rectangle(corner: (-9, -9, 6), u: (18, 0, 0), v: (0, 18, 0)), material: Metal(color: 1)) }}"
    );
    assert_even("ball in a mirror", &pictured(&mirror, 2), &FEW);
    // Over an edge, so that the picture is not upright.
    let askew = format!(
        "{SKY}, camera: (position: (4, 0, 0), target: (4, 0, -4), up: (0.3, 1, 0), projection: Perspective(fov: 3)), objects: {{ {ball},
        \"mirror\": (shape: Plane(point: (4, 0, -4), normal: (-0.7, 0, 0.7)), material: Metal(color: 1)) }}"
    );
    assert_even(
        "ball around a corner",
        &pictured(&askew.replace("shape: Sphere()", "shape: Sphere(center: (0, 0, -4))"), 2),
        &FEW,
    );
    let glass = format!(
        "{SKY}, camera: (position: (0, 0, 6), projection: Perspective(fov: 2)), objects: {{ {ball},
        \"pane\": (shape: Box(min: (-9, -9, 3), max: (9, 9, 3.5)), material: (ambient: 0, diffuse: 0, refraction: 1, ior: 1.5, fresnel: Off)) }}"
    );
    assert_even("ball behind glass", &pictured(&glass, 3), &FEW);
    let sheet = glass.replace("refraction: 1, ior: 1.5, fresnel: Off", "transparency: 1");
    assert_even("ball behind a sheet", &pictured(&sheet, 1), &FEW);
}

/// Flat ground up to the horizon.
#[test]
fn ground_has_no_seam() {
    let ground = format!(
        "{SKY}, camera: (position: (0, 1, 0), target: (0, 0.95, -1), projection: Perspective(fov: 4)),
        objects: {{ \"ground\": (shape: Plane(), material: Lambertian(color: 0.5)) }}"
    );
    assert_even("ground", &pictured(&ground, 1), &FEW);
}

/// Directions to a round light are drawn around that to its centre, which leads along each axis somewhere.
#[test]
fn light_of_spheres_has_no_seam() {
    let lit = |light: &str, objects: &str| {
        let wall =
            "\"wall\": (shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: Lambertian(color: 0.5))";
        let screen = "\"screen\": (shape: Rectangle(corner: (-9, -0.2, 1), u: (9.4, 0, 0), v: (1, 9, 0)), material: Lambertian(color: 0))";
        format!(
            "background: 0, camera: (position: (0.3, 0.2, 0.9), target: (0, 0, 0), projection: Perspective(fov: 12)),
            {light} objects: {{ {wall}, {screen} {objects} }}"
        )
    };
    let light = lit("lights: { \"l\": Sphere(center: (0, 0, 3), radius: 1, intensity: 4) },", "");
    assert_even("wall before a light", &pictured(&light, 1), &FEW);
    let lamp = lit(
        "",
        ", \"lamp\": (shape: Sphere(center: (0, 0, 3)), material: (color: 1, ambient: 0, diffuse: 0, emission: 4))",
    );
    assert_even("wall before a lamp", &pictured(&lamp, 1), &FEW);
    let sideways = light.replace("(0, 0, 3)", "(2.5, 0, 1.4)");
    assert_even("wall beside a light", &pictured(&sideways, 1), &FEW);
}

/// Rough metal draws around the eye's direction in the frame as well, which is the normal's somewhere.
#[test]
fn rough_metal_has_no_seam() {
    for roughness in [0.2, 0.8] {
        for eye in ["(5, 0, 0)", "(-3, 3, 3)"] {
            let metal = format!(
                "{SKY}, camera: (position: {eye}, projection: Perspective(fov: 3)), objects: {{
                \"ball\": (shape: Sphere(), material: MetallicRoughness(color: 0.8, metallic: 1, roughness: {roughness})) }}"
            );
            assert_even(&format!("metal of roughness {roughness} from {eye}"), &pictured(&metal, 1), &FEW);
        }
        let fuzzy = format!(
            "{SKY}, camera: (position: (5, 0, 0), projection: Perspective(fov: 3)),
            objects: {{ \"ball\": (shape: Sphere(), material: Metal(color: 0.8, fuzz: {roughness})) }}"
        );
        assert_even(&format!("metal of fuzz {roughness}"), &pictured(&fuzzy, 1), &FEW);
    }
}
