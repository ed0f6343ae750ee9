//! The intervals in which a ray is inside of a solid.
//!
//! Each part reports all its hits along the whole ray, with bounds of the error of t. Hits whose bounds overlap are one
//! place: all of them happen at once. The solid has a surface there if the ray is inside before and outside behind, or
//! the reverse. So faces that coincide leave no sheet between them, whatever rounding has made of their order.
//!
//! What a ray hits depends on the ray alone, not on the interval that is searched.

use super::part_intervals::{IntervalEnd, PartHit, PartIntervals};
use super::{Operation, Solid, coincidence_range};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::ShapeHit;
use std::cell::RefCell;

/// What a search along a ray needs. It is kept for the next ray.
#[derive(Default)]
struct IntervalBuffer {
    parts: PartIntervals,
    /// Whether the ray is inside of each part.
    inside: Vec<bool>,
    hits: Vec<ShapeHit>,
}

thread_local! {
    /// Buffers that are not in use. Solids within solids take one each.
    static BUFFERS: RefCell<Vec<IntervalBuffer>> = const { RefCell::new(Vec::new()) };
}

impl Solid {
    /// Passes all hits along a ray to `take`, from its origin on, in order.
    #[inline(never)]
    pub(super) fn with_hits<T>(&self, ray: &TraversalRay, take: impl FnOnce(&[ShapeHit]) -> T) -> T {
        let mut buffer = BUFFERS.with_borrow_mut(Vec::pop).unwrap_or_default();
        self.search(ray, &mut buffer);
        let result = take(&buffer.hits);
        BUFFERS.with_borrow_mut(|all| all.push(buffer));
        result
    }

    fn search(&self, ray: &TraversalRay, buffer: &mut IntervalBuffer) {
        let IntervalBuffer { parts, inside, hits } = buffer;
        parts.clear();
        inside.clear();
        hits.clear();
        let range = coincidence_range(ray, self.0.reach);
        for (of, shape) in self.0.parts.iter().enumerate() {
            let first = parts.ends.len();
            let begins_inside = parts.add((of, shape), ray, range);
            if parts.ends.len() == first && !begins_inside && self.needs(of) {
                return;
            }
            inside.push(begins_inside);
        }
        let PartIntervals { hits: all, ends } = parts;
        ends.sort_by(|a, b| a.low.total_cmp(&b.low).then(a.of.cmp(&b.of)));
        let mut rest = &ends[..];
        while let Some(first) = rest.first() {
            let mut high = first.high;
            let more = rest[1..].iter().take_while(|next| {
                let joins = next.low <= high;
                high = if joins && high < next.high { next.high } else { high };
                joins
            });
            let (place, behind) = rest.split_at(1 + more.count());
            self.add_hits((place, all), inside, hits);
            rest = behind;
        }
        for index in 1..hits.len() {
            if hits[index].t <= range.end(hits[index - 1].t) {
                hits[index - 1].coincident = true;
                hits[index].coincident = true;
            }
        }
    }

    /// Adds the hits of a place, and updates the sides of all parts to those behind it.
    fn add_hits(
        &self,
        (place, all): (&[IntervalEnd], &[PartHit]),
        inside: &mut [bool],
        hits: &mut Vec<ShapeHit>,
    ) {
        let was = self.keeps(inside);
        for end in place {
            inside[end.of] = end.after;
        }
        let is = self.keeps(inside);
        let mut each = place.iter().flat_map(|end| all[end.hits.clone()].iter().map(|hit| (end.of, hit)));
        let shape_hit = |(of, at): (usize, &PartHit)| ShapeHit::of_part(at.t, self.0.first[of] + at.part);
        if self.0.is_open {
            if was || is {
                hits.extend(each.filter(|(of, _)| *of == 0).map(shape_hit));
            }
        } else if was != is {
            // The first part in the order of the file whose face turns the same way.
            let first = each.next().map(|first| {
                each.fold(first, |best, next| {
                    let rank = |(of, at): (usize, &PartHit)| ((at.enters() != self.is_turned(of)) != is, of);
                    let is_better = (rank(next), next.1.t) < (rank(best), best.1.t);
                    if is_better { next } else { best }
                })
            });
            hits.extend(first.map(shape_hit));
        }
    }

    /// Whether a place belongs to the solid, or to a shape that encloses nothing, is left by the cuts.
    fn keeps(&self, inside: &[bool]) -> bool {
        match self.0.is_open {
            true => inside[1..].iter().all(|inside| *inside),
            false => self.0.operation.is_inside(inside),
        }
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
