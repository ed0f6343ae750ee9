//! The tree over a scene's geometry: finds the nearest primitive along a ray.
//!
//! A tie goes to the lower index, so neither the tree's layout nor its builder shows in a picture.

mod bundle;
#[cfg(test)]
mod tests;

pub use bundle::Hits;

use crate::math::smaller;
use crate::scene::Geometry;
use crate::shape::{Crossing, Geometric, Plane, Shape};
use crate::simd::Lanes;
use crate::tree::{Contents, Leaves, Probe, Slabs, Stack, Tree, Vicinity};

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
    /// The largest of the coordinates between which all bounded primitives lie, and of those of planes.
    reach: f64,
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
        let (mut tree, mut leaves) = Tree::of_boxes(&boxes);
        let anchors = planes.iter().map(|(_, plane): &(u32, Plane)| plane.point.abs().max_element());
        let reach = anchors.fold(tree.space().reach(), f64::max);
        if let [only] = bounded[..] {
            untreed.push(only);
            (tree, leaves) = Default::default();
        }
        leaves.renumber(|thing| bounded[thing as usize]);
        Self { tree, leaves, planes, untreed, reach }
    }

    /// How near hits along a ray have to be for their surfaces to be compared.
    pub fn vicinity(&self, probe: &Probe) -> Vicinity {
        Vicinity::new(probe, self.reach)
    }

    /// The nearest primitive along the ray beyond t = 0; of equally near ones the first in the file.
    // Inlined, so that a ray just made is still in registers when the tree's space is entered: reading it back from
    // where it was written has to wait.
    #[inline(always)]
    pub fn closest(&self, geometry: &Geometry, probe: &Probe) -> Option<Hit> {
        self.closest_between(geometry, probe, (0.0, f64::INFINITY))
    }

    /// [`Bvh::closest`] among what lies beyond one t and before another.
    #[inline(always)]
    pub fn closest_between(&self, geometry: &Geometry, probe: &Probe, between: (f64, f64)) -> Option<Hit> {
        let mut nearest = Nearest { between, ..Nearest::new(self, geometry, probe, None) };
        nearest.test_planes();
        nearest.test(&self.untreed);
        self.tree.walk(probe, (between.0, nearest.limit()), &mut nearest);
        nearest.hit
    }

    /// Adds everything that the ray meets beyond one t and before another.
    pub fn crossings(&self, geometry: &Geometry, probe: &Probe, between: (f64, f64), found: &mut Vec<Hit>) {
        let mut all = All { bvh: self, geometry, probe, between, found, crossings: Vec::new() };
        self.planes.iter().for_each(|(index, _)| all.test(*index));
        self.untreed.iter().for_each(|index| all.test(*index));
        self.tree.walk(probe, between, &mut all);
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
        self.tree.walk_on::<L>(probe, (0.0, nearest.limit()), &mut nearest, stack);
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
        self.tree.walk_on::<L>(probe, (0.0, t_max), &mut any, stack);
        any.found
    }

    /// Whether anything lies on the ray in 0 < t < `t_max`.
    #[inline(always)]
    pub fn occluded(&self, geometry: &Geometry, probe: &Probe, t_max: f64) -> bool {
        let mut any = Any { bvh: self, geometry, probe, t_max, found: false };
        if self.planes.iter().any(|(_, plane)| plane.hit(probe, t_max).is_some()) {
            return true;
        }
        self.tree.walk(probe, (0.0, t_max), &mut any);
        any.found || any.test(&self.untreed)
    }
}

struct Nearest<'a> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    probe: &'a Probe,
    /// Only what lies beyond one t and before another counts.
    between: (f64, f64),
    vicinity: Vicinity,
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

/// Everything on a ray between two t.
struct All<'a> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    probe: &'a Probe,
    between: (f64, f64),
    found: &'a mut Vec<Hit>,
    crossings: Vec<Crossing>,
}

impl All<'_> {
    fn test(&mut self, primitive: u32) {
        let (after, t_max) = self.between;
        self.geometry.primitives[primitive as usize].crossings(self.probe, after, t_max, &mut self.crossings);
        self.found.extend(self.crossings.drain(..).map(|at| Hit { at, primitive }));
    }
}

impl Leaves for All<'_> {
    #[inline(always)]
    fn fetch<L: Lanes>(&self, _: u32) {}

    #[inline(always)]
    fn visit<L: Lanes>(&mut self, leaf: u32, _: &Slabs, limit: f32) -> Option<f32> {
        let bvh = self.bvh;
        bvh.leaves.leaf(leaf).iter().for_each(|index| self.test(*index));
        Some(limit)
    }
}

impl<'a> Nearest<'a> {
    /// Along the whole ray, with what has been found before.
    #[inline(always)]
    fn new(bvh: &'a Bvh, geometry: &'a Geometry, probe: &'a Probe, hit: Option<Hit>) -> Self {
        let (between, vicinity) = ((0.0, f64::INFINITY), bvh.vicinity(probe));
        Self { bvh, geometry, probe, between, vicinity, hit }
    }

    /// Beyond this nothing is of interest: a little behind the best, so that it is known what else is near it.
    #[inline(always)]
    fn limit(&self) -> f64 {
        let (_, t_max) = self.between;
        self.hit.map_or(t_max, |hit| smaller(self.vicinity.end(hit.at.t), t_max))
    }

    #[inline(always)]
    fn test(&mut self, leaf: &[u32]) {
        let after = self.between.0;
        for &index in leaf {
            let primitive = &self.geometry.primitives[index as usize];
            self.consider(index, |limit| primitive.hit_after(self.probe, after, limit));
        }
    }

    #[inline(always)]
    fn test_planes(&mut self) {
        let (bvh, probe, after) = (self.bvh, self.probe, self.between.0);
        for (index, plane) in &bvh.planes {
            self.consider(*index, |limit| plane.hit_after(probe, after, limit));
        }
    }

    /// Takes a primitive's hit before a limit if it is nearer, or as near and the primitive the earlier one.
    #[inline(always)]
    fn consider(&mut self, index: u32, hit: impl FnOnce(f64) -> Option<Crossing>) {
        let Some(mut at) = hit(self.limit()) else { return };
        if let Some(best) = &mut self.hit {
            if best.at.t < at.t || best.at.t == at.t && best.primitive < index {
                best.at.crowded = true;
                return;
            }
            at.crowded |= best.at.t < self.vicinity.end(at.t);
        }
        self.hit = Some(Hit { at, primitive: index });
    }
}
