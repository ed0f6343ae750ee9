//! The same sequence somewhere else, and of another size: the same picture. Camera, lights and objects move together;
//! seeds are locked.

use crate::support::shoot_all;
use kinora::base::color::Rgb;
use kinora::base::math::DVec3;

/// All that there is, at a place and of a size: every shape, a mesh, mirrors, glass, patterns and lights.
fn scene(integrator: &str, at: DVec3, size: f64, lens: bool) -> Vec<Rgb> {
    let place = |x: f64, y: f64, z: f64| {
        let p = at + DVec3::new(x, y, z) * size;
        format!("({:?}, {:?}, {:?})", p.x, p.y, p.z)
    };
    let length = |length: f64| format!("{:?}", length * size);
    let (eye, target) = (place(1.0, 3.0, 8.0), place(0.0, 0.6, 0.0));
    let lens =
        if lens { format!(", aperture: {}, focus: {}", length(0.2), length(8.0)) } else { String::new() };
    let text = format!(
        "(output: (size: (40, 30)), background: Gradient(),
        quality: (integrator: {integrator}, samples: 4, seed: 5, bounces: 4, antialias: 2),
        camera: (position: {eye}, target: {target}{lens}),
        lights: {{ \"point\": Point(position: {}), \"sun\": Directional(direction: (-1, -3, -2), intensity: 0.5) }},
        fog: (color: 0.5, density: {:?}),
        objects: {{
            \"all\": (shape: Group, translation: {}, scale: {size:?}),
            \"floor\": (shape: Plane(), material: (color: Checker(), mirror: 0.2), parent: \"all\"),
            \"ball\": (shape: Sphere(center: (-1, 1, 0)), material: (mirror: 0.6, specular: 0.5), parent: \"all\"),
            \"egg\": (shape: Sphere(), scale: (0.4, 0.7, 0.4), translation: (0.6, 0.7, 1.5), parent: \"all\",
                material: Dielectric()),
            \"box\": (shape: Box(min: (-0.5, 0, -0.5), max: (0.5, 1, 0.5)), translation: (1.6, 0, -0.5),
                rotation: Euler(y: 30), parent: \"all\", material: (color: Marble())),
            \"can\": (shape: Cylinder(from: (0, 0, 0), to: (0, 0.8, 0), radius: 0.3), translation: (-2.4, 0, 1.2),
                parent: \"all\"),
            \"tip\": (shape: Cone(radius: 0.5), translation: (2.6, 0, 1), scale: (1, 1.5, 0.6), parent: \"all\"),
            \"ring\": (shape: Torus(major: 0.5, minor: 0.2), translation: (-0.4, 0.2, 2.4), parent: \"all\"),
            \"gem\": (shape: Mesh(vertices: [(0, 1, 0), (0.5, 0.4, 0.5), (0.5, 0.4, -0.5), (-0.5, 0.4, -0.5),
                (-0.5, 0.4, 0.5), (0, 0, 0)], triangles: [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 1), (5, 2, 1),
                (5, 3, 2), (5, 4, 3), (5, 1, 4)], normals: Smooth), translation: (0.6, 0, -2), parent: \"all\"),
            \"card\": (shape: Disk(normal: (1, 2, 3), radius: 0.4), translation: (-2.4, 1.6, -1), parent: \"all\"),
        }})",
        place(4.0, 6.0, 5.0),
        0.02 / size,
        place(0.0, 0.0, 0.0),
    );
    shoot_all(&text)[0].film.radiance().collect()
}

/// The largest and the mean difference of two pictures.
fn differences(a: &[Rgb], b: &[Rgb]) -> (f32, f32) {
    let off: Vec<f32> = a.iter().zip(b).map(|(a, b)| (*a - *b).abs().max_element()).collect();
    (off.iter().copied().fold(0.0, f32::max), off.iter().sum::<f32>() / off.len() as f32)
}

/// A million units away, coordinates are known to 1.2e-10: what is lit changes by about as much, and a sample whose ray
/// passes that near an edge may fall to the other side of it. Of 1200 pixels with 4 samples none should.
#[test]
fn pictures_stay_when_all_is_moved_by_a_million() {
    for integrator in ["Whitted", "Path(roulette: Off)"] {
        let here = scene(integrator, DVec3::ZERO, 1.0, false);
        assert!(here.iter().all(|pixel| pixel.is_finite()));
        for at in [DVec3::new(1e6, -1e6, 1e6), DVec3::new(-1e6, 0.0, 0.0), DVec3::new(1e3, 2e5, -7e5)] {
            let (most, mean) = differences(&here, &scene(integrator, at, 1.0, false));
            assert!(most <= 1e-6 && mean <= 1e-8, "{integrator} at {at}: {most:e}, in the mean {mean:e}");
        }
    }
}

/// A thousand times as large or as small, coordinates have other last digits, and no fewer.
#[test]
fn pictures_stay_when_all_is_scaled() {
    for (integrator, lens) in [("Whitted", false), ("Path(roulette: Off)", false), ("Path", true)] {
        let here = scene(integrator, DVec3::ZERO, 1.0, lens);
        for size in [1e-3, 1e3, 1e-6, 1e6, 1e-12, 1e12] {
            let (most, mean) = differences(&here, &scene(integrator, DVec3::ZERO, size, lens));
            assert!(
                most <= 1e-6 && mean <= 1e-8,
                "{integrator} times {size}: {most:e}, in the mean {mean:e}"
            );
        }
    }
}

/// Powers of two move no digit: the same bits.
#[test]
fn pictures_are_the_same_bits_when_all_is_scaled_by_powers_of_two() {
    for integrator in ["Whitted", "Path"] {
        let here = scene(integrator, DVec3::ZERO, 1.0, true);
        for exponent in [-40.0, -10.0, -1.0, 1.0, 10.0, 40.0] {
            let there = scene(integrator, DVec3::ZERO, libm::exp2(exponent), true);
            assert!(here == there, "{integrator} times 2^{exponent}: {:?}", differences(&here, &there));
        }
    }
}
