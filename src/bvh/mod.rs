//! The tree over a scene's geometry: finds the nearest primitive along a ray.
//!
//! A tie goes to the lower index, so neither the tree's layout nor its builder shows in a picture.

mod bundle;
#[cfg(test)]
mod tests;

pub use bundle::Hits;

use crate::math::UNIT_ROUNDOFF;
use crate::scene::{Finish, Geometry};
use crate::shape::{Crossing, Geometric, Plane, Shape};
use crate::simd::Lanes;
use crate::tree::{Contents, Leaves, Probe, Slabs, Stack, Tree};

/// A tree over the bounded primitives, and the list of those that no box holds.
#[derive(Clone, Debug, Default)]
pub struct Bvh {
    tree: Tree,
    /// Indices of the primitives of each leaf.
    leaves: Contents,
    /// Infinite primitives with their indices. They are here as they are, so that their tests are inlined where the ray
    /// is still in registers.
    planes: Vec<(u32, Plane)>,
    /// Indices of others without a box, or of the only one that has a box: they are tested without a walk.
    untreed: Vec<u32>,
    /// The largest of the coordinates between which all bounded primitives lie.
    reach: f64,
    /// Whether lights are among the primitives.
    lights: bool,
}

/// Where a ray meets a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    pub at: Crossing,
    /// Index into the geometry's primitives.
    pub primitive: u32,
}

impl Bvh {
    /// A tree over `geometry`. The same geometry gives the same tree.
    pub fn build(geometry: &Geometry) -> Self {
        let (mut bounded, mut boxes) = (Vec::new(), Vec::new());
        let (mut planes, mut untreed) = (Vec::new(), Vec::new());
        for (index, primitive) in (0..).zip(&geometry.primitives) {
            match primitive.bounds() {
                Some(bounds) => {
                    bounded.push(index);
                    boxes.push(bounds);
                }
                None => match (&primitive.shape, &primitive.placement) {
                    (Shape::Plane(plane), None) => planes.push((index, *plane)),
                    _ => untreed.push(index),
                },
            }
        }
        let lights = geometry.primitives.iter().any(|p| matches!(p.finish, Finish::Light(_)));
        let (mut tree, mut leaves) = Tree::of_boxes(&boxes);
        let reach = tree.space().reach();
        if let [only] = bounded[..] {
            untreed.push(only);
            (tree, leaves) = Default::default();
        }
        leaves.renumber(|thing| bounded[thing as usize]);
        Self { tree, leaves, planes, untreed, reach, lights }
    }

    /// The largest of the coordinates between which all bounded primitives lie.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// The nearest primitive along the ray beyond t = 0; of equally near ones the first in the file.
    #[inline(always)]
    pub fn closest(&self, geometry: &Geometry, probe: &Probe) -> Option<Hit> {
        self.closest_before(geometry, probe, f64::INFINITY)
    }

    /// [`Bvh::closest`] among what lies before `t_max`.
    // Inlined, so that a ray just made is still in registers when the tree's space is entered: reading it back from
    // where it was written has to wait.
    #[inline(always)]
    pub fn closest_before(&self, geometry: &Geometry, probe: &Probe, t_max: f64) -> Option<Hit> {
        self.closest_but(geometry, probe, t_max, &[])
    }

    /// [`Bvh::closest_before`] of all primitives but some.
    #[inline(always)]
    pub fn closest_but(&self, geometry: &Geometry, probe: &Probe, t_max: f64, but: &[u32]) -> Option<Hit> {
        let mut nearest = Nearest { t_max, but, ..Nearest::new(self, geometry, probe, None) };
        nearest.test_planes();
        nearest.test(&self.untreed);
        self.tree.walk(probe, nearest.limit(), &mut nearest);
        nearest.hit
    }

    /// [`Bvh::closest`] on lanes that are at work already.
    #[inline(always)]
    pub fn closest_on<L: Lanes>(&self, geometry: &Geometry, probe: &Probe, stack: &mut Stack) -> Option<Hit> {
        let mut nearest = Nearest::new(self, geometry, probe, None);
        nearest.test_planes();
        for &index in &self.untreed {
            let primitive = &geometry.primitives[index as usize];
            nearest.consider(index, |limit| primitive.hit_on::<L>(probe, limit, stack));
        }
        self.tree.walk_on::<L>(probe, nearest.limit(), &mut nearest, stack);
        nearest.hit
    }

    /// [`Bvh::occluded`] on lanes that are at work already.
    #[inline(always)]
    pub fn occluded_on<L: Lanes>(
        &self,
        geometry: &Geometry,
        probe: &Probe,
        t_max: f64,
        stack: &mut Stack,
    ) -> bool {
        for (_, plane) in &self.planes {
            if plane.hit(probe, t_max).is_some() {
                return true;
            }
        }
        for &index in &self.untreed {
            if geometry.primitives[index as usize].blocks_on::<L>(probe, t_max, stack) {
                return true;
            }
        }
        let mut any = Any { bvh: self, geometry, probe, t_max, found: false };
        self.tree.walk_on::<L>(probe, t_max, &mut any, stack);
        any.found
    }

