//! Memory of branching paths.

use super::*;
use crate::appearance::environment::{Environment, Sky};
use crate::appearance::material::MaterialBinding;
use crate::appearance::optics::Fresnel;
use crate::base::color::Rgb;
use crate::base::math::{DAffine3, DVec3, look_at};
use crate::camera::{Camera, Projection};
use crate::film::AovSet;
use crate::film::filter::FilterSampler;
use crate::geometry::shape::{Cuboid, Shape};
use crate::sampling::PixelSampler;
use crate::scene::top_level::Bvh;
use crate::scene::{Finish, Geometry, Scene, Shading, Weights};
use crate::sequence::quality::Quality;
use crate::testing::glass;
use crate::trace::TraceSettings;
use crate::trace::camera_rays::SampleGroup;

const BOUNCES: u32 = 14;

/// Plates of glass, one behind the other on both sides of the camera. At each of their surfaces a path becomes two.
fn plates() -> (Geometry, Shading) {
    let mut geometry = Geometry::default();
    for plate in (-4..4).map(f64::from) {
        let (min, max) = (DVec3::new(-1e4, -1e4, plate + 0.2), DVec3::new(1e4, 1e4, plate + 0.8));
        let finish = Finish::Material(MaterialBinding::One(0));
        geometry.push(&Shape::Cuboid(Cuboid { min, max }), DAffine3::IDENTITY, finish);
    }
    let environment = Environment { sky: Sky::Constant(Rgb::ONE), ..Environment::default() };
    (geometry, Shading { materials: vec![glass(4.0, 0, Fresnel::Exact)], environment, ..Shading::default() })
}

/// The light of samples of neighbouring pixels, their counts, and the largest number of paths at once, if at most
/// `max_paths` advance together.
fn followed(pixels: u32, max_paths: usize) -> (Vec<[f64; 3]>, Counts, usize) {
    let (geometry, shading) = plates();
    let basis = look_at(DVec3::ZERO, DVec3::new(0.3, 0.2, 1.0), DVec3::Y).expect("a frame");
    let projection = Projection::Perspective { half_height: 0.1 };
    let camera = Camera { position: DVec3::ZERO, basis, projection, lens: None };
    let weights = Weights(vec![Rgb::ONE]);
    let scene = Scene { geometry: &geometry, shading: &shading, weights: &weights, camera: &camera };
    let bvh = Bvh::build(&geometry);
    let quality = Quality { bounces: BOUNCES, threshold: 0.0, ..Quality::default() };
    let filter = FilterSampler::new(quality.filter);
    let settings = TraceSettings { size: (8, 1), quality, filter, aovs: AovSet::default(), first_sample: 0 };
    let context = TraceContext::new(&scene, &bvh, &settings);
    let mut scratch = ScratchBuffer { max_paths, ..ScratchBuffer::new(&context) };
    let (mut samples, mut group) = (PixelSamples::with_capacity(8), SampleGroup::default());
    for x in 0..pixels {
        group.push(x, (x, 0), 0, PixelSampler::new((x, 0), 0).sample(0));
    }
    samples.extend(&group);
    scratch.follow(&context, &samples, Placement::Grid(1));
    let sums = (0..pixels).map(|slot| scratch.sums.get(0, slot).to_array()).collect();
    (sums, scratch.counts, scratch.peak)
}

/// With few paths at a time, the branches of a sample take memory by depth, not by their number, and give the same
/// light.
#[test]
fn branches_of_one_sample_are_not_all_held_at_once() {
    const FEW: usize = 64;
    let (whole, counts, all) = followed(1, usize::MAX);
    assert!(all > 1 << (BOUNCES - 2), "{all} paths at once");
    let (parts, counts_of_parts, few) = followed(1, FEW);
    assert!(few <= FEW * (BOUNCES as usize + 3), "{few} paths at once");
    assert_eq!(counts_of_parts, counts);
    for (part, whole) in parts.as_flattened().iter().zip(whole.as_flattened()) {
        assert!((part - whole).abs() <= 1e-12 * whole && *whole > 0.0, "{part} {whole}");
    }
}

/// The split of a sample's branches depends on that sample alone.
#[test]
fn branches_are_parted_alike_beside_other_samples() {
    let (alone, ..) = followed(1, 64);
    for pixels in [2, 3, 7] {
        let (together, ..) = followed(pixels, 64);
        assert!(together[0] == alone[0] && alone[0][0] > 0.0, "{pixels}: {together:?} {alone:?}");
    }
}
