//! Centripetal Catmull-Rom splines.

use crate::base::math::DVec3;

/// The point at the fraction `s` (0..=1) from `p[1]` to `p[2]` on the centripetal Catmull-Rom curve through all four
/// points, by the pyramid of Barry and Goldman (1988). The knots are spaced by the square roots of the distances of
/// the points. Such curves have neither cusps nor loops within a segment (Yuksel, Schaefer, Keyser 2011).
///
/// Equal neighbours define no direction: a doubled end point makes the end of the curve straight, and a segment
/// between equal points stays at that point.
pub fn catmull_rom(p: [DVec3; 4], s: f64) -> DVec3 {
    let gap = |a: DVec3, b: DVec3| (b - a).length().sqrt();
    let middle = gap(p[1], p[2]);
    if middle == 0.0 {
        return p[1];
    }
    let or_middle = |g: f64| if g == 0.0 { middle } else { g };
    // Replace a missing neighbour by the mirror image of the other end of the segment.
    let first = if p[0] == p[1] { p[1] * 2.0 - p[2] } else { p[0] };
    let last = if p[3] == p[2] { p[2] * 2.0 - p[1] } else { p[3] };
    let t1 = or_middle(gap(p[0], p[1]));
    let t2 = t1 + middle;
    let t3 = t2 + or_middle(gap(p[2], p[3]));
    let t = t1 + middle * s;
    let mix = |a: DVec3, b: DVec3, ta: f64, tb: f64| (a * (tb - t) + b * (t - ta)) / (tb - ta);
    let (a1, a2, a3) = (mix(first, p[1], 0.0, t1), mix(p[1], p[2], t1, t2), mix(p[2], last, t2, t3));
    let (b1, b2) = (mix(a1, a2, 0.0, t2), mix(a2, a3, t1, t3));
    mix(b1, b2, t1, t2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_points_make_a_straight_line() {
        let (a, b) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 6.0, 3.0));
        for k in 0..=10 {
            let s = f64::from(k) / 10.0;
            assert!((catmull_rom([a, a, b, b], s) - (a + (b - a) * s)).length() < 1e-14);
        }
    }

    #[test]
    fn equal_points_stay() {
        let a = DVec3::ONE;
        assert_eq!(catmull_rom([DVec3::ZERO, a, a, DVec3::X], 0.3), a);
    }

    #[test]
    fn evenly_spaced_points_give_the_uniform_curve() {
        // For equal distances the curve is the uniform Catmull-Rom cubic with tangents (p2 - p0) / 2.
        let p = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (2.0, 1.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
        let (m1, m2) = ((p[2] - p[0]) * 0.5, (p[3] - p[1]) * 0.5);
        for k in 0..=10 {
            let s = f64::from(k) / 10.0;
            let hermite = p[1] * (2.0 * s * s * s - 3.0 * s * s + 1.0)
                + m1 * (s * s * s - 2.0 * s * s + s)
                + p[2] * (3.0 * s * s - 2.0 * s * s * s)
                + m2 * (s * s * s - s * s);
            assert!((catmull_rom(p, s) - hermite).length() < 1e-14);
        }
    }
}
