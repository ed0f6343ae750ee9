//! Partitions boxes in parallel, always into the same order.

use super::bounds::{Bounds, CHUNK, PrimRef};
use glam::{BVec4A, Vec4};
use rayon::prelude::*;

/// Moves the boxes of the left side to the front. Returns their number and the bounds of the doubled centres of both
/// sides.
pub fn partition(boxes: &mut [PrimRef], is_left: impl Fn(&PrimRef) -> bool + Sync) -> (usize, [Bounds; 2]) {
    if boxes.len() < 2 * CHUNK {
        return group(boxes, &is_left);
    }
    let groups: Vec<_> = boxes.par_chunks_mut(CHUNK).map(|boxes| group(boxes, &is_left)).collect();
    let left = groups.iter().map(|(left, _)| left).sum();
    let union = |[a, b]: [Bounds; 2], (_, [c, d]): &(usize, [Bounds; 2])| [a.union(*c), b.union(*d)];
    let centres = groups.iter().fold([Bounds::EMPTY; 2], union);
    exchange(boxes, left, groups.into_iter().map(|(left, _)| left).collect());
    (left, centres)
}

/// Each chunk already has its left boxes first; `lefts` holds their numbers. Swaps the boxes on the wrong side of
/// `left`.
fn exchange(boxes: &mut [PrimRef], left: usize, lefts: Vec<usize>) {
    let count = boxes.len();
    let groups = || lefts.iter().enumerate().map(|(i, lefts)| (i * CHUNK, i * CHUNK + lefts));
    let mut early = groups().map(|(begin, middle)| middle..(begin + CHUNK).min(count).min(left));
    let mut late = groups().map(|(begin, middle)| begin.max(left)..middle);
    let (front, back) = boxes.split_at_mut(left);
    let (mut a, mut b) = (0..0, 0..0);
    loop {
        while a.is_empty() {
            let Some(next) = early.next() else { return };
            a = next;
        }
        while b.is_empty() {
            let Some(next) = late.next() else { return };
            b = next;
        }
        let count = a.len().min(b.len());
        front[a.start..][..count].swap_with_slice(&mut back[b.start - left..][..count]);
        (a.start, b.start) = (a.start + count, b.start + count);
    }
}

/// [`partition`] of one chunk.
fn group(boxes: &mut [PrimRef], is_left: &impl Fn(&PrimRef) -> bool) -> (usize, [Bounds; 2]) {
    let [mut of_left, mut of_right] = [Bounds::EMPTY; 2];
    let mut left = 0;
    // Without branches, which the processor could not predict.
    for place in 0..boxes.len() {
        let (prim, first) = (boxes[place], boxes[left]);
        (boxes[place], boxes[left]) = (first, prim);
        let is_left = is_left(&prim);
        left += usize::from(is_left);
        let (centre, mask) = (prim.doubled_centre(), BVec4A::splat(is_left));
        of_left = of_left.union(Bounds {
            low: Vec4::select(mask, centre, Vec4::INFINITY),
            high: Vec4::select(mask, centre, Vec4::NEG_INFINITY),
        });
        of_right = of_right.union(Bounds {
            low: Vec4::select(mask, Vec4::INFINITY, centre),
            high: Vec4::select(mask, Vec4::NEG_INFINITY, centre),
        });
    }
    (left, [of_left, of_right])
}
