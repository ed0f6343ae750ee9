//! The tree over a scene's geometry: finds the nearest primitive along a ray.
//!
//! A tie goes to the lower index, so neither the tree's layout nor its builder shows in a picture.

#[cfg(test)]
mod tests;

use crate::scene::Geometry;
use crate::shape::Crossing;
use crate::tree::{Probe, Tree};

/// A tree over the bounded primitives, and the list of those that no box holds.
#[derive(Clone, Debug, Default)]
pub struct Bvh {
    tree: Tree,
    /// Indices of infinite primitives.
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
        let (mut bounded, mut unbounded) = (Vec::new(), Vec::new());
        for (index, primitive) in (0..).zip(&geometry.primitives) {
            match primitive.bounds() {
                Some(bounds) => bounded.push((index, bounds)),
                None => unbounded.push(index),
            }
        }
        Self { tree: Tree::build(bounded), unbounded }
    }

    /// The nearest primitive along the ray beyond t = 0; of equally near ones the first in the file.
    pub fn closest(&self, geometry: &Geometry, probe: &Probe) -> Option<Hit> {
        self.closest_before(geometry, probe, f64::INFINITY)
    }

    /// [`Bvh::closest`] among what lies before `t_max`.
    pub fn closest_before(&self, geometry: &Geometry, probe: &Probe, t_max: f64) -> Option<Hit> {
        let mut nearest = Nearest { geometry, probe, t_max, hit: None };
        nearest.test(&self.unbounded);
        let limit = nearest.t();
        self.tree.visit(probe, limit, |leaf| {
            nearest.test(leaf);
            nearest.t()
        });
        nearest.hit
    }

    /// Whether anything lies on the ray in 0 < t < `t_max`.
    pub fn occluded(&self, geometry: &Geometry, probe: &Probe, t_max: f64) -> bool {
        let blocks = |&i: &u32| geometry.primitives[i as usize].blocks(probe, t_max);
        if self.unbounded.iter().any(blocks) {
            return true;
        }
        let mut found = false;
        self.tree.visit(probe, t_max, |leaf| {
            found = leaf.iter().any(blocks);
            // Nothing is nearer than a t below zero: the walk ends.
            if found { -1.0 } else { t_max }
        });
        found
    }
}

struct Nearest<'a> {
    geometry: &'a Geometry,
    probe: &'a Probe,
    t_max: f64,
    hit: Option<Hit>,
}

impl Nearest<'_> {
    fn t(&self) -> f64 {
        self.hit.map_or(self.t_max, |hit| hit.at.t)
    }

    fn test(&mut self, leaf: &[u32]) {
        for &index in leaf {
            // One number beyond the best, so that an equally near hit is found and the indices decide.
            let limit = self.hit.map_or(self.t_max, |best| best.at.t.next_up());
            let Some(at) = self.geometry.primitives[index as usize].hit(self.probe, limit) else { continue };
            let better = self.hit.is_none_or(|best| at.t < best.at.t || index < best.primitive);
            if better {
                self.hit = Some(Hit { at, primitive: index });
            }
        }
    }
}
