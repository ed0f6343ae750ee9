//! The tree over a scene's primitives.
//!
//! Rays come eight at a time. What stands in no tree is tested with all of them at once; the tree is walked along all
//! of them where they go the same way, and one by one where they do not. The tree only decides what is skipped: hits are
//! those of the primitives, and of equally near ones the first in the file wins.

mod bundle;
mod nearest;
mod single;
#[cfg(test)]
mod tests;

pub use nearest::{LaneHits, NOTHING};

use crate::base::lanes::{Level, Mask, lanes};
use crate::base::math::LaneRay;
use crate::geometry::bvh::{BundleStack, Contents, Probe, Stack, Tree};
use crate::geometry::shape::{Crossing, PreparedRay, RayRows, Shape, Span};
use crate::scene::Geometry;
use bundle::Shadow;
use nearest::Nearest;

/// A tree over the primitives that fill boxes, and the few that stand beside it.
#[derive(Clone, Debug, Default)]
pub struct Bvh {
    tree: Tree,
    /// Indices of the primitives of each leaf.
    leaves: Contents,
    /// Indices of primitives that are tested without a walk: infinite ones, or all where they are few.
    direct: Vec<u32>,
    /// Indices of meshes that stand beside the tree: each has its own.
    meshes: Vec<u32>,
    /// The largest of the coordinates between which all bounded primitives lie, and of those of planes.
    reach: f64,
    /// Whether there is so little to walk that rays which go different ways do it together, too.
    is_small: bool,
}

/// Where a ray meets a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    pub at: Crossing,
    /// Index into the geometry's primitives.
    pub primitive: u32,
}

/// How rays of a stage lie to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coherence {
    /// Eight neighbours go the same way: from the eye, or to a light.
    Together,
    Apart,
}

/// Fewer bounded primitives than this need no tree: to test all of them takes no longer than to walk one.
const FEW: usize = 6;

/// Room for walks, along single rays and along bundles. What is in it before and after means nothing.
#[derive(Default)]
pub struct Stacks {
    single: Stack,
    bundle: BundleStack,
}

/// Which primitives let light pass at some point of theirs, so that shadow rays do not end there: a flag each.
#[derive(Clone, Copy, Debug)]
pub struct Passing<'a>(pub &'a [bool]);

/// Shadow rays that something stands in the way of.
#[derive(Clone, Copy, Debug)]
pub struct Occlusion<M> {
    pub blocked: M,
    /// Others that meet what lets light pass.
    pub dimmed: M,
}

impl Bvh {
    /// A tree over `geometry`. The same geometry gives the same tree.
    pub fn build(geometry: &Geometry) -> Self {
        let (mut bounded, mut boxes, mut direct) = (Vec::new(), Vec::new(), Vec::new());
        for (index, primitive) in (0..).zip(&geometry.primitives) {
            match primitive.bounds() {
                Some(bounds) => {
                    bounded.push(index);
                    boxes.push(bounds);
                }
                None => direct.push(index),
            }
        }
        let (mut tree, mut leaves) = Tree::of_boxes(&boxes);
        let anchors = geometry.primitives.iter().filter_map(|primitive| match &primitive.shape {
            Shape::Plane(plane) => Some(plane.point.abs().max_element()),
            _ => None,
        });
        let reach = anchors.fold(tree.space().reach(), f64::max);
        let mut meshes = Vec::new();
        if bounded.len() < FEW {
            (tree, leaves) = Default::default();
            for index in bounded.drain(..) {
                let is_mesh = matches!(geometry.primitives[index as usize].shape, Shape::Mesh(_));
                if is_mesh { meshes.push(index) } else { direct.push(index) }
            }
            direct.sort_unstable();
        }
        leaves.renumber(|thing| bounded[thing as usize]);
        let mut shapes = geometry.primitives.iter().map(|primitive| &primitive.shape);
        let is_small = tree.is_small() && !shapes.any(|shape| matches!(shape, Shape::Mesh(_)));
        Self { tree, leaves, direct, meshes, reach, is_small }
    }

    /// The largest of the coordinates between which all bounded primitives lie, and of those of planes.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// The nearest primitives along the rays in the lanes of a mask, within bounds.
    #[inline(always)]
    pub fn intersect<L: Level>(
        &self,
        geometry: &Geometry,
        ray: &LaneRay<L::F64>,
        within: Span<L::F64>,
        wanted: L::Mask,
        coherence: Coherence,
        stacks: &mut Stacks,
    ) -> LaneHits<L::F64> {
        let prepared = PreparedRay::new(*ray);
        let mut nearest = Nearest::new(&prepared, self.reach, within, wanted);
        nearest.test(geometry, &self.direct);
        if self.tree.is_empty() && self.meshes.is_empty() {
            return nearest.hits;
        }
        if self.is_small || coherence == Coherence::Together {
            nearest.test(geometry, &self.meshes);
            if !self.tree.is_empty() {
                self.closest_together::<L>(geometry, &mut nearest, &mut stacks.bundle);
            }
            return nearest.hits;
        }
        let rays = RayRows::of(ray);
        let mut hits = nearest.hits.store();
        let within = nearest.bounds();
        for lane in lanes(wanted.bits()) {
            let probe = Probe::new(rays.one(lane));
            let span = Span { min: within[0][lane], max: within[1][lane] };
            let hit =
                self.closest_on::<L::Narrow>(geometry, &probe, span, hits.lane(lane), &mut stacks.single);
            hits.set_lane(lane, hit);
        }
        hits.load()
    }

    /// The rays in the lanes of a mask that anything stands in the way of, within bounds.
    #[inline(always)]
    pub fn occlusion<L: Level>(
        &self,
        geometry: &Geometry,
        ray: &LaneRay<L::F64>,
        within: Span<L::F64>,
        wanted: L::Mask,
        (coherence, passing): (Coherence, Option<Passing>),
        stacks: &mut Stacks,
    ) -> Occlusion<L::Mask> {
        let prepared = PreparedRay::new(*ray);
        let mut found = Shadow::<L>::new(&prepared, within, wanted, passing);
        found.test(geometry, &self.direct, wanted);
        if (self.tree.is_empty() && self.meshes.is_empty()) || !found.open().any() {
            return found.occlusion();
        }
        if self.is_small || coherence == Coherence::Together {
            found.test(geometry, &self.meshes, found.open());
            if !self.tree.is_empty() && found.open().any() {
                self.occluded_together::<L>(geometry, &mut found, &mut stacks.bundle);
            }
            return found.occlusion();
        }
        let rays = RayRows::of(ray);
        let bounds = found.bounds();
        let mut bits = found.bits();
        for lane in lanes(found.open().bits()) {
            let probe = Probe::new(rays.one(lane));
            let span = Span { min: bounds[0][lane], max: bounds[1][lane] };
            let [blocked, dimmed] =
                self.occluded_on::<L::Narrow>(geometry, &probe, span, passing, &mut stacks.single);
            bits[0] |= u32::from(blocked) << lane;
            bits[1] |= u32::from(dimmed) << lane;
        }
        Occlusion { blocked: L::Mask::from_bits(bits[0]), dimmed: L::Mask::from_bits(bits[1] & !bits[0]) }
    }
}

/// Whether light passes a primitive.
#[inline(always)]
fn lets_pass(passing: Option<Passing>, index: u32) -> bool {
    passing.is_some_and(|Passing(flags)| flags[index as usize])
}
