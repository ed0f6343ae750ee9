//! Which paths make the noise of the worst pixels: a small path recorder of its own, which tells what each path met.
//!
//! It follows paths as the path integrator does, with simpler samplers and one colour, and records the chain of materials
//! that each met on its way from the camera to a light. The variance that each chain brings to the worst pixels says which of
//! them make fireflies. Only shares are told, never radiance.

mod walk;

use super::robustness::Scenery;
use super::studio::Studio;
use crate::appearance::light::Light;
use crate::base::math::DVec2;
use crate::sequence::Sequence;
use crate::sequence::quality::Quality;
use rayon::prelude::*;
use std::collections::BTreeMap;
use walk::{Numbers, Walk};

/// A chain of what paths met, from the camera on, and its share of the noise in the worst pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// Such as `wall → glass (refracted) → ceiling lamp`.
    pub path: String,
    pub share: f64,
    /// Whether the light is seen directly: then it is no rare path, but an edge.
    pub direct: bool,
}

/// Pixels that are looked at, at most.
const PIXELS: usize = 48;
/// Paths from each.
const PATHS: u32 = 2048;
/// Chains that are told, at most.
const TOLD: usize = 5;

/// A thing on the way, as a number: cheaper to collect than names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Thing {
    /// A material by its index, and what it did with the path.
    Surface(u32, Way),
    /// A light by its index.
    Light(u32),
    Background,
    /// A surface that shines.
    Emission(u32),
}

/// What a surface did with a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Way {
    Scattered,
    Mirrored,
    Glossy,
    Refracted,
    Passed,
}

impl Way {
    fn name(self) -> &'static str {
        match self {
            Self::Scattered => "",
            Self::Mirrored => " (mirrored)",
            Self::Glossy => " (glossy)",
            Self::Refracted => " (refracted)",
            Self::Passed => " (passed)",
        }
    }
}

/// First and second moments of what a chain adds to a path of a pixel.
type Moments = BTreeMap<Vec<Thing>, (f64, f64)>;

/// The chains that bring most of the variance into the worst pixels of the first frame; `errors` are those of all.
pub fn chains(studio: &Studio, sequence: &Sequence, quality: &Quality, errors: &[f64]) -> Vec<Chain> {
    let size = studio.size();
    let found = studio.scene(|scene| {
        let scenery = Scenery::new(scene);
        let walk = Walk::new(&scenery, quality.bounces);
        let pixels = worst(&errors[..errors.len().min((size.0 * size.1) as usize)]);
        let of = |&pixel: &u32| studied(&walk, pixel, size);
        studio.install(|| pixels.par_iter().map(of).collect::<Vec<Moments>>())
    });
    // What has one name counts as one.
    let mut variances: BTreeMap<(String, bool), f64> = BTreeMap::new();
    let paths = f64::from(PATHS);
    for (chain, (sum, squares)) in found.into_iter().flatten().flatten() {
        let mean = sum / paths;
        *variances.entry((named(sequence, &chain), chain.len() == 1)).or_default() +=
            (squares / paths - mean * mean).max(0.0);
    }
    let whole: f64 = variances.values().sum();
    let mut all: Vec<((String, bool), f64)> = variances.into_iter().collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    let told = all.into_iter().filter(|(_, variance)| *variance > 0.0).take(TOLD);
    told.map(|((path, direct), variance)| Chain { path, share: variance / whole, direct }).collect()
}

/// The worst pixels, the worst first.
fn worst(errors: &[f64]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..errors.len() as u32).collect();
    order.sort_by(|&a, &b| errors[b as usize].total_cmp(&errors[a as usize]));
    order.truncate(PIXELS);
    order.retain(|&pixel| errors[pixel as usize] > 0.0);
    order
}

fn studied(walk: &Walk, pixel: u32, size: (u32, u32)) -> Moments {
    let mut moments = Moments::new();
    for path in 0..PATHS {
        let mut numbers = Numbers::new(pixel, path);
        let jitter = DVec2::new(numbers.next(), numbers.next());
        let mut added: BTreeMap<Vec<Thing>, f64> = BTreeMap::new();
        walk.follow((pixel % size.0, pixel / size.0), size, jitter, &mut numbers, &mut |chain, light| {
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

/// What a light gives off, whatever its colour.
fn strength(light: &Light, weight: crate::base::color::Rgb) -> f64 {
    f64::from((light.radiance * weight).max_element())
}

/// A chain in words; what is met twice in a row is told once.
fn named(sequence: &Sequence, chain: &[Thing]) -> String {
    let material = |index: u32| {
        let name = sequence.materials.get(index as usize).map_or("?", |material| material.name.as_str());
        // One that is written in its object is named by its place there.
        let inline = name.strip_prefix("objects.\"").and_then(|name| name.strip_suffix("\".material"));
        inline.unwrap_or(name).to_owned()
    };
    let mut names: Vec<String> = chain
        .iter()
        .map(|thing| match thing {
            Thing::Surface(index, way) => material(*index) + way.name(),
            Thing::Light(index) => {
                sequence.lights.get(*index as usize).map_or("?".to_owned(), |light| light.name.clone())
            }
            Thing::Background => "background".to_owned(),
            Thing::Emission(index) => material(*index) + " (shining)",
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
        let studio = Studio::new(&sequence, &[0], None).expect("a studio");
        // On the floor, left and right of the ball's foot.
        let mut errors = vec![0.0; 48 * 27];
        [(19, 18), (20, 19), (28, 19), (30, 18)].iter().for_each(|(x, y)| errors[y * 48 + x] = 1.0);
        let found = chains(&studio, &sequence, &sequence.quality, &errors);
        let by_glass =
            |chain: &Chain| chain.path.contains("glass (refracted)") && chain.path.ends_with("lamp");
        assert!(found.iter().any(by_glass), "{found:?}");
        assert!(found.windows(2).all(|pair| pair[0].share >= pair[1].share), "{found:?}");
        let names: std::collections::BTreeSet<_> = found.iter().map(|chain| &chain.path).collect();
        assert_eq!(names.len(), found.len(), "{found:?}");
        assert_eq!(found, chains(&studio, &sequence, &sequence.quality, &errors), "the same every time");
    }
}
