//! The intervals in which a ray is inside of a solid.
//!
//! Each part reports all its crossings along the whole ray, with an error bound of t. Crossings whose bounds overlap are
//! one place: all of them happen at once. The solid has a surface there if the ray is inside before and outside behind,
//! or the reverse. So faces that coincide leave no sheet between them, whatever rounding has made of their order.
//!
//! What a ray hits depends on the ray alone, not on the interval that is searched.

use super::crossings::{self, Change, Crossing};
use super::{Operation, Solid, coincidence_range};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::ShapeHit;

impl Solid {
    /// All hits along a ray, from its origin on, in order.
    #[inline(never)]
    pub(super) fn hits(&self, ray: &TraversalRay) -> Vec<ShapeHit> {
        let range = coincidence_range(ray, self.0.reach);
        let count = self.0.parts.len();
        let mut changes = Vec::new();
        let mut states = Vec::with_capacity(count);
        for (of, shape) in self.0.parts.iter().enumerate() {
            let from = changes.len();
            let begins_inside = crossings::changes((of, shape), ray, range, &mut changes);
            if changes.len() == from && !begins_inside && self.needs(of) {
                return Vec::new();
            }
            states.push(begins_inside);
        }
        changes.sort_by(|a, b| a.low.total_cmp(&b.low).then(a.of.cmp(&b.of)));
        let mut hits = Vec::new();
        let mut from = 0;
        while from < changes.len() {
            let mut high = changes[from].high;
            let more = changes[from + 1..].iter().take_while(|next| {
                let joins = next.low <= high;
                high = if joins && high < next.high { next.high } else { high };
                joins
            });
            let to = from + 1 + more.count();
            self.place(&changes[from..to], &mut states, &mut hits);
            from = to;
        }
        for index in 1..hits.len() {
            if hits[index].t <= range.end(hits[index - 1].t) {
                hits[index - 1].coincident = true;
                hits[index].coincident = true;
            }
        }
        hits
    }

    /// Adds the hits of a place, and brings the states of the parts behind it.
    fn place(&self, changes: &[Change], states: &mut [bool], hits: &mut Vec<ShapeHit>) {
        let was = states.to_vec();
        for change in changes {
            states[change.of] = change.after;
        }
        let hit = |of: usize, at: &Crossing| ShapeHit::of_part(at.t, self.0.first[of] + at.part);
        if self.0.is_open {
            let is_kept = |states: &[bool]| states[1..].iter().all(|inside| *inside);
            if is_kept(&was) || is_kept(states) {
                let own = changes.iter().filter(|change| change.of == 0);
                hits.extend(own.flat_map(|change| change.crossings.iter().map(|at| hit(0, at))));
            }
            return;
        }
        let enters = self.0.operation.is_inside(states);
        if self.0.operation.is_inside(&was) == enters {
            return;
        }
        // The first part in the order of the file that turns the same way.
        let all = changes.iter().flat_map(|change| change.crossings.iter().map(|at| (change.of, at)));
        let best = all.min_by(|(a, at), (b, other)| {
            let is_other = |of: usize, at: &Crossing| (at.enters != self.is_turned(of)) != enters;
            let order = is_other(*a, at).cmp(&is_other(*b, other)).then(a.cmp(b));
            order.then(at.t.total_cmp(&other.t))
        });
        hits.extend(best.map(|(of, at)| hit(of, at)));
    }

    /// Whether nothing is inside of the solid that is outside of a part.
    fn needs(&self, part: usize) -> bool {
        match self.0.operation {
            Operation::Intersection => true,
            Operation::Difference => part == 0,
            Operation::Union => false,
        }
    }
}
