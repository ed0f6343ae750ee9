//! Orthonormal frames around a direction.
//!
//! No rule gives every direction a frame without a jump or a point around which the frames spin (the hairy ball). Where a
//! pixel's samples see both sides of a jump, they do not complete each other any more. So a frame is not a function of its
//! direction alone: it is carried from a frame that all samples of a pixel have in common along the way that leads to the
//! direction, from step to step by the smallest rotation. That rotation is smooth but for opposite directions, and steps
//! never lead there: a surface faces the ray that sees it, and a ray leaves on the side that it leads to.

use crate::math::{DVec3, Real, Vector3};

/// A right-handed orthonormal frame: of one direction, or of several in lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame<V = DVec3> {
    pub x: V,
    pub y: V,
    pub z: V,
}

impl Frame {
    /// The frame around the unit vector `z` that the smallest rotation makes of the axes of space.
    pub fn around(z: DVec3) -> Self {
        Self::carried(DVec3::X, DVec3::Z, z)
    }
}

impl<V: Vector3> Frame<V> {
    /// The frame around the unit vector `z` that the smallest rotation from `from` to `z` makes of one around `from` with
    /// the x axis `tangent`. No two axes are off a right angle, and none off its length, by more than 4 u.
    #[inline(always)]
    pub fn carried(tangent: V, from: V, z: V) -> Self {
        let cosine = from.dot(z);
        let side = cosine.at_least(OPPOSITE, V::Real::of(1.0), V::Real::of(-1.0));
        let x = carry(tangent, from, z * side, cosine * side);
        // What rounding has left of it along `z`, and off its length, is taken away: to the first order, as it is small.
        let x = of_unit_length(x - z * x.dot(z));
        Self { x, y: of_unit_length(z.cross(x)), z }
    }

    /// The x axis carried to a direction, on whichever side of the frame that is: what a ray in that direction takes along.
    #[inline(always)]
    pub fn tangent(&self, direction: V) -> V {
        let cosine = self.z.dot(direction);
        let side = V::Real::of(1.0).with_sign_of(cosine);
        carry(self.x, self.z * side, direction, cosine * side)
    }

    /// A vector given along the frame's axes.
    #[inline(always)]
    pub fn to_world(&self, along: [V::Real; 3]) -> V {
        let [x, y, z] = along;
        self.x * x + self.y * y + self.z * z
    }

    /// A vector's parts along the frame's axes.
    #[inline(always)]
    pub fn to_local(&self, v: V) -> [V::Real; 3] {
        [v.dot(self.x), v.dot(self.y), v.dot(self.z)]
    }
}

/// Directions with a smaller cosine, closer than 2^-10 to each other's opposite, are taken for equal ones with their signs
/// exchanged: of their sum, too many digits are those of their own lengths' rounding. Any distance between the square root
/// of u and 1 would do.
const OPPOSITE: f64 = -1.0 + 0.5 / (1u64 << 20) as f64;

/// A vector whose length is 1 but for rounding, at that length.
#[inline(always)]
fn of_unit_length<V: Vector3>(v: V) -> V {
    v * (V::Real::of(1.5) - V::Real::of(0.5) * v.dot(v))
}

/// The unit vector across `to` that the smallest rotation from `from` to `to` makes of `tangent`, a unit vector across
/// `from`: for vectors across `from`, that rotation is the reflection about the bisector of both.
#[inline(always)]
fn carry<V: Vector3>(tangent: V, from: V, to: V, cosine: V::Real) -> V {
    tangent - (from + to) * (tangent.dot(to) / (V::Real::of(1.0) + cosine))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::UNIT_ROUNDOFF;
    use crate::testing::Random;

    fn assert_orthonormal(frame: Frame) {
        let Frame { x, y, z } = frame;
        for v in [x, y, z] {
            assert!((v.length() - 1.0).abs() <= 4.0 * UNIT_ROUNDOFF, "{z}: length {}", v.length());
        }
        for (v, w) in [(x, y), (y, z), (z, x)] {
            assert!(v.dot(w).abs() <= 4.0 * UNIT_ROUNDOFF, "{z}: {}", v.dot(w));
        }
        assert!((x.cross(y) - z).length() <= 8.0 * UNIT_ROUNDOFF, "right-handed around {z}");
    }

    /// Directions from 10^-17 to 0.1 radians off another one.
    fn next_to(direction: DVec3) -> impl Iterator<Item = DVec3> {
        let (u, v) = direction.any_orthonormal_pair();
        (0..=1600).flat_map(move |k| {
            let off = libm::pow(10.0, -17.0 + 0.01 * f64::from(k));
            [0.0, 1.0, 2.5, 4.0].map(|phi| {
                (direction + (u * libm::cos(phi) + v * libm::sin(phi)) * libm::tan(off)).normalize()
            })
        })
    }

    /// The basis of Frisvad (2012) cancels next to -z: in f32 it is off by 0.6.
    #[test]
    fn sa_06_orthonormal_everywhere() {
        for z in [DVec3::NEG_Z, DVec3::Z].into_iter().chain(next_to(DVec3::NEG_Z)) {
            assert_orthonormal(Frame::around(z));
        }
        let mut random = Random(3);
        for _ in 0..1_000_000 {
            assert_orthonormal(Frame::around(random.point(1.0).normalize()));
        }
    }

    /// From any frame to any direction, its opposite as well, and on along long ways, nothing is lost.
    #[test]
    fn sa_06_carried_frames_stay_orthonormal() {
        let mut random = Random(4);
        for _ in 0..100 {
            let from = Frame::around(random.direction().normalize());
            for z in next_to(-from.z).chain([-from.z, from.z]) {
                assert_orthonormal(Frame::carried(from.x, from.z, z));
            }
        }
        let (mut tangent, mut direction) = (DVec3::X, DVec3::Z);
        for _ in 0..100_000 {
            let frame = Frame::carried(tangent, -direction, random.direction().normalize());
            assert_orthonormal(frame);
            direction = random.direction().normalize();
            tangent = frame.tangent(direction);
            assert!(tangent.dot(direction).abs() <= 8.0 * UNIT_ROUNDOFF);
        }
    }

    /// Frames around neighbours are neighbours, but for the opposite of where they are carried from.
    #[test]
    fn frames_turn_no_more_than_their_directions() {
        let mut random = Random(5);
        let step = 1e-6;
        for _ in 0..100_000 {
            let from = Frame::around(random.direction().normalize());
            let z = random.direction().normalize();
            let near = (z + random.point(step)).normalize();
            let [a, b] = [z, near].map(|z| Frame::carried(from.x, from.z, z));
            // At an angle θ from the start, frames turn by tan(θ/2) of the way around it.
            let turn = 1.0 + (from.z - z).length() / (from.z + z).length();
            assert!((a.x - b.x).length() <= 2.0 * turn * (z - near).length(), "{from:?} {z}");
        }
    }
}
