//! Splits boxes into two sides at the lowest traversal cost.

use super::bins;
use super::bounds::{Bounds, PrimRef};
use super::partition::partition;

/// Below this depth, boxes are halved in their order.
const DEEPEST: u32 = 64;

/// Up to this number, boxes are sorted instead of binned.
const FEW: usize = 8;

/// A split of boxes into a left and a right side.
pub struct SplitResult {
    /// Number of boxes on the left side, which precede the others.
    pub left: usize,
    /// Of each side, the bounds of its boxes, and of their doubled centres.
    pub bounds: [Bounds; 2],
    pub centres: [Bounds; 2],
}

/// Splits two boxes or more at `depth`. `centres` bounds their doubled centres.
#[inline(never)]
pub fn split(boxes: &mut [PrimRef], centres: &Bounds, depth: u32) -> SplitResult {
    if boxes.len() <= FEW {
        return sweep(boxes, centres);
    }
    if depth < DEEPEST
        && let Some(split) = bins::split(boxes, centres)
    {
        let (left, centres) = partition(boxes, |prim| split.is_left(prim));
        return SplitResult { left, bounds: split.bounds, centres };
    }
    let left = boxes.len() / 2;
    let (a, b) = boxes.split_at(left);
    let (a, b) = (Bounds::of_boxes_and_centres(a), Bounds::of_boxes_and_centres(b));
    SplitResult { left, bounds: [a[0], b[0]], centres: [a[1], b[1]] }
}

/// Sorts few boxes along the longest axis of their centres and tries every split between them.
#[inline(always)]
fn sweep(boxes: &mut [PrimRef], centres: &Bounds) -> SplitResult {
    let (count, axis) = (boxes.len(), centres.longest());
    for sorted in 1..count {
        let (prim, mut place) = (boxes[sorted], sorted);
        while place > 0 && prim.doubled_centre_along(axis) < boxes[place - 1].doubled_centre_along(axis) {
            boxes[place] = boxes[place - 1];
            place -= 1;
        }
        boxes[place] = prim;
    }
    if let [a, b] = boxes {
        let (a, b) = (Bounds::of_boxes_and_centres(&[*a]), Bounds::of_boxes_and_centres(&[*b]));
        return SplitResult { left: 1, bounds: [a[0], b[0]], centres: [a[1], b[1]] };
    }
    let mut right = [[Bounds::EMPTY; 2]; FEW];
    let mut side = [Bounds::EMPTY; 2];
    for place in (1..count).rev() {
        side = [side[0].union(boxes[place].bounds()), side[1].with(boxes[place].doubled_centre())];
        right[place] = side;
    }
    let (mut least, mut left, mut of_left) = (f32::INFINITY, 1, [Bounds::EMPTY; 2]);
    side = [Bounds::EMPTY; 2];
    for place in 1..count {
        side = [side[0].union(boxes[place - 1].bounds()), side[1].with(boxes[place - 1].doubled_centre())];
        let cost = side[0].half_area() * place as f32 + right[place][0].half_area() * (count - place) as f32;
        // Equal boxes are split in the middle.
        if cost < least || cost == least && place <= count / 2 {
            (least, left, of_left) = (cost, place, side);
        }
    }
    let of_right = right[left];
    SplitResult { left, bounds: [of_left[0], of_right[0]], centres: [of_left[1], of_right[1]] }
}
