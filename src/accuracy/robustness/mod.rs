//! What robustness costs in a scene: its own rays in the ways of the hard cases, each judged by arithmetic of twice the
//! precision of f64.
//!
//! A ray from the camera goes through the middle of each pixel, one goes on from each hit, and one to a light. Shapes are met
//! by formulas of textbooks in f32 and f64, by stable ones in f32, and by Kinora's. Rays to lights start from the point as
//! it is and ignore what is nearer than a fixed offset, or where Kinora's bounds of errors say.

mod bodies;
mod judge;
mod rays;
mod times;

pub use judge::Blemish;
pub use rays::{Met, Scenery};

use super::hard_cases::WAYS;
use crate::scene::Scene;
use judge::{PixelVerdict, judge};
use rayon::prelude::*;

/// The offsets that rays to lights are usually started with, in the scene's units.
pub const OFFSETS: [f64; 2] = [1e-3, 1e-5];

/// How the rays of a scene fare by one way of meeting shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct Hits {
    pub way: &'static str,
    /// Rays, and those of them that meet something else than they should, or a thousandth of the way off.
    pub rays: u32,
    pub wrong: u32,
    /// Of one test of one shape.
    pub nanoseconds: f64,
}

/// How rays to lights fare by one way of starting them.
#[derive(Clone, Debug, PartialEq)]
pub struct Starts {
    pub way: String,
    pub rays: u32,
    /// Lit places that their own or a neighbouring surface shadows by rounding.
    pub false_shadows: u32,
    /// Shadows of what is near that are lost.
    pub lost_shadows: u32,
    /// Of starting one ray; none of those that need nothing but the point.
    pub nanoseconds: Option<f64>,
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Robustness {
    pub hits: Vec<Hits>,
    pub starts: Vec<Starts>,
    /// Of the picture.
    pub size: (u32, u32),
    /// Of each pixel: how bright the surface is shown, and what the cheap way makes wrong there.
    pub pixels: Vec<(f32, Option<Blemish>)>,
}

impl Robustness {
    /// Sends the rays of as many pixels as there is time for: some thousand.
    pub fn of(scene: &Scene, (width, height): (u32, u32), most: u32) -> Self {
        let scenery = Scenery::new(scene);
        // Each ray is held against all primitives.
        let room = f64::from(most).min(4e6 / (scene.geometry.primitives.len() as f64 + 20.0)).max(500.0);
        let share = (room / (f64::from(width) * f64::from(height))).sqrt().min(1.0);
        let side = |side: u32| ((f64::from(side) * share).round() as u32).max(1);
        let size = (side(width), side(height));
        let pixels: Vec<u32> = (0..size.0 * size.1).collect();
        let judged: Vec<PixelVerdict> =
            pixels.par_iter().map(|&pixel| judge(&scenery, pixel, size)).collect();
        let (tests, begins) = times::times(&scenery, size);
        let hits = WAYS.iter().enumerate().map(|(index, way)| Hits {
            way,
            rays: judged.iter().map(|pixel| pixel.rays).sum(),
            wrong: judged.iter().map(|pixel| pixel.wrong_hits[index]).sum(),
            nanoseconds: tests[index],
        });
        let starts = judge::START_NAMES.iter().enumerate().map(|(index, way)| Starts {
            way: (*way).to_owned(),
            rays: judged.iter().filter(|pixel| pixel.starts.is_some()).count() as u32,
            false_shadows: count(&judged, |starts| starts.false_shadow[index]),
            lost_shadows: count(&judged, |starts| starts.lost_shadow[index]),
            nanoseconds: begins[index],
        });
        let (hits, starts) = (hits.collect(), starts.collect());
        Self {
            hits,
            starts,
            size,
            pixels: judged.iter().map(|pixel| (pixel.shade, pixel.blemish())).collect(),
        }
    }

    /// The share of the pixels that the cheap way makes wrong.
    pub fn wrong_pixels(&self) -> f64 {
        let wrong = self.pixels.iter().filter(|(_, blemish)| blemish.is_some()).count();
        wrong as f64 / self.pixels.len().max(1) as f64
    }
}

fn count(judged: &[PixelVerdict], of: impl Fn(&judge::StartVerdict) -> bool) -> u32 {
    judged.iter().filter(|pixel| pixel.starts.as_ref().is_some_and(&of)).count() as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::schedule::Preview;
    use crate::sequence::parse;

    fn measured(objects: &str, lights: &str) -> Robustness {
        let text = format!(
            "(camera: (position: (0, 2, 6), target: (0, 1, 0)), lights: {{ {lights} }},
              default_material: (ambient: 0), objects: {{ {objects} }})"
        );
        let sequence = parse("test.ron", &text).expect("a sequence");
        let found = Preview::new(&sequence).scene_of(0, |scene| Robustness::of(scene, (64, 36), 2000));
        found.expect("a scene")
    }

    #[test]
    fn kinora_is_right_where_textbooks_are_not() {
        let objects = r#""floor": (shape: Plane()), "far": (shape: Sphere(center: (0, 1, 0), radius: 1)),
            "tiny": (shape: Sphere(center: (1.2, 0.0004, 2), radius: 0.0004)),
            "ring": (shape: Torus(center: (-1.5, 0.5, 1), major: 0.5, minor: 0.2)),
            "can": (shape: Cylinder(from: (2, 0, 0), to: (2, 1, 0), radius: 0.4)),
            "chest": (shape: Box(min: (-3, 0, -1), max: (-2, 1, 0)))"#;
        let found = measured(objects, r#""sun": Point(position: (3, 6, 4))"#);
        let [textbook, .., ours] = found.hits.as_slice() else { panic!("{found:?}") };
        assert!(textbook.rays > 2000 && ours.wrong == 0, "{:?}", found.hits);
        let kinora = found.starts.last().expect("a way");
        assert_eq!((kinora.false_shadows, kinora.lost_shadows), (0, 0), "{:?}", found.starts);
        assert!(kinora.rays > 500 && kinora.nanoseconds.is_some());
    }

    #[test]
    fn far_from_the_origin_textbooks_in_f32_fail() {
        let objects = r#""ball": (shape: Sphere(center: (0, 1, -30000), radius: 20000)),
            "floor": (shape: Rectangle(corner: (-5, 0, 5), u: (10, 0, 0), v: (0, 0, -9)))"#;
        let found = measured(objects, r#""sun": Point(position: (3, 6, 4))"#);
        let wrong = |way: usize| found.starts[way].false_shadows + found.starts[way].lost_shadows;
        assert!(wrong(0) + found.hits[0].wrong > 20, "{:?} {:?}", found.starts, found.hits);
        assert_eq!(wrong(found.starts.len() - 1), 0, "{:?}", found.starts);
        assert!(found.wrong_pixels() > 0.0);
    }
}
