//! Polygons → triangles.

use crate::base::math::exact::Exact;
use crate::base::math::{DVec3, UNIT_ROUNDOFF};
use std::cmp::Ordering;

/// The most corners that are compared with ears, per corner of a polygon. It bounds the time for polygons of many
/// thousand corners, which are cut around a corner from there on.
const MOST_COMPARED: usize = 4096;

/// Cuts a polygon into triangles: a convex one around its first corner, any other by clipping ears (Meisters 1975), as
/// seen along the coordinate axis that is nearest to its normal. What has no ear, because it crosses itself, is cut
/// around a corner.
pub fn cut(corners: &[u32], positions: &[DVec3], add: impl FnMut([u32; 3])) {
    match Outline::of(corners, positions).filter(|outline| !outline.is_convex()) {
        Some(outline) => outline.clip(add),
        None => fan(corners, add),
    }
}

/// Triangles around the first corner.
pub fn fan(corners: &[u32], mut add: impl FnMut([u32; 3])) {
    corners.windows(2).skip(1).for_each(|pair| add([corners[0], pair[0], pair[1]]));
}

/// A polygon in the plane of two coordinates, in which it is counter-clockwise.
struct Outline<'a> {
    corners: &'a [u32],
    positions: &'a [DVec3],
    axes: [usize; 2],
}

impl<'a> Outline<'a> {
    /// None for triangles.
    fn of(corners: &'a [u32], positions: &'a [DVec3]) -> Option<Self> {
        let &[first, _, _, _, ..] = corners else { return None };
        let side = |corner: u32| positions[corner as usize] - positions[first as usize];
        let normal: DVec3 = corners.array_windows().map(|&[a, b]| side(a).cross(side(b))).sum();
        let axis = normal.abs().max_position();
        let axes = [(axis + 1) % 3, (axis + 2) % 3];
        let axes = if normal[axis] < 0.0 { [axes[1], axes[0]] } else { axes };
        Some(Self { corners, positions, axes })
    }

    fn turn(&self, corners: [u32; 3]) -> Ordering {
        turn(corners.map(|corner| self.axes.map(|axis| self.positions[corner as usize][axis])))
    }

    fn is_convex(&self) -> bool {
        let n = self.corners.len();
        let corner = |at: usize| self.corners[at % n];
        (0..n).all(|at| self.turn([corner(at), corner(at + 1), corner(at + 2)]) != Ordering::Less)
    }

    fn clip(&self, mut add: impl FnMut([u32; 3])) {
        let mut rest = self.corners.to_vec();
        let mut compared = MOST_COMPARED * rest.len();
        // The corner that may be an ear, and how many before it are none.
        let (mut at, mut none) = (0, 0);
        while rest.len() > 3 && none < rest.len() && compared > rest.len() {
            let n = rest.len();
            compared -= n;
            let ear = [rest[(at + n - 1) % n], rest[at], rest[(at + 1) % n]];
            if self.is_ear(ear, &rest) {
                add(ear);
                rest.remove(at);
                (at, none) = (at % (n - 1), 0);
            } else {
                (at, none) = ((at + 1) % n, none + 1);
            }
        }
        fan(&rest, add);
    }

    /// Whether a triangle turns left and holds none of the other corners. Those at one place with a corner of the
    /// triangle do not count: polygons with holes pass some places twice.
    fn is_ear(&self, ear: [u32; 3], corners: &[u32]) -> bool {
        let [a, b, c] = ear;
        let place = |corner: u32| self.positions[corner as usize];
        let is_outside = |v: u32| {
            [[a, b, v], [b, c, v], [c, a, v]].into_iter().any(|side| self.turn(side) == Ordering::Less)
                || ear.into_iter().any(|corner| place(corner) == place(v))
        };
        self.turn(ear) == Ordering::Greater && corners.iter().all(|&v| is_outside(v))
    }
}

