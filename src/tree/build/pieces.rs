//! Boxes of triangles. A long triangle is cut, as its box would be large and mostly empty.

use super::bounds::{Bounds, Boxed};
use crate::math::DVec3;
use rayon::prelude::*;

/// Triangles whose boxes are made, and whose areas are summed, together.
const TOGETHER: usize = 1 << 14;

/// How far triangles rounded to f32 in the tree's space may be from themselves, and how far their boxes are widened.
const WIDENED: f64 = 2.0 * f32::EPSILON as f64;

/// Boxes smaller than this, times their mean, are not cut.
const SMALL: f32 = 0.75;

/// A cut has to leave less than this share of a box.
const WORTH: f32 = 0.6;

/// The boxes of triangles in the tree's space.
pub fn boxes(corners: impl Fn(u32) -> [DVec3; 3] + Sync, count: u32) -> Vec<Boxed> {
    let whole = |triangle| Boxed::new(triangle, around(&corners(triangle)));
    let mut boxes: Vec<_> = match (count as usize) < 2 * TOGETHER {
        true => (0..count).map(whole).collect(),
        false => (0..count).into_par_iter().with_min_len(TOGETHER).map(whole).collect(),
    };
    let sum = |boxes: &[Boxed]| boxes.iter().map(|boxed| f64::from(boxed.bounds().measure())).sum::<f64>();
    // In parts of their own, as sums depend on the order.
    let sums: Vec<_> = boxes.par_chunks(TOGETHER).map(sum).collect();
    let mean = sums.into_iter().sum::<f64>() / f64::from(count);
    let small = SMALL * mean as f32;
    let cut = |boxed: &Boxed| {
        let corners = corners(boxed.thing());
        let mut pieces = Pieces { thing: boxed.thing(), small, boxes: Vec::new() };
        if boxed.bounds().measure() > small && least(corners) < WORTH * boxed.bounds().measure() {
            pieces.cut(&corners, boxed.bounds(), 0);
        }
        (pieces.boxes.len() > 1).then_some(pieces.boxes)
    };
    let pieces: Vec<_> = boxes.par_iter().enumerate().filter_map(|(i, boxed)| Some((i, cut(boxed)?))).collect();
    for (i, pieces) in pieces {
        boxes[i] = pieces[0];
        boxes.extend_from_slice(&pieces[1..]);
    }
    boxes
}

/// What the boxes of a triangle's pieces come to at least, however it is cut: the areas of its shadows along the axes.
fn least([a, b, c]: [DVec3; 3]) -> f32 {
    (0.5 * (b - a).cross(c - a).abs().element_sum()) as f32
}

/// A box around points, rounded outwards.
fn around(points: &[DVec3]) -> Bounds {
    let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (low, high) = points.iter().fold(start, |(low, high), p| (low.min(*p), high.max(*p)));
    Bounds::new([low - WIDENED, high + WIDENED].map(|corner| corner.as_vec3().to_array()))
}

/// Cuts above each other at most.
const DEEPEST: u32 = 12;

/// Where a box may be cut.
fn place(low: f32, high: f32) -> f64 {
    f64::from(low) * 0.5 + f64::from(high) * 0.5
}

/// The pieces of a triangle.
struct Pieces {
    thing: u32,
    small: f32,
    boxes: Vec<Boxed>,
}

impl Pieces {
    /// Cuts what lies between some corners, in order around it.
    fn cut(&mut self, corners: &[DVec3], bounds: Bounds, depth: u32) {
        let measure = bounds.measure();
        if measure > self.small && depth < DEEPEST {
            let axis = bounds.longest();
            let place = place(bounds.low[axis], bounds.high[axis]);
            let [a, b] = sides(corners, axis, place);
            let (c, d) = (around(&a), around(&b));
            if c.measure() + d.measure() < WORTH * measure {
                self.cut(&a, c, depth + 1);
                self.cut(&b, d, depth + 1);
                return;
            }
        }
        self.boxes.push(Boxed::new(self.thing, bounds));
    }
}

/// The two parts of what lies between some corners, on both sides of a plane across an axis.
fn sides(corners: &[DVec3], axis: usize, place: f64) -> [Vec<DVec3>; 2] {
    let mut sides = [Vec::with_capacity(corners.len() + 2), Vec::with_capacity(corners.len() + 2)];
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        if a[axis] <= place {
            sides[0].push(a);
        }
        if a[axis] >= place {
            sides[1].push(a);
        }
        if (a[axis] < place) != (b[axis] < place) && a[axis] != place && b[axis] != place {
            let share = (place - a[axis]) / (b[axis] - a[axis]);
            let mut crossing = a + (b - a) * share;
            crossing[axis] = place;
            sides.iter_mut().for_each(|side| side.push(crossing));
        }
    }
    sides
}
