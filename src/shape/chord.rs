//! Where lines cross a torus.

use super::frame::across;
use super::torus::Torus;
use crate::camera::Ray;
use crate::math::{DVec3, UNIT_ROUNDOFF, root_between};

/// The part of a ray that may meet a torus, measured in lengths from the point closest to the centre: from
/// there all numbers are of the torus' size, however far away the ray starts.
pub struct Chord<'a> {
    torus: &'a Torus,
    /// Where on the ray the closest point is, and how long the ray's direction is.
    t: f64,
    speed: f64,
    /// The closest point, and the unit direction.
    middle: DVec3,
    direction: DVec3,
    from: f64,
    to: f64,
}

impl<'a> Chord<'a> {
    /// None if the ray passes by.
    pub fn new(torus: &'a Torus, ray: &Ray) -> Option<Self> {
        let d = ray.direction;
        let speed = d.length();
        let first = -ray.origin.dot(d) / d.length_squared();
        let near = ray.at(first);
        // Again, for from far away the first point is off by the rounding of the way there.
        let second = -near.dot(d) / d.length_squared();
        let (middle, direction) = (near + d * second, d / speed);
        let outer = torus.major + torus.minor;
        let distance = middle.length();
        let half = ((outer - distance).max(0.0) * (outer + distance)).sqrt();
        let (mut from, mut to) = (-half, half);
        if direction.y != 0.0 {
            let a = (-torus.minor - middle.y) / direction.y;
            let b = (torus.minor - middle.y) / direction.y;
            from = from.max(a.min(b));
            to = to.min(a.max(b));
        } else if middle.y.abs() > torus.minor {
            return None;
        }
        (from < to).then_some(Self { torus, t: first + second, speed, middle, direction, from, to })
    }

    /// The first t beyond `after`, which is not behind the ray's origin, at which it crosses the surface. On which side it
    /// starts is told by the origin itself, not by its place on the chord; from there, each crossing leads to the other side.
    pub fn first(&self, ray: &Ray, after: f64) -> Option<f64> {
        let origin = -self.t * self.speed;
        let mut inside = origin >= self.from && self.torus.distance(ray.origin) < 0.0;
        let mut s = origin.max(self.from);
        loop {
            s = if s < self.to { self.crossing(s, inside)? } else { return None };
            let t = self.t + s / self.speed;
            if t > after {
                return Some(t);
            }
            inside = !inside;
        }
    }

    fn at(&self, s: f64) -> DVec3 {
        self.middle + self.direction * s
    }

    /// The first place after `start` where the ray crosses the surface, if `inside` says on which side of it
    /// the ray is there.
    ///
    /// From one extremum of the quartic to the next it crosses at most once, and it does if the next one is
    /// on the other side. The extrema need not be exact for that; the sides and the crossings are those of
    /// the true distance. Behind the last one the ray is outside: there is an even number of crossings.
    fn crossing(&self, start: f64, inside: bool) -> Option<f64> {
        let mut last = start;
        let extrema = self.extrema(start);
        for next in extrema.into_iter().flatten().chain([self.to]) {
            let inside_next = next < self.to && self.torus.distance(self.at(next)) < 0.0;
            if inside_next != inside {
                let resolution = (self.torus.major + self.torus.minor) * UNIT_ROUNDOFF;
                let distance = |s: f64| self.torus.distance_along(self.at(s), self.direction);
                return Some(root_between((last, next), inside, resolution, distance));
            }
            last = next;
        }
        None
    }

    /// Where the quartic has extrema between `start` and the end, in ascending order.
    ///
    /// From the point closest to the centre, p² is m² + s², so that (p² + R² - r²)² - 4 R² (p² - y²) has no
    /// cubic term, and a quarter of its derivative is s³ + P s + Q. That is monotonic between its own
    /// extrema at ±√(-P/3).
    fn extrema(&self, start: f64) -> [Option<f64>; 3] {
        let Torus { major, minor, .. } = *self.torus;
        let square = major * major;
        let p = self.middle.length_squared() + (major - minor) * (major + minor)
            - 2.0 * square * across(self.direction).length_squared();
        let q = 2.0 * square * self.middle.y * self.direction.y;
        let slope = |s: f64| ((s * s + p) * s + q, 3.0 * s * s + p);
        let turn = (-p / 3.0).max(0.0).sqrt();
        let stations = [start, (-turn).clamp(start, self.to), turn.clamp(start, self.to), self.to];
        let resolution = (major + minor) * UNIT_ROUNDOFF;
        std::array::from_fn(|i| {
            let (a, b) = (stations[i], stations[i + 1]);
            let rising = slope(a).0 < 0.0;
            (rising != (slope(b).0 < 0.0)).then(|| root_between((a, b), rising, resolution, slope))
        })
    }
}
