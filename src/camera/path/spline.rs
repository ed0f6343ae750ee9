//! A flight along a smooth curve at constant speed.

use super::pose::{Aim, Pose};
use crate::base::math::{DVec3, gamma};
use crate::base::time::Clock;
use crate::track::{Animate, Ease};

/// The camera follows a centripetal Catmull-Rom curve through points, at constant speed along its length.
#[derive(Clone, Debug, PartialEq)]
pub struct SplinePath {
    pub aim: Aim,
    /// The progress along the curve over the duration of the sequence.
    pub ease: Ease,
    /// Look along the curve instead of at the target.
    pub look_ahead: bool,
    curve: Curve,
}

impl SplinePath {
    /// A path through `points`; none unless at least two of them differ.
    pub fn new(points: Vec<DVec3>, closed: bool, aim: Aim, ease: Ease, look_ahead: bool) -> Option<Self> {
        Some(Self { aim, ease, look_ahead, curve: Curve::new(points, closed)? })
    }

    pub fn apply(&self, pose: Pose, clock: &Clock) -> Pose {
        let pose = self.aim.apply(pose, clock);
        let along = self.ease.apply(clock.progress().value());
        let mut position = self.curve.at(along);
        // Closer to the target than the rounding error of the curve, the direction to the target is undefined.
        if (position - pose.target).length() <= self.curve.rounding() {
            position = pose.target;
        }
        let target = if self.look_ahead { position + self.curve.direction(along) } else { pose.target };
        Pose { position, target, ..pose }
    }
}

/// A curve parametrized by arc length.
#[derive(Clone, Debug, PartialEq)]
struct Curve {
    points: Vec<DVec3>,
    closed: bool,
    /// The length of the curve up to each stop. The stops divide each segment evenly.
    lengths: Vec<f64>,
}

/// Stops per segment. Between two stops, the speed along the curve is assumed to be constant.
const STOPS: usize = 256;

impl Curve {
    fn new(mut points: Vec<DVec3>, closed: bool) -> Option<Self> {
        points.dedup();
        if closed && points.len() > 1 && points.first() == points.last() {
            points.pop();
        }
        if points.len() < 2 {
            return None;
        }
        let mut curve = Self { points, closed, lengths: vec![0.0] };
        let stops = curve.segments() * STOPS;
        let (mut length, mut before) = (0.0, curve.point(0, 0.0));
        for stop in 1..=stops {
            let here = curve.at_stop(stop as f64);
            length += (here - before).length();
            before = here;
            curve.lengths.push(length);
        }
        Some(curve)
    }

    /// A bound of the rounding error of a point: five levels of interpolation with three roundings each.
    fn rounding(&self) -> f64 {
        let reach = self.points.iter().map(|point| point.length()).fold(0.0, f64::max);
        gamma(15) * reach
    }

    fn segments(&self) -> usize {
        if self.closed { self.points.len() } else { self.points.len() - 1 }
    }

    /// The point at the fraction `s` of a segment.
    fn point(&self, segment: usize, s: f64) -> DVec3 {
        let n = self.points.len();
        let index = |i: usize| match self.closed {
            true => &self.points[(i + n - 1) % n],
            false => &self.points[i.saturating_sub(1).min(n - 1)],
        };
        DVec3::spline([index(segment), index(segment + 1), index(segment + 2), index(segment + 3)], s)
    }

    fn at_stop(&self, stop: f64) -> DVec3 {
        let segment = ((stop / STOPS as f64) as usize).min(self.segments() - 1);
        self.point(segment, stop / STOPS as f64 - segment as f64)
    }

    /// The point at a share of the length. If an easing overshoots, the point stays at the end of an open curve, and
    /// continues around a closed one.
    fn at(&self, along: f64) -> DVec3 {
        let along = if self.closed { along - along.floor() } else { along.clamp(0.0, 1.0) };
        let wanted = along * self.lengths[self.lengths.len() - 1];
        let next = self.lengths.partition_point(|&length| length <= wanted).clamp(1, self.lengths.len() - 1);
        let (low, high) = (self.lengths[next - 1], self.lengths[next]);
        let rest = if high > low { (wanted - low) / (high - low) } else { 0.0 };
        self.at_stop((next - 1) as f64 + rest)
    }

    /// The unit tangent at a share of the length.
    fn direction(&self, along: f64) -> DVec3 {
        let reach = 0.5 / (self.segments() * STOPS) as f64;
        let (from, to) = match self.closed {
            true => (along - reach, along + reach),
            false => ((along - reach).max(0.0), (along + reach).min(1.0)),
        };
        (self.at(to) - self.at(from)).try_normalize().unwrap_or(DVec3::NEG_Z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<DVec3> {
        [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(x, z)| DVec3::new(x, 0.0, z)).to_vec()
    }

    #[test]
    fn closed_curves_come_back() {
        let curve = Curve::new(square(), true).expect("a curve");
        assert_eq!(curve.at(0.0), square()[0]);
        assert!((curve.at(1.0) - square()[0]).length() < 1e-12);
        assert!((curve.at(0.5) - square()[2]).length() < 1e-9, "{}", curve.at(0.5));
        assert!((curve.direction(0.0) - DVec3::new(-1.0, 0.0, 1.0).normalize()).length() < 1e-3);
    }

    #[test]
    fn the_speed_is_even() {
        let uneven = vec![
            DVec3::ZERO,
            DVec3::new(1.0, 3.0, 0.0),
            DVec3::new(20.0, 0.0, 5.0),
            DVec3::new(21.0, 1.0, 0.0),
        ];
        let curve = Curve::new(uneven.clone(), false).expect("a curve");
        let steps: Vec<f64> = (0..200)
            .map(|k| (curve.at(f64::from(k + 1) / 200.0) - curve.at(f64::from(k) / 200.0)).length())
            .collect();
        let mean = steps.iter().sum::<f64>() / 200.0;
        assert!(steps.iter().all(|step| (step / mean - 1.0).abs() < 0.02), "{steps:?}");
        assert_eq!(curve.at(1.0), uneven[3]);
    }

    #[test]
    fn a_curve_needs_two_points() {
        assert_eq!(Curve::new(vec![DVec3::ONE, DVec3::ONE], false), None);
        assert_eq!(Curve::new(vec![DVec3::ONE, DVec3::ONE], true), None);
    }
}
