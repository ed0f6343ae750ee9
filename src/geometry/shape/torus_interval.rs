//! Intersects lines with a torus.

use super::frame::from_axis;
use crate::base::digest::Content;
use crate::base::lanes::{Mask, Real, Vec3};
use crate::base::math::{Function, LaneRay, UNIT_ROUNDOFF, root_between};

/// The radii of a torus' circle and of its tube; 0 < `minor` < `major`.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
pub struct TorusRadii {
    pub major: f64,
    pub minor: f64,
}

impl TorusRadii {
    /// The signed distance of points of the frame from the surface, negative inside the tube. Its error is a few
    /// roundings of the point's coordinates and of the radii.
    #[inline(always)]
    pub fn distance<F: Real>(&self, p: Vec3<F>) -> F {
        let off = from_axis(p) - F::splat(self.major);
        (off * off + p.y * p.y).sqrt() - F::splat(self.minor)
    }

    /// [`TorusRadii::distance`], and its derivative in the direction `d`.
    #[inline(always)]
    pub fn distance_along<F: Real>(&self, p: Vec3<F>, d: Vec3<F>) -> (F, F) {
        let axis = from_axis(p);
        let off = axis - F::splat(self.major);
        let length = (off * off + p.y * p.y).sqrt();
        let outwards = (p.x * d.x + p.z * d.z) / axis;
        (length - F::splat(self.minor), (off * outwards + p.y * d.y) / length)
    }
}

/// The intervals of rays that may hit a torus, as distances from the points closest to the centre. So all numbers have
/// the size of the torus, however far away the rays start.
pub struct TorusInterval<F: Real> {
    radii: TorusRadii,
    /// The t of the closest points, and the lengths of the rays' directions.
    t: F,
    speed: F,
    /// The closest points, and the unit directions.
    middle: Vec3<F>,
    direction: Vec3<F>,
    from: F,
    to: F,
    /// Rays that do not miss the bounds.
    meets: F::Mask,
}

/// The distance from a torus along a line.
struct Distance<'a, F: Real>(&'a TorusInterval<F>);

impl<F: Real> Function<F> for Distance<'_, F> {
    #[inline(always)]
    fn at(&self, s: F) -> (F, F) {
        self.0.radii.distance_along(self.0.at(s), self.0.direction)
    }
}

/// s³ + p s + q, a quarter of the derivative of the quartic.
struct Slope<F> {
    p: F,
    q: F,
}

impl<F: Real> Function<F> for Slope<F> {
    #[inline(always)]
    fn at(&self, s: F) -> (F, F) {
        ((s * s + self.p) * s + self.q, F::splat(3.0) * s * s + self.p)
    }
}

impl<F: Real> TorusInterval<F> {
    #[inline(always)]
    pub fn new(radii: TorusRadii, ray: &LaneRay<F>) -> Self {
        let zero = F::splat(0.0);
        let d = ray.direction;
        let speed = d.length();
        let first = -ray.origin.dot(d) / d.length_squared();
        let near = ray.at(first);
        // Repeated, because from far away the first point is off by the rounding of the distance.
        let second = -near.dot(d) / d.length_squared();
        let (middle, direction) = (near + d * second, d / speed);
        let (outer, minor) = (F::splat(radii.major + radii.minor), F::splat(radii.minor));
        let distance = middle.length();
        let half = ((outer - distance).max(zero) * (outer + distance)).sqrt();
        let level = direction.y.eq(zero);
        let (a, b) = ((-minor - middle.y) / direction.y, (minor - middle.y) / direction.y);
        let from = F::select(level, -half, (-half).max(a.min(b)));
        let to = F::select(level, half, half.min(a.max(b)));
        let meets = from.lt(to) & !(level & minor.lt(middle.y.abs()));
        Self { radii, t: first + second, speed, middle, direction, from, to, meets }
    }

