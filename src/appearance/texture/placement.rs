//! Where a pattern or an image lies: scaled, then rotated, then moved, as an object is.

use super::{Axis, Footprint, Wrap};
use crate::base::digest::content;
use crate::base::math::{DMat3, DQuat, DVec3, gamma};
use crate::base::time::Time;
use crate::geometry::transform::Rotation;
use crate::track::Animated;

/// The coordinates that a pattern is laid out in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Space {
    /// Points of the object before it is moved: the pattern is cut from a block and moves with the object.
    #[default]
    Object,
    /// (u, v, 0): the pattern is printed on the surface.
    Uv,
}

content!(
    enum Space {
        Object,
        Uv,
    }
);

/// A placement over time: a point p of the pattern is shown at offset + R(scale · p).
#[derive(Clone, Debug, PartialEq)]
pub struct PlacementTracks {
    pub offset: Animated<DVec3>,
    pub rotation: Rotation,
    pub scale: Animated<DVec3>,
}

impl Default for PlacementTracks {
    fn default() -> Self {
        Self {
            offset: DVec3::ZERO.into(),
            rotation: Rotation::Quaternion(DQuat::IDENTITY.into()),
            scale: DVec3::ONE.into(),
        }
    }
}

/// A placement at one moment, as it is needed: from the surface back to the pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    offset: DVec3,
    inverse: DMat3,
}

content!(struct Placement { offset, inverse });

/// How an image goes on along an axis of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Over a surface that ends at 0 and 1 of u and v. Where it ends as a copy of the image does, to rounding, no other
    /// copy follows.
    ended: Axis,
    /// Whether u, and v, lead along the axis.
    by: [bool; 2],
}

content!(struct Reach { ended, by });

impl Reach {
    /// Over a surface of which `ends` says whether it ends at 0 and 1 of u, and of v.
    pub fn over(&self, ends: [bool; 2]) -> Axis {
        let goes_on = |of: usize| self.by[of] && !ends[of];
        if goes_on(0) || goes_on(1) { Wrap::Repeat.into() } else { self.ended }
    }
}

impl PlacementTracks {
    pub fn at(&self, time: Time) -> Placement {
        // While a keyed scale is 0, no point of the pattern is finite.
        let unscaled = DMat3::from_diagonal(self.scale.at(time).recip());
        let inverse = unscaled * self.rotation.at(time).transpose();
        Placement { offset: self.offset.at(time), inverse }
    }
}

impl Placement {
    /// A point of the surface, known within `error`, in the pattern's coordinates, and how far off it may be
    /// there. The bound holds a few roundings more than are made here: those of a file's decimal numbers.
    pub fn local(&self, point: DVec3, error: DVec3) -> (DVec3, DVec3) {
        let rounding = (point.abs() + self.offset.abs()) * gamma(10);
        (self.inverse * (point - self.offset), self.inverse.abs() * (error + rounding))
    }

    /// How an image that repeats goes on along an axis of its own, x or y, over a surface.
    pub fn reach(&self, axis: usize) -> Reach {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X + DVec3::Y];
        let corners = corners.map(|corner| {
            let (at, error) = self.local(corner, DVec3::ZERO);
            (at[axis], error[axis])
        });
        let whole = |(at, error): (f64, f64)| {
            let whole = at.round();
            ((at - whole).abs() <= error).then_some(whole)
        };
        let first = corners.into_iter().fold(corners[0], |a, b| if b.0 < a.0 { b } else { a });
        let last = corners.into_iter().fold(corners[0], |a, b| if b.0 > a.0 { b } else { a });
        let (from, to) = (whole(first).unwrap_or(f64::NEG_INFINITY), whole(last).unwrap_or(f64::INFINITY));
        let ended = if from < to { Axis::repeating(from, to) } else { Wrap::Repeat.into() };
        Reach { ended, by: [0, 1].map(|of: usize| self.inverse.col(of)[axis] != 0.0) }
    }

    /// What is seen of the surface, in the pattern's coordinates.
    pub fn footprint(&self, footprint: &Footprint) -> Footprint {
        footprint.moved(&self.inverse)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::Angle;

    fn placed(offset: DVec3, degrees: f64, scale: DVec3) -> Placement {
        let rotation = Rotation::AxisAngle { axis: DVec3::Z.into(), angle: Angle(degrees).into() };
        PlacementTracks { offset: offset.into(), rotation, scale: scale.into() }.at(Time::from_integer(0))
    }

    #[test]
    fn placed_like_an_object() {
        let placement = placed(DVec3::new(5.0, 0.0, 0.0), 90.0, DVec3::new(2.0, 1.0, 1.0));
        // The pattern's (1, 0, 0) is scaled to (2, 0, 0), turned to (0, 2, 0) and moved to (5, 2, 0).
        assert_eq!(placement.local(DVec3::new(5.0, 2.0, 0.0), DVec3::ZERO).0, DVec3::X);
    }

    #[test]
    fn no_placement_changes_nothing() {
        let placement = PlacementTracks::default().at(Time::from_integer(0));
        let point = DVec3::new(0.1, -2.3, 1e9);
        assert_eq!(placement.local(point, DVec3::ZERO).0, point);
    }

    #[test]
    fn images_end_where_surfaces_do() {
        let ends =
            |placement: &Placement, ends: [bool; 2]| [0, 1].map(|axis| placement.reach(axis).over(ends));
        let on: Axis = Wrap::Repeat.into();
        let one = PlacementTracks::default().at(Time::from_integer(0));
        assert_eq!(ends(&one, [true, true]), [Axis::repeating(0.0, 1.0); 2]);
        assert_eq!(ends(&one, [false, true]), [on, Axis::repeating(0.0, 1.0)]);
        assert_eq!(ends(&one, [false, false]), [on; 2]);
        // Ten copies, though a tenth is no binary number.
        let small = placed(DVec3::ZERO, 0.0, DVec3::splat(0.1));
        assert_eq!(ends(&small, [true, true]), [Axis::repeating(0.0, 10.0); 2]);
        let turned = placed(DVec3::ZERO, 90.0, DVec3::ONE);
        assert_eq!(ends(&turned, [false, true]), [Axis::repeating(0.0, 1.0), on]);
        assert_eq!(ends(&turned, [true, true]), [Axis::repeating(0.0, 1.0), Axis::repeating(-1.0, 0.0)]);
        // Moved by a part of itself, it goes on to the one side and to the other.
        let moved = placed(DVec3::new(0.25, 0.0, 0.0), 0.0, DVec3::new(1.0, 0.7, 1.0));
        let open = Axis::repeating(0.0, f64::INFINITY);
        assert_eq!(ends(&moved, [true, true]), [on, open]);
        assert_eq!(ends(&placed(DVec3::ZERO, 30.0, DVec3::ONE), [true, false]), [on; 2]);
        assert_eq!(
            ends(&placed(DVec3::ZERO, 0.0, DVec3::ZERO), [true, true]),
            [on; 2],
            "while it is nothing"
        );
    }

    #[test]
    fn bounds_cover_decimal_numbers() {
        // In decimals, (0.6 - 0.4) / 0.2 and 0.6 / 0.3 are whole; in binary numbers they are not.
        for (at, offset, scale, whole) in [(0.6, 0.4, 0.2, 1.0), (0.6, 0.0, 0.3, 2.0), (0.7, 0.1, 0.1, 6.0)] {
            let placement = placed(DVec3::splat(offset), 0.0, DVec3::splat(scale));
            let (point, error) = placement.local(DVec3::splat(at), DVec3::ZERO);
            assert!((point - whole).abs().cmple(error).all() && error.max_element() < 1e-13);
        }
    }
}
