//! Boxes of triangles. A long triangle is cut, as its box would be large and mostly empty.

use super::bounds::{Bounds, Boxed};
use crate::base::lanes::prefetch;
use crate::base::math::DVec3;
use crate::geometry::bvh::Space;
use glam::Vec4;
use rayon::prelude::*;

/// Triangles whose boxes are made, and whose areas are summed, together.
const TOGETHER: usize = 1 << 14;

/// How far triangles rounded to f32 in the tree's space may be from themselves, and how far their boxes are widened.
const WIDENED: f64 = 2.0 * f32::EPSILON as f64;

/// Boxes smaller than this, times their mean, are not cut.
const SMALL: f32 = 0.75;

/// Triangles whose shadows come to more than this share of their box are not cut.
const SLENDER: f32 = 0.25;

/// A cut has to leave less than this share of a box.
const WORTH: f32 = 0.6;

/// The boxes of triangles in the tree's space.
pub fn boxes(space: &Space, positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<Boxed> {
    let count = triangles.len() as u32;
    let corners = |triangle: u32| corners(space, positions, triangles[triangle as usize]);
    let whole = |triangle| {
        fetch_ahead(positions, triangles, triangle as usize);
        let corners = corners(triangle);
        let bounds = around(&corners);
        Boxed::new(triangle, bounds).marked(shadows(corners) < SLENDER * bounds.measure())
    };
    let mut boxes: Vec<_> = match triangles.len() < 2 * TOGETHER {
        true => (0..count).map(whole).collect(),
        false => (0..count).into_par_iter().with_min_len(TOGETHER).map(whole).collect(),
    };
    let sum = |boxes: &[Boxed]| boxes.iter().map(|boxed| f64::from(boxed.bounds().measure())).sum::<f64>();
    // In parts of their own, as sums depend on the order.
    let sums: Vec<_> = boxes.par_chunks(TOGETHER).map(sum).collect();
    let mean = sums.into_iter().sum::<f64>() / f64::from(count);
    let small = SMALL * mean as f32;
    let cut = |(place, boxed): (usize, &Boxed)| {
        let mut pieces = Pieces { thing: boxed.thing(), small, boxes: Vec::new() };
        pieces.cut(&Polygon::new(&corners(boxed.thing())), boxed.bounds(), 0);
        (place, pieces.boxes)
    };
    let is_long = |(_, boxed): &(usize, &Boxed)| boxed.is_marked() && boxed.bounds().measure() > small;
    let pieces: Vec<_> = boxes.par_iter().enumerate().filter(is_long).map(cut).collect();
    boxes.reserve_exact(pieces.iter().map(|(_, pieces)| pieces.len()).sum());
    for (place, pieces) in pieces {
        if let Some((first, others)) = pieces.split_first() {
            boxes[place] = *first;
            boxes.extend_from_slice(others);
        }
    }
    boxes
}

/// Triangles between asking for one's corners and needing them.
const AHEAD: usize = 16;

/// Asks for the corners of a triangle that comes up soon after another one.
#[inline(always)]
pub fn fetch_ahead(positions: &[DVec3], triangles: &[[u32; 3]], now: usize) {
    if let Some(soon) = triangles.get(now + AHEAD) {
        soon.iter().for_each(|&vertex| prefetch(positions, vertex as usize));
    }
}

#[inline(always)]
fn corners(space: &Space, positions: &[DVec3], [a, b, c]: [u32; 3]) -> [DVec3; 3] {
    let point = |vertex: u32| space.point(positions[vertex as usize]);
    [point(a), point(b), point(c)]
}

/// The areas of a triangle's shadows along the axes. However it is cut, the boxes of its pieces come to no less; half
/// way down to that, in most cases, if it is cut once.
fn shadows([a, b, c]: [DVec3; 3]) -> f32 {
    let doubled = (b - a).cross(c - a).abs();
    (0.5 * (doubled.x + doubled.y + doubled.z)) as f32
}

/// A box around points, rounded outwards.
#[inline(always)]
fn around(points: &[DVec3]) -> Bounds {
    // Rounding keeps the order: the least of rounded numbers is the least one rounded, and takes half as long to find.
    let row = |point: DVec3| Vec4::from((point.as_vec3(), 0.0));
    points
        .iter()
        .fold(Bounds::EMPTY, |all, &point| Bounds {
            low: all.low.min(row(point - WIDENED)),
            high: all.high.max(row(point + WIDENED)),
        })
        .tamed()
}

/// Cuts above each other at most.
const DEEPEST: u32 = 12;

/// The pieces of a triangle.
struct Pieces {
    thing: u32,
    small: f32,
    boxes: Vec<Boxed>,
}

impl Pieces {
    /// Cuts a polygon with its box in the middle, again and again while that pays.
    fn cut(&mut self, polygon: &Polygon, bounds: Bounds, depth: u32) {
        let measure = bounds.measure();
        if measure > self.small && depth < DEEPEST && polygon.count <= MOST_CORNERS {
            let axis = bounds.longest();
            let [a, b] =
                polygon.cut(axis, 0.5 * (f64::from(bounds.low[axis]) + f64::from(bounds.high[axis])));
            let (c, d) = (around(a.corners()), around(b.corners()));
            if c.measure() + d.measure() < WORTH * measure {
                self.cut(&a, c, depth + 1);
                self.cut(&b, d, depth + 1);
                return;
            }
        }
        if depth > 0 {
            self.boxes.push(Boxed::new(self.thing, bounds));
        }
    }
}

/// What planes across the axes leave of a triangle has so many corners at most; what rounding adds is not cut.
const MOST_CORNERS: usize = 9;

/// Corners in order around.
#[derive(Clone, Copy)]
struct Polygon {
    /// With room for as many again: if rounding has bent it, a polygon may be crossed at every edge.
    corners: [DVec3; 2 * MOST_CORNERS],
    count: usize,
}

impl Polygon {
    fn new(corners: &[DVec3]) -> Self {
        let mut polygon = Self { corners: [DVec3::ZERO; 2 * MOST_CORNERS], count: 0 };
        corners.iter().for_each(|&corner| polygon.push(corner));
        polygon
    }

    fn corners(&self) -> &[DVec3] {
        &self.corners[..self.count]
    }

    fn push(&mut self, corner: DVec3) {
        self.corners[self.count] = corner;
        self.count += 1;
    }

    /// The parts on both sides of a plane across an axis.
    fn cut(&self, axis: usize, place: f64) -> [Self; 2] {
        let [mut below, mut above] = [Self::new(&[]); 2];
        for (i, &a) in self.corners().iter().enumerate() {
            let b = self.corners[(i + 1) % self.count];
            if a[axis] <= place {
                below.push(a);
            }
            if a[axis] >= place {
                above.push(a);
            }
            if a[axis] < place && b[axis] > place || a[axis] > place && b[axis] < place {
                let mut crossing = a + (b - a) * ((place - a[axis]) / (b[axis] - a[axis]));
                crossing[axis] = place;
                below.push(crossing);
                above.push(crossing);
            }
        }
        [below, above]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    /// Every point of a triangle is in the box of one of its pieces, and the pieces of slender ones are many.
    #[test]
    fn pieces_hold_their_triangles() {
        let mut random = Random(7);
        let triangles: Vec<[DVec3; 3]> = (0..400)
            .map(|i| {
                let (a, long) = (random.point(0.4), random.point(0.4));
                let short = if i % 4 == 0 { 0.3 } else { 1e-3 };
                [a, a + long * if i % 4 == 1 { 0.01 } else { 1.0 }, a + random.point(short)]
            })
            .collect();
        // Its space is the world.
        let space = Space { per: 1.0, size: 1.0, ..Space::default() };
        let positions: Vec<DVec3> = triangles.iter().flatten().copied().collect();
        let indices: Vec<_> = (0..400).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let boxes = boxes(&space, &positions, &indices);
        assert!(boxes.len() > 500, "{}", boxes.len());
        for (i, [a, b, c]) in (0..).zip(&triangles) {
            let own: Vec<_> = boxes.iter().filter(|boxed| boxed.thing() == i).map(Boxed::bounds).collect();
            for _ in 0..200 {
                let (u, v) = (random.unit(), random.unit());
                let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                let point = (*a + (*b - *a) * u + (*c - *a) * v).to_array();
                let holds = |bounds: &Bounds| {
                    let [low, high] = bounds.corners();
                    (0..3).all(|k| f64::from(low[k]) <= point[k] && point[k] <= f64::from(high[k]))
                };
                assert!(own.iter().any(holds));
            }
        }
    }
}