    /// The first t at which rays cross the surface, ahead of their origins and beyond `min`; and the rays that do. The
    /// origins themselves decide on which side rays start, not their positions in the interval.
    #[inline(always)]
    pub fn first(&self, ray: &LaneRay<F>, min: F) -> (F, F::Mask) {
        let origin = -self.t * self.speed;
        let inside = self.from.le(origin) & self.radii.distance(ray.origin).lt(F::splat(0.0));
        let start = origin.max(self.from);
        let open = self.meets & start.lt(self.to);
        if !open.any() {
            return (start, open);
        }
        self.crossing(start, inside, open, min)
    }

    #[inline(always)]
    fn at(&self, s: F) -> Vec3<F> {
        self.middle + self.direction * s
    }

    /// The first t beyond `min` at which rays cross the surface after `start`. `inside` holds the rays that are inside
    /// at `start`.
    ///
    /// Between two extrema of the quartic there is at most one crossing. There is one if the sides at both extrema
    /// differ. The extrema need not be exact for that: the sides and the crossings are those of the true distance.
    /// After the last extremum the ray is outside, because the number of crossings is even.
    #[inline(always)]
    fn crossing(&self, start: F, mut inside: F::Mask, mut open: F::Mask, min: F) -> (F, F::Mask) {
        let resolution = F::splat((self.radii.major + self.radii.minor) * UNIT_ROUNDOFF);
        let (mut found, mut crosses, mut last) = (start, F::Mask::splat(false), start);
        let extrema = self.extrema(start, open);
        for (next, is_there) in extrema.into_iter().chain([(self.to, F::Mask::splat(true))]) {
            let inside_next = next.lt(self.to) & self.radii.distance(self.at(next)).lt(F::splat(0.0));
            let changes = open & is_there & ((inside_next & !inside) | (!inside_next & inside));
            if changes.any() {
                let s = root_between((last, next), inside, resolution, changes, &Distance(self));
                let t = self.t + s / self.speed;
                let beyond = changes & min.lt(t);
                found = F::select(beyond, t, found);
                crosses = crosses | beyond;
                open = open & !beyond;
                inside = (inside & !changes) | (inside_next & changes);
            }
            last = F::select(is_there, next, last);
        }
        (found, crosses)
    }

    /// The extrema of the quartic between `start` and the end, in ascending order, with the lanes that have each.
    ///
    /// From the point closest to the centre, p² is m² + s². So (p² + R² - r²)² - 4 R² (p² - y²) has no cubic term, and
    /// a quarter of its derivative is s³ + P s + Q. That is monotonic between its own extrema at ±√(-P/3).
    #[inline(always)]
    fn extrema(&self, start: F, open: F::Mask) -> [(F, F::Mask); 3] {
        let zero = F::splat(0.0);
        let TorusRadii { major, minor } = self.radii;
        let square = F::splat(major * major);
        let d = self.direction;
        let p = self.middle.length_squared() + F::splat((major - minor) * (major + minor))
            - F::splat(2.0) * square * (d.x * d.x + d.z * d.z);
        let q = F::splat(2.0) * square * self.middle.y * d.y;
        let slope = Slope { p, q };
        let turn = (-p / F::splat(3.0)).max(zero).sqrt();
        let (early, late) = ((-turn).max(start).min(self.to), turn.max(start).min(self.to));
        let stations = [start, early, late, self.to];
        let resolution = F::splat((major + minor) * UNIT_ROUNDOFF);
        let mut extrema = [(start, F::Mask::splat(false)); 3];
        for (i, extremum) in extrema.iter_mut().enumerate() {
            let (a, b) = (stations[i], stations[i + 1]);
            let (rising, ends_below) = (slope.at(a).0.lt(zero), slope.at(b).0.lt(zero));
            let turns = open & ((rising & !ends_below) | (!rising & ends_below));
            if turns.any() {
                *extremum = (root_between((a, b), rising, resolution, turns, &slope), turns);
            }
        }
        extrema
    }
}