    /// Whether anything lies on the ray in 0 < t < `t_max`.
    #[inline(always)]
    pub fn occluded(&self, geometry: &Geometry, probe: &Probe, t_max: f64) -> bool {
        let mut any = Any { bvh: self, geometry, probe, t_max, found: false };
        if self.planes.iter().any(|(_, plane)| plane.hit(probe, t_max).is_some()) {
            return true;
        }
        self.tree.walk(probe, t_max, &mut any);
        any.found || any.test(&self.untreed)
    }
}

/// The rounding of where two surfaces in one place are met, as a share of how far the ray goes and of how far from the
/// world's origin it starts: that of two distances to planes, of a few roundings each.
const FLUSH: f64 = 256.0 * UNIT_ROUNDOFF;

struct Nearest<'a> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    probe: &'a Probe,
    t_max: f64,
    /// Primitives that do not count.
    but: &'a [u32],
    /// The t that the ray's origin is away from the world's, where there are lights to be met.
    afar: f64,
    hit: Option<Hit>,
}

impl Leaves for Nearest<'_> {
    #[inline(always)]
    fn fetch<L: Lanes>(&self, _: u32) {}

    #[inline(always)]
    fn visit<L: Lanes>(&mut self, leaf: u32, slabs: &Slabs, _: f32) -> Option<f32> {
        self.test(self.bvh.leaves.leaf(leaf));
        Some(slabs.limit(self.limit()))
    }
}

/// Anything on a ray before `t_max`.
struct Any<'a> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    probe: &'a Probe,
    t_max: f64,
    found: bool,
}

impl Any<'_> {
    fn test(&self, leaf: &[u32]) -> bool {
        leaf.iter().any(|&index| self.geometry.primitives[index as usize].blocks(self.probe, self.t_max))
    }
}

impl Leaves for Any<'_> {
    #[inline(always)]
    fn fetch<L: Lanes>(&self, _: u32) {}

    #[inline(always)]
    fn visit<L: Lanes>(&mut self, leaf: u32, _: &Slabs, limit: f32) -> Option<f32> {
        self.found = self.test(self.bvh.leaves.leaf(leaf));
        (!self.found).then_some(limit)
    }
}

impl<'a> Nearest<'a> {
    /// Along the whole ray, with what has been found before.
    #[inline(always)]
    fn new(bvh: &'a Bvh, geometry: &'a Geometry, probe: &'a Probe, hit: Option<Hit>) -> Self {
        let afar = if bvh.lights { probe.farthest() } else { 0.0 };
        Self { bvh, geometry, probe, t_max: f64::INFINITY, but: &[], afar, hit }
    }

    /// Beyond this nothing is of interest.
    fn limit(&self) -> f64 {
        let far = |hit: Hit| if self.bvh.lights { hit.at.t + 2.0 * self.flush(hit.at.t) } else { hit.at.t };
        self.hit.map_or(self.t_max, far)
    }

    /// How far apart hits of two surfaces in one place may be.
    fn flush(&self, t: f64) -> f64 {
        (t + self.afar) * FLUSH
    }

    /// By what hits are compared: t, but lights come before what they are set into.
    fn rank(&self, t: f64, primitive: u32) -> f64 {
        match self.geometry.primitives[primitive as usize].finish {
            Finish::Light(_) => t - self.flush(t),
            Finish::Material(_) => t,
        }
    }

    #[inline(always)]
    fn test(&mut self, leaf: &[u32]) {
        for &index in leaf {
            let primitive = &self.geometry.primitives[index as usize];
            self.consider(index, |limit| primitive.hit(self.probe, limit));
        }
    }

    #[inline(always)]
    fn test_planes(&mut self) {
        let (bvh, probe) = (self.bvh, self.probe);
        for (index, plane) in &bvh.planes {
            self.consider(*index, |limit| plane.hit(probe, limit));
        }
    }

    /// Takes a primitive's hit before a limit if it is better than what there is.
    #[inline(always)]
    fn consider(&mut self, index: u32, hit: impl FnOnce(f64) -> Option<Crossing>) {
        if self.but.contains(&index) {
            return;
        }
        // One number beyond the best, so that an equally near hit is found and the indices decide; where there are lights,
        // as far as they come first.
        let lights = self.bvh.lights;
        let reach = |t: f64| if lights { t + 2.0 * self.flush(t) } else { t.next_up() };
        let limit = self.hit.map_or(self.t_max, |best| reach(best.at.t));
        let Some(at) = hit(limit.min(self.t_max)) else { return };
        let better = self.hit.is_none_or(|best| {
            let [a, b] = match lights {
                true => [self.rank(at.t, index), self.rank(best.at.t, best.primitive)],
                false => [at.t, best.at.t],
            };
            a < b || a == b && index < best.primitive
        });
        if better {
            self.hit = Some(Hit { at, primitive: index });
        }
    }
}
