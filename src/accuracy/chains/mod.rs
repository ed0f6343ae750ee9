//! Finds the light paths that cause the noise of the worst pixels.
//!
//! A small path tracer with simplified sampling and one colour channel records the chain of materials along each path
//! from the camera to a light. The chains that contribute most of the variance of the worst pixels cause the
//! fireflies. Only fractions of the variance are reported, never radiance.

mod recorder;
mod vertex;

use super::renderer::Renderer;
use super::robustness::SceneRays;
use crate::base::math::DVec2;
use crate::sequence::Sequence;
use crate::sequence::quality::Quality;
use rayon::prelude::*;
use recorder::{PathRecorder, PathSampler};
use std::collections::BTreeMap;
use vertex::PathVertex;

/// The materials and the light along a path from the camera, and the path's fraction of the variance in the worst
/// pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// The names along the path, such as `wall → glass (refracted) → ceiling lamp`.
    pub path: String,
    pub share: f64,
    /// Whether the light is directly visible. Then the noise comes from an edge, not from a rare path.
    pub direct: bool,
}

/// The largest number of pixels that are examined.
const PIXELS: usize = 48;
/// Paths per pixel.
const PATHS: u32 = 2048;
/// The largest number of reported chains.
const MAX_CHAINS: usize = 5;

/// By chain, the sum and the sum of squares of its contributions to the paths of a pixel.
type Moments = BTreeMap<Vec<PathVertex>, (f64, f64)>;

/// The chains that contribute most of the variance of the worst pixels of the first frame. `errors` are the squared
/// errors of all pixels.
pub fn chains(renderer: &Renderer, sequence: &Sequence, quality: &Quality, errors: &[f64]) -> Vec<Chain> {
    let size = renderer.size();
    let found = renderer.scene(|scene| {
        let rays = SceneRays::new(scene);
        let recorder = PathRecorder::new(&rays, quality.bounces);
        let pixels = worst(&errors[..errors.len().min((size.0 * size.1) as usize)]);
        let of = |&pixel: &u32| record_pixel(&recorder, pixel, size);
        renderer.install(|| pixels.par_iter().map(of).collect::<Vec<Moments>>())
    });
    // Chains with the same names count as one.
    let mut variances: BTreeMap<(String, bool), f64> = BTreeMap::new();
    let paths = f64::from(PATHS);
    for (chain, (sum, squares)) in found.into_iter().flatten().flatten() {
        let mean = sum / paths;
        *variances.entry((chain_name(sequence, &chain), chain.len() == 1)).or_default() +=
            (squares / paths - mean * mean).max(0.0);
    }
    let whole: f64 = variances.values().sum();
    let mut all: Vec<((String, bool), f64)> = variances.into_iter().collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    let reported = all.into_iter().filter(|(_, variance)| *variance > 0.0).take(MAX_CHAINS);
    reported.map(|((path, direct), variance)| Chain { path, share: variance / whole, direct }).collect()
}

/// The pixels with the largest errors, in descending order.
fn worst(errors: &[f64]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..errors.len() as u32).collect();
    order.sort_by(|&a, &b| errors[b as usize].total_cmp(&errors[a as usize]));
    order.truncate(PIXELS);
    order.retain(|&pixel| errors[pixel as usize] > 0.0);
    order
}

fn record_pixel(recorder: &PathRecorder, pixel: u32, size: (u32, u32)) -> Moments {
    let mut moments = Moments::new();
    for path in 0..PATHS {
        let mut sampler = PathSampler::new(pixel, path);
        let jitter = DVec2::new(sampler.next(), sampler.next());
        let mut added: BTreeMap<Vec<PathVertex>, f64> = BTreeMap::new();
        recorder.follow((pixel % size.0, pixel / size.0), size, jitter, &mut sampler, &mut |chain, light| {
            *added.entry(chain.to_vec()).or_default() += light;
        });
        for (chain, light) in added {
            let (sum, squares) = moments.entry(chain).or_default();
            *sum += light;
            *squares += light * light;
        }
    }
    moments
}

/// The names of a chain; equal neighbours are merged.
fn chain_name(sequence: &Sequence, chain: &[PathVertex]) -> String {
    let material = |index: u32| {
        let name = sequence.materials.get(index as usize).map_or("?", |material| material.name.as_str());
        // An inline material has the name of its object.
        let inline = name.strip_prefix("objects.\"").and_then(|name| name.strip_suffix("\".material"));
        inline.unwrap_or(name).to_owned()
    };
    let mut names: Vec<String> = chain
        .iter()
        .map(|vertex| match vertex {
            PathVertex::Surface(index, way) => material(*index) + way.name(),
            PathVertex::Light(index) => {
                sequence.lights.get(*index as usize).map_or("?".to_owned(), |light| light.name.clone())
            }
            PathVertex::Background => "background".to_owned(),
            PathVertex::Emission(index) => material(*index) + " (emission)",
        })
        .collect();
    names.dedup();
    match names.as_slice() {
        [light] => format!("{light}, seen directly"),
        names => names.join(" → "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::parse;

    #[test]
    fn fireflies_of_a_glass_ball_come_by_way_of_the_glass() {
        let text = r#"(
            timeline: (frames: 1), output: (size: (48, 27)),
            quality: (integrator: Path(), bounces: 5, samples: 16),
            camera: (position: (0, 1.5, 5), target: (0, 0.7, 0)),
            lights: { "lamp": Sphere(center: (0.5, 2.6, 0), radius: 0.05, intensity: 100) },
            default_material: (ambient: 0),
            materials: { "wall": Lambertian(color: 0.8), "glass": Dielectric() },
            objects: {
                "floor": (shape: Rectangle(corner: (-3, 0, 3), u: (6, 0, 0), v: (0, 0, -6)), material: "wall"),
                "back": (shape: Rectangle(corner: (-3, 0, -2), u: (6, 0, 0), v: (0, 3, 0)), material: "wall"),
                "ball": (shape: Sphere(center: (0, 0.6, 0), radius: 0.5), material: "glass"),
            },
        )"#;
        let sequence = parse("test.ron", text).expect("a sequence");
        let renderer = Renderer::new(&sequence, &[0], None).expect("a renderer");
        // On the floor, left and right of the ball's foot.
        let mut errors = vec![0.0; 48 * 27];
        [(19, 18), (20, 19), (28, 19), (30, 18)].iter().for_each(|(x, y)| errors[y * 48 + x] = 1.0);
        let found = chains(&renderer, &sequence, &sequence.quality, &errors);
        let by_glass =
            |chain: &Chain| chain.path.contains("glass (refracted)") && chain.path.ends_with("lamp");
        assert!(found.iter().any(by_glass), "{found:?}");
        assert!(found.windows(2).all(|pair| pair[0].share >= pair[1].share), "{found:?}");
        let names: std::collections::BTreeSet<_> = found.iter().map(|chain| &chain.path).collect();
        assert_eq!(names.len(), found.len(), "{found:?}");
        assert_eq!(found, chains(&renderer, &sequence, &sequence.quality, &errors), "the same every time");
    }
}
