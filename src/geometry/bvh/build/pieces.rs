//! Boxes of triangles. Long triangles are cut into pieces, because their boxes would be large and mostly empty.

use super::bounds::{Bounds, CHUNK, PrimRef};
use crate::base::lanes::prefetch;
use crate::base::math::DVec3;
use crate::geometry::bvh::TreeSpace;
use glam::Vec4;
use rayon::prelude::*;

/// Error of triangle corners that are rounded to f32 in the tree's space. Boxes are widened by it.
const WIDENED: f64 = 2.0 * f32::EPSILON as f64;

/// Only boxes larger than this multiple of the mean are cut.
const SMALL: f32 = 0.75;

/// Only triangles whose projected areas sum to less than this fraction of their box are cut.
const SLENDER: f32 = 0.25;

/// A cut is kept if the pieces' boxes have less than this fraction of the area.
const WORTH: f32 = 0.6;

/// The boxes of triangles in the tree's space.
pub fn boxes(space: &TreeSpace, positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<PrimRef> {
    let count = triangles.len() as u32;
    let corners = |triangle: u32| corners(space, positions, triangles[triangle as usize]);
    let whole = |triangle| {
        fetch_ahead(positions, triangles, triangle as usize);
        let corners = corners(triangle);
        let bounds = around(&corners);
        PrimRef::new(triangle, bounds).marked(projected_area(corners) < SLENDER * bounds.half_area())
    };
    let mut boxes: Vec<_> = match triangles.len() < 2 * CHUNK {
        true => (0..count).map(whole).collect(),
        false => (0..count).into_par_iter().with_min_len(CHUNK).map(whole).collect(),
    };
    let sum = |boxes: &[PrimRef]| boxes.iter().map(|prim| f64::from(prim.bounds().half_area())).sum::<f64>();
    // Sums depend on the order, so each fixed chunk has its own.
    let sums: Vec<_> = boxes.par_chunks(CHUNK).map(sum).collect();
    let mean = sums.into_iter().sum::<f64>() / f64::from(count);
    let small = SMALL * mean as f32;
    let cut = |(place, prim): (usize, &PrimRef)| {
        let mut pieces = Pieces { primitive: prim.primitive(), small, boxes: Vec::new() };
        pieces.cut(&Polygon::new(&corners(prim.primitive())), prim.bounds(), 0);
        (place, pieces.boxes)
    };
    let is_long = |(_, prim): &(usize, &PrimRef)| prim.is_marked() && prim.bounds().half_area() > small;
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

/// Distance, in triangles, between the prefetch of a triangle's corners and their use.
const AHEAD: usize = 16;

/// Prefetches the corners of a triangle that will be used soon.
#[inline(always)]
pub fn fetch_ahead(positions: &[DVec3], triangles: &[[u32; 3]], now: usize) {
    if let Some(soon) = triangles.get(now + AHEAD) {
        soon.iter().for_each(|&vertex| prefetch(positions, vertex as usize));
    }
}

#[inline(always)]
fn corners(space: &TreeSpace, positions: &[DVec3], [a, b, c]: [u32; 3]) -> [DVec3; 3] {
    let point = |vertex: u32| space.point(positions[vertex as usize]);
    [point(a), point(b), point(c)]
}

/// The box around a whole triangle.
#[inline(always)]
pub fn whole(space: &TreeSpace, positions: &[DVec3], triangle: [u32; 3]) -> Bounds {
    around(&corners(space, positions, triangle))
}

/// The sum of a triangle's areas projected along the axes. However the triangle is cut, the half areas of its pieces'
/// boxes sum to at least this. One cut usually closes half of the gap.
fn projected_area([a, b, c]: [DVec3; 3]) -> f32 {
    let doubled = (b - a).cross(c - a).abs();
    (0.5 * (doubled.x + doubled.y + doubled.z)) as f32
}

/// A box around points, rounded outwards.
#[inline(always)]
fn around(points: &[DVec3]) -> Bounds {
    // Rounding is monotonic, so the minimum of rounded numbers is the rounded minimum. This order takes half the time.
    let row = |point: DVec3| Vec4::from((point.as_vec3(), 0.0));
    points
        .iter()
        .fold(Bounds::EMPTY, |all, &point| Bounds {
            low: all.low.min(row(point - WIDENED)),
            high: all.high.max(row(point + WIDENED)),
        })
        .clamped()
}

/// Deepest recursion of cuts.
const DEEPEST: u32 = 12;

/// Cuts one triangle into pieces.
struct Pieces {
    primitive: u32,
    small: f32,
    boxes: Vec<PrimRef>,
}

impl Pieces {
    /// Cuts a polygon at the middle of its box, recursively, while that reduces the area.
    fn cut(&mut self, polygon: &Polygon, bounds: Bounds, depth: u32) {
        let half_area = bounds.half_area();
        if half_area > self.small && depth < DEEPEST && polygon.count <= MOST_CORNERS {
            let axis = bounds.longest();
            let [a, b] =
                polygon.cut(axis, 0.5 * (f64::from(bounds.low[axis]) + f64::from(bounds.high[axis])));
            let (c, d) = (around(a.corners()), around(b.corners()));
            if c.half_area() + d.half_area() < WORTH * half_area {
                self.cut(&a, c, depth + 1);
                self.cut(&b, d, depth + 1);
                return;
            }
        }
        if depth > 0 {
            self.boxes.push(PrimRef::new(self.primitive, bounds));
        }
    }
}

/// Most corners of a triangle clipped by axis-aligned planes. Polygons to which rounding added more are not cut.
const MOST_CORNERS: usize = 9;

/// The corners of a polygon, in order around it.
#[derive(Clone, Copy)]
struct Polygon {
    /// Room for twice as many: if rounding has bent the polygon, the plane may cross every edge.
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

    /// The parts on both sides of an axis-aligned plane.
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

    /// The boxes of a triangle's pieces cover it, and long thin triangles have many pieces.
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
        // The tree's space is the world.
        let space = TreeSpace { scale: 1.0, size: 1.0, ..TreeSpace::default() };
        let positions: Vec<DVec3> = triangles.iter().flatten().copied().collect();
        let indices: Vec<_> = (0..400).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let boxes = boxes(&space, &positions, &indices);
        assert!(boxes.len() > 500, "{}", boxes.len());
        for (i, [a, b, c]) in (0..).zip(&triangles) {
            let own: Vec<_> =
                boxes.iter().filter(|prim| prim.primitive() == i).map(PrimRef::bounds).collect();
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
