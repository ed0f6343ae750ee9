//! The tree over a scene's geometry: finds the nearest primitive along a ray.
//!
//! A tie goes to the lower index, so neither the tree's layout nor its builder shows in a picture.

#[cfg(test)]
mod tests;

use crate::math::UNIT_ROUNDOFF;
use crate::scene::{Finish, Geometry};
use crate::shape::{Crossing, Geometric, Plane, Shape};
use crate::simd::Lanes;
use crate::tree::{Leaves, Probe, Slabs, Tree};

/// A tree over the bounded primitives, and the list of those that no box holds.
#[derive(Clone, Debug, Default)]
pub struct Bvh {
    tree: Tree,
    /// Indices of the primitives of each leaf, one leaf after the other, and where each leaf's begin.
    primitives: Vec<u32>,
    begins: Vec<u32>,
    /// Infinite primitives with their indices. They are here as they are, so that their tests are inlined where the ray
    /// is still in registers.
    planes: Vec<(u32, Plane)>,
    /// Indices of others without a box.
    unbounded: Vec<u32>,
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
        let (mut planes, mut unbounded) = (Vec::new(), Vec::new());
        for (index, primitive) in (0..).zip(&geometry.primitives) {
            match primitive.bounds() {
                Some(bounds) => {
                    bounded.push(index);
                    boxes.push(bounds);
                }
                None => match (&primitive.shape, &primitive.placement) {
                    (Shape::Plane(plane), None) => planes.push((index, *plane)),
                    _ => unbounded.push(index),
                },
            }
        }
        let (tree, leaves) = Tree::of_boxes(&boxes);
        let mut bvh = Self { tree, primitives: Vec::new(), begins: vec![0], planes, unbounded };
        for leaf in leaves {
            bvh.primitives.extend(leaf.into_iter().map(|thing| bounded[thing as usize]));
            bvh.begins.push(bvh.primitives.len() as u32);
        }
        bvh
    }

    /// Indices of the primitives of a leaf.
    #[inline(always)]
    fn leaf(&self, leaf: u32) -> &[u32] {
        let leaf = leaf as usize;
        &self.primitives[self.begins[leaf] as usize..self.begins[leaf + 1] as usize]
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
        let mut nearest = Nearest { bvh: self, geometry, probe, t_max, but: &[], hit: None };
        nearest.test_unbounded();
        self.tree.walk(probe, nearest.t(), &mut nearest);
        nearest.hit
    }

    /// [`Bvh::closest_before`] of all primitives but some.
    pub fn closest_but(&self, geometry: &Geometry, probe: &Probe, t_max: f64, but: &[u32]) -> Option<Hit> {
        let mut nearest = Nearest { bvh: self, geometry, probe, t_max, but, hit: None };
        nearest.test_unbounded();
        self.tree.walk(probe, nearest.t(), &mut nearest);
        nearest.hit
    }

    /// Whether anything lies on the ray in 0 < t < `t_max`.
    #[inline(always)]
    pub fn occluded(&self, geometry: &Geometry, probe: &Probe, t_max: f64) -> bool {
        let mut any = Any { bvh: self, geometry, probe, t_max, found: false };
        if self.planes.iter().any(|(_, plane)| plane.hit(probe, t_max).is_some()) {
            return true;
        }
        self.tree.walk(probe, t_max, &mut any);
        any.found || any.test(&self.unbounded)
    }
}

/// The share of its distance by which a surface may lie before or behind another one that it is set into, a hundred
/// times what rounding does.
const FLUSH: f64 = 256.0 * UNIT_ROUNDOFF;

struct Nearest<'a> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    probe: &'a Probe,
    t_max: f64,
    /// Primitives that do not count.
    but: &'a [u32],
    hit: Option<Hit>,
}

impl Leaves for Nearest<'_> {
    const IN_ORDER: bool = true;

    #[inline(always)]
    fn visit<L: Lanes>(&mut self, leaf: u32, slabs: &Slabs) -> Option<f32> {
        self.test(self.bvh.leaf(leaf));
        Some(slabs.limit(self.t()))
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
    const IN_ORDER: bool = false;

    #[inline(always)]
    fn visit<L: Lanes>(&mut self, leaf: u32, slabs: &Slabs) -> Option<f32> {
        self.found = self.test(self.bvh.leaf(leaf));
        (!self.found).then(|| slabs.limit(self.t_max))
    }
}

impl Nearest<'_> {
    fn t(&self) -> f64 {
        self.hit.map_or(self.t_max, |hit| hit.at.t)
    }

    /// By what hits are compared: t, but lights come before what they are set into.
    fn rank(&self, t: f64, primitive: u32) -> f64 {
        match self.geometry.primitives[primitive as usize].finish {
            Finish::Light(_) => t * (1.0 - FLUSH),
            Finish::Material(_) => t,
        }
    }

    fn test(&mut self, leaf: &[u32]) {
        for &index in leaf {
            let primitive = &self.geometry.primitives[index as usize];
            self.consider(index, |limit| primitive.hit(self.probe, limit));
        }
    }

    #[inline(always)]
    fn test_unbounded(&mut self) {
        let (bvh, probe) = (self.bvh, self.probe);
        for (index, plane) in &bvh.planes {
            self.consider(*index, |limit| plane.hit(probe, limit));
        }
        self.test(&bvh.unbounded);
    }

    /// Takes a primitive's hit before a limit if it is better than what there is.
    #[inline(always)]
    fn consider(&mut self, index: u32, hit: impl FnOnce(f64) -> Option<Crossing>) {
        if self.but.contains(&index) {
            return;
        }
        // A little beyond the best, so that an equally near hit is found and the indices decide.
        let limit = self.hit.map_or(self.t_max, |best| best.at.t + best.at.t * FLUSH);
        let Some(at) = hit(limit.min(self.t_max)) else { return };
        let better = self.hit.is_none_or(|best| {
            let (a, b) = (self.rank(at.t, index), self.rank(best.at.t, best.primitive));
            a < b || a == b && index < best.primitive
        });
        if better {
            self.hit = Some(Hit { at, primitive: index });
        }
    }
}
