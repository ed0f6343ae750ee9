//! Boxes of triangles. A long triangle is cut, as its box would be large and mostly empty.

use super::bounds::{Bounds, Boxed};
use crate::math::DVec3;
use rayon::prelude::*;

/// Triangles whose boxes are made, and whose areas are summed, together.
const TOGETHER: usize = 1 << 14;

/// How far triangles rounded to f32 in the tree's space may be from themselves, and how far their boxes are widened.
const WIDENED: f64 = 2.0 * f32::EPSILON as f64;

/// Boxes smaller than this, times their mean, are not cut.
const SMALL: f32 = 3.0;

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
        let mut pieces = Pieces { thing: boxed.thing(), small, boxes: Vec::new() };
        pieces.cut(&corners(boxed.thing()), boxed.bounds(), 0);
        pieces.boxes
    };
    let large = |boxed: &&Boxed| boxed.bounds().measure() > small;
    let pieces: Vec<_> = boxes.par_iter().filter(large).map(cut).collect();
    if !pieces.is_empty() {
        boxes.retain(|boxed| boxed.bounds().measure() <= small);
        boxes.extend(pieces.into_iter().flatten());
    }
    boxes
}

/// A box around points, rounded outwards.
fn around(points: &[DVec3]) -> Bounds {
    let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (low, high) = points.iter().fold(start, |(low, high), p| (low.min(*p), high.max(*p)));
    Bounds::new([low - WIDENED, high + WIDENED].map(|corner| corner.as_vec3().to_array()))
}

/// Cuts above each other at most.
const DEEPEST: u32 = 12;

/// Places along its longest side where a box may be cut.
const PLACES: u32 = 8;

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
            let (low, high) = (f64::from(bounds.low[axis]), f64::from(bounds.high[axis]));
            let step = (high - low) / f64::from(PLACES);
            let cuts = (1..PLACES).map(|i| {
                let place = low + step * f64::from(i);
                let sides = sides(corners, axis, place);
                let bounds = [around(&sides[0]), around(&sides[1])];
                (bounds[0].measure() + bounds[1].measure(), sides, bounds)
            });
            let best = cuts.min_by(|a, b| a.0.total_cmp(&b.0));
            if let Some((sum, [a, b], [c, d])) = best
                && sum < WORTH * measure
            {
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
