//! What the tests share: sequences as text, films collected instead of written, and random numbers.

#[path = "../../src/testing/random.rs"]
mod random;

pub use random::Random;

use kinora::appearance::material::MaterialBinding;
use kinora::base::color::Rgb;
use kinora::base::math::DAffine3;
use kinora::base::stats::{Dropped, ProgressMeter};
use kinora::film::{AovSet, Film};
use kinora::geometry::shape::Shape;
use kinora::pipeline::schedule::{FilmCollector, FrameLoop, Stats};
use kinora::scene::{Finish, Geometry};
use kinora::sequence::{Sequence, parse};
use std::fs;
use std::path::Path;
use std::sync::Arc;
use tempfile::TempDir;

/// An empty folder, which goes with the value.
pub fn folder() -> TempDir {
    tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable")
}

/// Writes a file into a folder.
pub fn put(folder: &Path, name: &str, text: &str) {
    fs::write(folder.join(name), text).expect("a disk");
}

/// Reads a sequence that must be right.
pub fn sequence(text: &str) -> Sequence {
    sequence_in(Path::new(""), text)
}

/// Reads a sequence that must be right as if it were in a folder.
pub fn sequence_in(folder: &Path, text: &str) -> Sequence {
    parse(&folder.join("test.ron").to_string_lossy(), text).unwrap_or_else(|faults| panic!("{faults}"))
}

/// One frame: its film and what making it took.
pub struct Shot {
    pub film: Film,
    pub work: Work,
}

/// What one frame took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    pub camera: u64,
    pub mirror: u64,
    pub transmitted: u64,
    pub scattered: u64,
    pub shadow: u64,
    pub fog: u64,
    pub paint: u64,
    pub light_samples: u64,
    pub lens_samples: u64,
    pub bvh_builds: u64,
    pub bvh_refits: u64,
    pub geometry_packs: u64,
    pub primitives_packed: u64,
    pub shading_packs: u64,
}

impl Work {
    fn between(before: &Stats, after: &Stats) -> Self {
        let (old, new) = (before.counts.evaluations, after.counts.evaluations);
        Self {
            camera: after.counts.rays.camera - before.counts.rays.camera,
            mirror: after.counts.rays.mirror - before.counts.rays.mirror,
            transmitted: after.counts.rays.transmitted - before.counts.rays.transmitted,
            scattered: after.counts.rays.scattered - before.counts.rays.scattered,
            shadow: after.counts.rays.shadow - before.counts.rays.shadow,
            fog: new.fog - old.fog,
            paint: new.paint - old.paint,
            light_samples: new.light_samples - old.light_samples,
            lens_samples: new.lens_samples - old.lens_samples,
            bvh_builds: after.bvh_builds - before.bvh_builds,
            bvh_refits: after.bvh_refits - before.bvh_refits,
            primitives_packed: after.primitives_packed - before.primitives_packed,
            geometry_packs: after.geometry_packs - before.geometry_packs,
            shading_packs: after.shading_packs - before.shading_packs,
        }
    }
}

impl Shot {
    /// The weighted radiance of a pixel.
    pub fn pixel(&self, x: u32, y: u32) -> Rgb {
        let at = (y * self.film.width + x) as usize;
        self.film.radiance().nth(at).expect("a pixel of the film")
    }
}

/// Renders frames in the order given, in one loop.
pub fn shoot(sequence: &Sequence, frames: impl IntoIterator<Item = u32>) -> Vec<Shot> {
    let mut frame_loop =
        FrameLoop::new(sequence, FilmCollector::default(), Arc::new(ProgressMeter::default()));
    let mut before = frame_loop.stats().clone();
    let mut works = Vec::new();
    for frame in frames {
        frame_loop.frame(frame).unwrap_or_else(|fault| panic!("frame {frame}: {fault:?}"));
        let after = frame_loop.stats().clone();
        works.push(Work::between(&before, &after));
        before = after;
    }
    let films = frame_loop.into_sink().expect("the sink").0;
    assert_eq!(films.len(), works.len(), "a film per frame");
    films.into_iter().zip(works).map(|(film, work)| Shot { film, work }).collect()
}

/// The first frame, and the samples that were no light.
#[allow(dead_code, reason = "for the hard cases")]
pub fn shoot_counting(text: &str) -> (Film, Dropped) {
    let sequence = sequence(text);
    let mut frame_loop =
        FrameLoop::new(&sequence, FilmCollector::default(), Arc::new(ProgressMeter::default()));
    frame_loop.frame(0).unwrap_or_else(|fault| panic!("{fault:?}"));
    let dropped = frame_loop.stats().counts.dropped;
    let film = frame_loop.into_sink().and_then(|mut films| films.0.pop()).expect("a film");
    (film, dropped)
}

/// The first frame with what is recorded besides light.
pub fn shoot_extra(sequence: &Sequence, aovs: AovSet) -> Film {
    let meter = Arc::new(ProgressMeter::default());
    let mut frame_loop = FrameLoop::with_aovs(sequence, aovs, FilmCollector::default(), meter);
    frame_loop.frame(0).unwrap_or_else(|fault| panic!("{fault:?}"));
    frame_loop.into_sink().and_then(|mut films| films.0.pop()).expect("a film")
}

/// All frames of a sequence written as text.
pub fn shoot_all(text: &str) -> Vec<Shot> {
    shoot_all_in(Path::new(""), text)
}

/// All frames of a sequence written as text, in a folder with its files.
pub fn shoot_all_in(folder: &Path, text: &str) -> Vec<Shot> {
    let sequence = sequence_in(folder, text);
    shoot(&sequence, 0..sequence.timeline.frames)
}

/// The film of the first frame of a sequence written as text.
pub fn shoot_film(text: &str) -> Film {
    shoot(&sequence(text), [0]).remove(0).film
}

/// The radiance in the middle of the picture: a picture of one pixel and one sample, which looks exactly along
/// the line from the camera to its target. `rest` are the other fields of a sequence.
pub fn radiance_at_target(rest: &str) -> Rgb {
    let text = format!("(output: (size: (1, 1)), quality: (antialias: 1, bounces: 64), {rest})");
    shoot_all(&text)[0].pixel(0, 0)
}

/// Shapes of the first material where they stand.
pub fn geometry(shapes: impl IntoIterator<Item = Shape>) -> Geometry {
    let mut geometry = Geometry::default();
    shapes.into_iter().for_each(|shape| {
        geometry.push(&shape, DAffine3::IDENTITY, Finish::Material(MaterialBinding::One(0)))
    });
    geometry
}
