//! What robust intersections cost and gain in a scene: its own rays by the methods of the hard cases, compared with
//! double-double arithmetic.
//!
//! For each pixel, a camera ray passes through its centre; a bounce ray and a shadow ray leave the hit. They are
//! intersected by textbook formulas in f32 and f64, by stable formulas in f32, and by Kinora's. Shadow rays either
//! start at the computed point and ignore hits closer than a fixed offset, or start beyond Kinora's error bounds.

mod judge;
mod rays;
mod textbook;
mod times;

pub use judge::PixelError;
pub use rays::{SceneRays, SurfaceHit};

use super::hard_cases::METHODS;
use crate::scene::Scene;
use judge::{PixelVerdict, judge};
use rayon::prelude::*;

/// The hits of one method on the rays of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct HitErrors {
    pub method: &'static str,
    pub rays: u32,
    /// Rays with a missed or invented hit, or a relative error of t above a thousandth.
    pub wrong: u32,
    /// Time of one test of one shape.
    pub nanoseconds: f64,
}

/// The shadow rays of one method of choosing their origin.
#[derive(Clone, Debug, PartialEq)]
pub struct ShadowRayErrors {
    pub method: String,
    pub rays: u32,
    /// Lit points that their own or a neighbouring surface shadows because of rounding.
    pub false_shadows: u32,
    /// Lost shadows of nearby surfaces.
    pub lost_shadows: u32,
    /// Time to compute one origin; `None` for methods that use the point as it is.
    pub nanoseconds: Option<f64>,
}

/// The results of all methods.
#[derive(Clone, Debug, PartialEq)]
pub struct Robustness {
    pub hits: Vec<HitErrors>,
    pub starts: Vec<ShadowRayErrors>,
    /// The size of the grid of camera rays.
    pub size: (u32, u32),
    /// For each pixel, a brightness for display, and the error of the cheap method.
    pub pixels: Vec<(f32, Option<PixelError>)>,
}

impl Robustness {
    /// Traces the rays of up to `most` pixels, fewer if the scene has many primitives.
    pub fn of(scene: &Scene, (width, height): (u32, u32), most: u32) -> Self {
        let rays = SceneRays::new(scene);
        // Each ray is tested against all primitives.
        let room = f64::from(most).min(4e6 / (scene.geometry.primitives.len() as f64 + 20.0)).max(500.0);
        let share = (room / (f64::from(width) * f64::from(height))).sqrt().min(1.0);
        let side = |side: u32| ((f64::from(side) * share).round() as u32).max(1);
        let size = (side(width), side(height));
        let pixels: Vec<u32> = (0..size.0 * size.1).collect();
        let judged: Vec<PixelVerdict> = pixels.par_iter().map(|&pixel| judge(&rays, pixel, size)).collect();
        let (tests, begins) = times::times(&rays, size);
        let hits = METHODS.iter().enumerate().map(|(index, method)| HitErrors {
            method,
            rays: judged.iter().map(|pixel| pixel.rays).sum(),
            wrong: judged.iter().map(|pixel| pixel.wrong_hits[index]).sum(),
            nanoseconds: tests[index],
        });
        let starts = judge::ORIGIN_METHODS.iter().enumerate().map(|(index, method)| ShadowRayErrors {
            method: (*method).to_owned(),
            rays: judged.iter().filter(|pixel| pixel.starts.is_some()).count() as u32,
            false_shadows: count(&judged, |starts| starts.false_shadow[index]),
            lost_shadows: count(&judged, |starts| starts.lost_shadow[index]),
            nanoseconds: begins[index],
        });
        let (hits, starts) = (hits.collect(), starts.collect());
        Self { hits, starts, size, pixels: judged.iter().map(|pixel| (pixel.shade, pixel.error())).collect() }
    }

    /// The fraction of pixels that the cheap method gets wrong.
    pub fn wrong_pixels(&self) -> f64 {
        let wrong = self.pixels.iter().filter(|(_, error)| error.is_some()).count();
        wrong as f64 / self.pixels.len().max(1) as f64
    }
}

fn count(judged: &[PixelVerdict], of: impl Fn(&judge::ShadowVerdict) -> bool) -> u32 {
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
    fn kinora_is_right_where_textbooks_are_wrong() {
        let objects = r#""floor": (shape: Plane()), "far": (shape: Sphere(center: (0, 1, 0), radius: 1)),
            "tiny": (shape: Sphere(center: (1.2, 0.0004, 2), radius: 0.0004)),
            "ring": (shape: Torus(center: (-1.5, 0.5, 1), major: 0.5, minor: 0.2)),
            "can": (shape: Cylinder(from: (2, 0, 0), to: (2, 1, 0), radius: 0.4)),
            "chest": (shape: Box(min: (-3, 0, -1), max: (-2, 1, 0)))"#;
        let found = measured(objects, r#""sun": Point(position: (3, 6, 4))"#);
        let [textbook, .., ours] = found.hits.as_slice() else { panic!("{found:?}") };
        assert!(textbook.rays > 2000 && ours.wrong == 0, "{:?}", found.hits);
        let kinora = found.starts.last().expect("a method");
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
