//! The intervals in which a ray is inside of a solid.
//!
//! Each part reports all its hits along the whole ray, with bounds of the error of t. Hits whose bounds overlap are one
//! place: all of them happen at once. The solid has a surface there if the ray is inside before and outside behind, or
//! the reverse. So faces that coincide leave no sheet between them, whatever rounding has made of their order.
//!
//! What a ray hits depends on the ray alone, not on the interval that is searched.

use super::crossings::{Crossings, PartHit};
use super::part_intervals::{IntervalEnd, PartIntervals};
use super::solid_rays::SolidRays;
use super::{Operation, Solid};
use crate::base::lanes::{LaneKernel, Level, Mask, Real, lanes};
use crate::geometry::shape::{CoincidenceRange, RayInterval, ShapeHit};
use std::cell::RefCell;

/// What a search along a ray needs.
#[derive(Default)]
struct IntervalBuffer {
    parts: PartIntervals,
    /// Whether the ray is inside of each part.
    inside: Vec<bool>,
    hits: Vec<ShapeHit>,
}

/// What a search along eight rays needs. It is kept for the next rays.
#[derive(Default)]
struct SearchBuffer {
    lanes: [IntervalBuffer; 8],
    crossings: Crossings,
}

thread_local! {
    /// Buffers that are not in use. Solids within solids take one each.
    #[expect(clippy::vec_box, reason = "every search moves a buffer from the list and back: a pointer, not a kilobyte")]
    static BUFFERS: RefCell<Vec<Box<SearchBuffer>>> = const { RefCell::new(Vec::new()) };
}

/// All hits of a solid along the ray of each lane, from its origin on, in order. None only while it is dropped.
pub struct SolidHits(Option<Box<SearchBuffer>>);

impl SolidHits {
    pub fn of(&self, lane: usize) -> &[ShapeHit] {
        self.0.as_ref().map_or(&[], |buffer| &buffer.lanes[lane].hits)
    }
}

impl Drop for SolidHits {
    fn drop(&mut self) {
        BUFFERS.with_borrow_mut(|all| all.extend(self.0.take()));
    }
}

/// The search along the rays in the lanes of a mask.
struct Search<'a, F: Real> {
    solid: &'a Solid,
    rays: &'a SolidRays<'a, F>,
    wanted: F::Mask,
    buffer: &'a mut SearchBuffer,
}

impl<F: Real> LaneKernel<F::Level> for Search<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { solid, rays, wanted, buffer } = self;
        let SearchBuffer { lanes: buffers, crossings } = buffer;
        for IntervalBuffer { parts, inside, hits } in buffers.iter_mut() {
            parts.clear();
            inside.clear();
            hits.clear();
        }
        let (range, mut open) = (rays.prepared.coincidence_range(solid.0.reach), wanted);
        for (of, (shape, surroundings)) in solid.0.parts.iter().zip(&solid.0.part_surroundings).enumerate() {
            // Nothing with bounds is inside of what it does not meet.
            let mut meets = open;
            if let Some(surroundings) = surroundings {
                let within = RayInterval::up_to(F::splat(f64::INFINITY));
                meets = open & rays.may_meet(surroundings, within);
            }
            if meets.any() {
                crossings.find(shape, rays, range, meets);
            }
            for lane in lanes(open.bits()) {
                let IntervalBuffer { parts, inside, .. } = &mut buffers[lane];
                let first = parts.ends.len();
                let begins_inside = meets.bits() >> lane & 1 == 1
                    && parts.add((of, shape), &rays.stored.one(lane), crossings.of(lane));
                if parts.ends.len() == first && !begins_inside && solid.needs(of) {
                    open = open & !F::Mask::from_bits(1 << lane);
                }
                inside.push(begins_inside);
            }
            if !open.any() {
                return;
            }
        }
        for lane in lanes(open.bits()) {
            solid.combine(&mut buffers[lane], range.lane(lane));
        }
    }
}

impl Solid {
    /// All hits along the rays in the lanes of a mask.
    #[inline(always)]
    pub(super) fn hits<F: Real>(&self, rays: &SolidRays<F>, wanted: F::Mask) -> SolidHits {
        let mut buffer = BUFFERS.with_borrow_mut(Vec::pop).unwrap_or_default();
        F::Level::call_with(Search { solid: self, rays, wanted, buffer: &mut buffer });
        SolidHits(Some(buffer))
    }

    /// Finds the hits of the solid among those of its parts along one ray.
    #[inline(never)]
    fn combine(&self, buffer: &mut IntervalBuffer, range: CoincidenceRange<f64>) {
        let IntervalBuffer { parts: PartIntervals { hits: all, ends }, inside, hits } = buffer;
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
