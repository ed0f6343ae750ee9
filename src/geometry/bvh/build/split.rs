//! Boxes in two halves, so that rays have the least to do with both.

use super::bins;
use super::bounds::{Bounds, Boxed};
use super::partition::partition;

/// Boxes that one thread works through at a time where there are several such groups.
pub const TOGETHER: usize = 1 << 14;

/// Splits above each other before boxes are halved as they come.
const DEEPEST: u32 = 64;

/// So few boxes are put in order instead of into bins.
const FEW: usize = 8;

/// What a split gives.
pub struct Halves {
    /// How many boxes are on the left side; they stand before the others.
    pub left: usize,
    /// Of the boxes on both sides, and of twice their centres.
    pub bounds: [Bounds; 2],
    pub centres: [Bounds; 2],
}

/// Splits two boxes or more, with twice their centres in `centres`, below `depth` splits.
#[inline(never)]
pub fn split(boxes: &mut [Boxed], centres: &Bounds, depth: u32) -> Halves {
    if boxes.len() <= FEW {
        return sweep(boxes, centres);
    }
    if depth < DEEPEST
        && let Some(split) = bins::split(boxes, centres)
    {
        let (left, centres) = partition(boxes, |boxed| split.is_left(boxed));
        return Halves { left, bounds: split.bounds, centres };
    }
    let left = boxes.len() / 2;
    let (a, b) = boxes.split_at(left);
    let (a, b) = (Bounds::both(a), Bounds::both(b));
    Halves { left, bounds: [a[0], b[0]], centres: [a[1], b[1]] }
}

/// Tries every split between few boxes in the order of their centres, along the axis on which these are farthest apart.
#[inline(always)]
fn sweep(boxes: &mut [Boxed], centres: &Bounds) -> Halves {
    let (count, axis) = (boxes.len(), centres.longest());
    for sorted in 1..count {
        let (boxed, mut place) = (boxes[sorted], sorted);
        while place > 0 && boxed.centre_along(axis) < boxes[place - 1].centre_along(axis) {
            boxes[place] = boxes[place - 1];
            place -= 1;
        }
        boxes[place] = boxed;
    }
    if let [a, b] = boxes {
        let (a, b) = (Bounds::both(&[*a]), Bounds::both(&[*b]));
        return Halves { left: 1, bounds: [a[0], b[0]], centres: [a[1], b[1]] };
    }
    let mut right = [[Bounds::EMPTY; 2]; FEW];
    let mut side = [Bounds::EMPTY; 2];
    for place in (1..count).rev() {
        side = [side[0].union(boxes[place].bounds()), side[1].with(boxes[place].centre())];
        right[place] = side;
    }
    let (mut least, mut left, mut of_left) = (f32::INFINITY, 1, [Bounds::EMPTY; 2]);
    side = [Bounds::EMPTY; 2];
    for place in 1..count {
        side = [side[0].union(boxes[place - 1].bounds()), side[1].with(boxes[place - 1].centre())];
        let cost = side[0].measure() * place as f32 + right[place][0].measure() * (count - place) as f32;
        // Of equal boxes the halves are.
        if cost < least || cost == least && place <= count / 2 {
            (least, left, of_left) = (cost, place, side);
        }
    }
    let of_right = right[left];
    Halves { left, bounds: [of_left[0], of_right[0]], centres: [of_left[1], of_right[1]] }
}
