//! Paths that go from surface to surface together: what is asked of the tree for many of them at once.
//!
//! Rays of neighbours are traced as bundles where they go the same way: from the eye, and from what it sees to the lights.

use super::lights::Arrival;
use super::one_lobe::Lobe;
use super::path::Path;
use super::tracer::{Tracer, Work};
use crate::bvh::Hit;
use crate::camera::Ray;
use crate::color::Rgb;
use crate::film::LayerId;
use crate::math::DVec3;
use crate::scene::Geometry;
use crate::shape::{Rays, Shape, Surface};
use crate::simd::{self, Lanes, dispatch};
use crate::tree::{Probe, Stack};

/// Paths that are followed at once, at most, and at least where there are as many.
pub const WAVE: usize = 256;
const LEAST: usize = 32;

/// Sums of layers that stay in the cache.
const SUMS: usize = 2048;

/// How many paths that add to so many layers are followed at once, a multiple of eight: many, so that eight of a kind are
/// often among them, unless their sums are too many then.
pub fn at_once(layers: usize) -> usize {
    (SUMS / layers.max(1) / 8 * 8).clamp(LEAST, WAVE)
}

/// Lists of paths, kept from wave to wave.
#[derive(Default)]
pub struct Lists {
    /// Places of those on their way.
    pub active: Vec<u32>,
    /// What each of them meets.
    pub hits: Vec<Option<Hit>>,
    /// Places of those that have just met nothing.
    pub escaped: Vec<u32>,
    /// For each lobe, which of those on their way are at surfaces that have no other.
    pub queues: [Vec<u32>; Lobe::ALL.len()],
}

/// Fewer rays than these are traced one by one.
const BUNDLE: usize = 3;

/// Light that reaches a surface unless something stands in its way.
pub struct Shadow {
    pub ray: Ray,
    pub t_max: f64,
    /// Where the layers of its path's sample begin.
    pub first: usize,
    pub layer: LayerId,
    /// Lights that have been asked before this one at the surface.
    pub turn: u32,
    pub radiance: Rgb,
}

impl Shadow {
    /// For the sample in hand.
    pub fn new(
        arrival: &Arrival,
        surface: &Surface,
        (layer, turn): (LayerId, u32),
        radiance: Rgb,
        work: &Work,
    ) -> Self {
        let (ray, t_max) = arrival.shadow_ray(surface);
        Self { ray, t_max, first: work.first, layer, turn, radiance }
    }

    /// Whether the light is at the surface itself, so that there is no way on which anything could stand.
    fn is_there(&self) -> bool {
        self.ray.direction == DVec3::ZERO
    }

    fn arrives(&self, work: &mut Work) {
        work.first = self.first;
        work.add(self.layer, self.radiance);
    }
}

impl Tracer<'_> {
    /// What paths meet next, one after the other, but for those that have passed something straight on; of such as start at the
    /// eye, eight at a time.
    pub fn meet(&self, paths: &[Path], active: &[u32], from_eye: bool, hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        if !from_eye {
            dispatch(Meet { tracer: self, paths, active, hits });
            return;
        }
        for some in active.chunks(8) {
            let ray = |lane: usize| &paths[some[lane] as usize].ray;
            if some.len() < BUNDLE {
                hits.extend((0..some.len()).map(|lane| self.closest(ray(lane))));
                continue;
            }
            let rays = Rays::gather(some.len(), ray);
            let found = self.bvh.closest_of(self.scene.geometry, &rays, wanted(some.len()));
            hits.extend((0..some.len()).map(|lane| found.one(lane)));
        }
    }

    /// Asks for what surfaces that were hit are made from, so that it is there when they are shaded.
    pub fn fetch(&self, hits: &[Option<Hit>]) {
        dispatch(Fetch { geometry: self.scene.geometry, hits });
    }

    /// Adds the light that nothing stands in the way of, in the order in which it has been asked for.
    pub fn cast(&self, shadows: &mut Vec<Shadow>, from_first: bool, work: &mut Work) {
        work.counts.rays.shadow += shadows.iter().filter(|shadow| !shadow.is_there()).count() as u64;
        let geometry = self.scene.geometry;
        if !from_first || shadows.len() < BUNDLE {
            dispatch(Cast { tracer: self, shadows, work });
            shadows.clear();
            return;
        }
        // Rays to one light go the same way. Those of one surface keep their order.
        shadows.sort_by_key(|shadow| shadow.turn);
        for some in shadows.chunks(8) {
            let last = some.len() - 1;
            let rays = Rays::gather(some.len(), |lane| &some[lane].ray);
            let t_max = std::array::from_fn(|lane| some[lane.min(last)].t_max);
            let moving =
                (0..).zip(some).filter(|(_, shadow)| !shadow.is_there()).map(|(lane, _)| 1 << lane).sum();
            let hidden = self.bvh.occluded_of(geometry, &rays, moving, &t_max);
            for (lane, shadow) in some.iter().enumerate() {
                if hidden >> lane & 1 == 0 {
                    shadow.arrives(work);
                }
            }
        }
        shadows.clear();
    }
}

/// What paths meet, one after the other.
struct Meet<'a> {
    tracer: &'a Tracer<'a>,
    paths: &'a [Path],
    active: &'a [u32],
    hits: &'a mut Vec<Option<Hit>>,
}

impl simd::Work for Meet<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Tracer { bvh, scene, .. } = self.tracer;
        let mut stack = Stack::default();
        for &index in self.active {
            let path = &self.paths[index as usize];
            let hit = match path.passed {
                None => bvh.closest_on::<L>(scene.geometry, &Probe::new(path.ray), &mut stack),
                Some(_) => None,
            };
            self.hits.push(hit);
        }
    }
}

/// Shadow rays, one after the other.
struct Cast<'a> {
    tracer: &'a Tracer<'a>,
    shadows: &'a [Shadow],
    work: &'a mut Work,
}

impl simd::Work for Cast<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Tracer { bvh, scene, .. } = self.tracer;
        let mut stack = Stack::default();
        for shadow in self.shadows {
            let Shadow { ray, t_max, .. } = *shadow;
            if shadow.is_there() || !bvh.occluded_on::<L>(scene.geometry, &Probe::new(ray), t_max, &mut stack)
            {
                shadow.arrives(self.work);
            }
        }
    }
}

/// The corners of triangles of meshes lie anywhere in memory. They are asked for all at once.
struct Fetch<'a> {
    geometry: &'a Geometry,
    hits: &'a [Option<Hit>],
}

impl simd::Work for Fetch<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        for hit in self.hits.iter().flatten() {
            if let Shape::Mesh(shape) = &self.geometry.primitives[hit.primitive as usize].shape {
                shape.mesh.fetch::<L>(hit.at.part);
            }
        }
        for hit in self.hits.iter().flatten() {
            if let Shape::Mesh(shape) = &self.geometry.primitives[hit.primitive as usize].shape {
                shape.mesh.fetch_corners::<L>(hit.at.part, shape.normals);
            }
        }
    }
}

#[cfg(test)]
mod tests;

/// A bit for each of so many lanes.
fn wanted(count: usize) -> u32 {
    0xff >> (8 - count.min(8))
}