/// Whether three points turn left (`Greater`), right, or are on a line. The bound of the rounding error is that of
/// Shewchuk's `orient2d` (*Adaptive Precision Floating-Point Arithmetic*, 1997); within it, double-double numbers decide.
fn turn([a, b, c]: [[f64; 2]; 3]) -> Ordering {
    const ERROR: f64 = (3.0 + 16.0 * UNIT_ROUNDOFF) * UNIT_ROUNDOFF;
    let (left, right) = ((a[0] - c[0]) * (b[1] - c[1]), (a[1] - c[1]) * (b[0] - c[0]));
    let twice_area = left - right;
    if twice_area.abs() > ERROR * (left.abs() + right.abs()) {
        return twice_area.total_cmp(&0.0);
    }
    let side = |p: [f64; 2], axis: usize| Exact::from(p[axis]) - Exact::from(c[axis]);
    let (left, right) = (side(a, 0) * side(b, 1), side(a, 1) * side(b, 0));
    left.partial_cmp(&right).unwrap_or(Ordering::Equal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::Angle;
    use crate::testing::Random;

    fn triangles(positions: &[DVec3]) -> Vec<[u32; 3]> {
        let corners: Vec<u32> = (0..positions.len() as u32).collect();
        let mut found = Vec::new();
        cut(&corners, positions, |triangle| found.push(triangle));
        found
    }

    /// Twice the area of a polygon, as a vector along its normal.
    fn area(positions: impl Iterator<Item = DVec3> + Clone) -> DVec3 {
        let next = positions.clone().cycle().skip(1);
        positions.zip(next).map(|(a, b)| a.cross(b)).sum()
    }

    /// All triangles face the way of the polygon, and their areas are its area, so they neither overlap nor miss it.
    fn assert_fills(positions: &[DVec3], what: &str) {
        let found = triangles(positions);
        assert_eq!(found.len(), positions.len() - 2, "{what}");
        let whole = area(positions.iter().copied());
        let parts =
            found.iter().map(|triangle| area(triangle.map(|corner| positions[corner as usize]).into_iter()));
        let mut sum = 0.0;
        for part in parts {
            assert!(part.dot(whole) >= 0.0, "{what}: {found:?}");
            sum += part.length();
        }
        assert!(
            (sum - whole.length()).abs() <= 1e-12 * whole.length(),
            "{what}: {sum} of {}",
            whole.length()
        );
    }

    #[test]
    fn convex_polygons_are_cut_around_their_first_corner() {
        let square = [DVec3::ZERO, DVec3::X, DVec3::new(2.0, 0.0, 0.0), DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
        assert_eq!(triangles(&square), [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
        assert_eq!(triangles(&square[..3]), [[0, 1, 2]]);
    }

    #[test]
    fn an_angle_is_filled_from_every_first_corner() {
        let outline = [(2, 0), (2, 1), (1, 1), (1, 2), (0, 2), (0, 0)];
        for first in 0..6 {
            for turned in 0..3 {
                let point = |k: usize| {
                    let (x, y) = outline[(first + k) % 6];
                    let at = [f64::from(x), f64::from(y), 1.0];
                    DVec3::from([0, 1, 2].map(|axis: usize| at[(axis + turned) % 3]))
                };
                let mut positions: Vec<DVec3> = (0..6).map(point).collect();
                assert_fills(&positions, "counter-clockwise");
                positions.reverse();
                assert_fills(&positions, "clockwise");
            }
        }
    }

    #[test]
    fn stars_of_any_radii_are_filled() {
        let mut random = Random(8);
        for _ in 0..2000 {
            let n = 4 + (random.unit() * 40.0) as usize;
            let normal = random.direction();
            let (x, y) = normal.any_orthonormal_pair();
            let corner = |k: usize| {
                let turn = Angle(360.0 * k as f64 / n as f64).cos_sin() * (0.05 + random.unit());
                x * turn.x + y * turn.y
            };
            let positions: Vec<DVec3> = (0..n).map(corner).collect();
            assert_fills(&positions, "a star");
        }
    }

    /// The outline runs to the hole, around it and back.
    #[test]
    fn holes_stay_open() {
        let outline = [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)];
        let positions = outline.map(|(x, y)| DVec3::new(f64::from(x), f64::from(y), 0.0));
        assert_fills(&positions, "a frame");
    }

    #[test]
    fn polygons_that_cross_themselves_end() {
        let mut random = Random(9);
        for n in 4..200 {
            let positions: Vec<DVec3> = (0..n).map(|_| random.point(1.0)).collect();
            assert_eq!(triangles(&positions).len(), n - 2);
            assert_eq!(triangles(&vec![DVec3::ONE; n]).len(), n - 2);
        }
    }

    /// Points on a line up to the last bit: a wrong sign is what a plain determinant gives.
    #[test]
    fn turns_are_decided_to_the_last_bit() {
        let ulp = f64::EPSILON;
        for i in -8..8 {
            for j in -8..8 {
                let a = [0.5 + f64::from(i) * ulp, 0.5 + f64::from(j) * ulp];
                assert_eq!(turn([a, [12.0, 12.0], [24.0, 24.0]]), j.cmp(&i), "{i} {j}");
            }
        }
    }
}
