//! The space of a tree: its primitives lie around the origin, between -1 and 1.
//!
//! Errors of coordinates in it are a fraction of the tree's size, whatever the tree's place and size in the world.
//! Nothing overflows in f32.

use crate::base::math::{Aabb, DVec3};

/// The map from the world into a tree's space: translation by -`origin`, then scaling by the power of two `scale`.
#[derive(Clone, Copy, Debug, Default)]
pub struct TreeSpace {
    pub origin: DVec3,
    pub scale: f64,
    /// 1 / `scale`.
    pub size: f64,
    /// The largest absolute coordinate of the origin.
    pub(super) farthest: f64,
}

/// Within this multiple of its own extent from the world's origin, a tree uses that origin as its own.
const NEARBY: f64 = 4.0;

/// Rounding error of the map, relative to the larger of the point's and the origin's coordinates.
pub(super) const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl TreeSpace {
    /// The space in which `bounds` lie between -1 and 1.
    pub fn around(bounds: Aabb) -> Self {
        let half = (bounds.max * 0.5 - bounds.min * 0.5).max_element();
        let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
        // Uses the world's origin if it is near: then f32 coordinates stay exact, as they are only scaled.
        let (origin, reach) =
            if farthest <= NEARBY * half { (DVec3::ZERO, farthest) } else { (bounds.center(), half) };
        // Doubled, because `power_of_two` may be too small by up to a factor of two. Clamped, so that a reciprocal
        // exists.
        let size = power_of_two(reach.clamp(1e-300, 1e300)) * 2.0;
        Self { origin, scale: 1.0 / size, size, farthest: origin.abs().max_element() }
    }

    /// The largest world coordinate inside the space.
    pub fn reach(&self) -> f64 {
        self.farthest + self.size
    }

    #[inline]
    pub fn point(&self, point: DVec3) -> DVec3 {
        (point - self.origin) * self.scale
    }

    /// Whether f32 holds the point exactly in this space.
    pub fn is_exact(&self, point: DVec3) -> bool {
        self.point(point).as_vec3().as_dvec3() * self.size == point
    }

    /// Error of [`TreeSpace::point`] along each axis, for points whose largest coordinate is `longest`.
    #[inline]
    pub fn error(&self, longest: f64) -> f64 {
        let longest = if longest > self.farthest { longest } else { self.farthest };
        longest * self.scale * ROUNDING
    }

    /// The world's box in this space, with the corners rounded outwards.
    #[inline]
    pub fn outward(&self, bounds: Aabb) -> [[f32; 3]; 2] {
        let error = self.error(bounds.min.abs().max(bounds.max.abs()).max_element());
        let (min, max) = (self.point(bounds.min) - error, self.point(bounds.max) + error);
        [min.to_array().map(round_down), max.to_array().map(|v| -round_down(-v))]
    }
}

/// The largest f32 that is not above a number. Half of all numbers round up, so there are no branches.
#[inline]
fn round_down(value: f64) -> f32 {
    let near = value as f32;
    let bits = near.to_bits();
    // The number before a positive one has the bits before, that before a negative one the bits after.
    let before = (bits.cast_signed() >> 31).wrapping_mul(-2).wrapping_sub(1).cast_unsigned();
    f32::from_bits(bits.wrapping_add(before & u32::from(f64::from(near) > value).wrapping_neg()))
}

/// The largest power of two that is not above a normal number.
#[inline]
pub fn power_of_two(value: f64) -> f64 {
    f64::from_bits(value.to_bits() & 0x7ff0_0000_0000_0000)
}

/// 1 / a power of two.
#[inline]
pub fn reciprocal(power: f64) -> f64 {
    f64::from_bits(0x7fe0_0000_0000_0000_u64.wrapping_sub(power.to_bits()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    #[test]
    fn boxes_are_rounded_outwards() {
        let everywhere = [0.1, 1e-300, -0.1, 16_777_217.0, -16_777_217.0, 1e30, 0.0];
        for (v, size) in everywhere.into_iter().flat_map(|v| [0.0, 1e-9, 1.0, 1e9].map(|size| (v, size))) {
            let bounds = Aabb { min: DVec3::splat(v - size), max: DVec3::splat(v + size) };
            let space = TreeSpace::around(bounds);
            let [min, max] = space.outward(bounds);
            for (corner, rounded, side) in [(bounds.min, min, 1.0), (bounds.max, max, -1.0)] {
                let exact = (corner.x - space.origin.x) * space.scale;
                assert!((exact - f64::from(rounded[0])) * side >= 0.0, "{v} {size}");
                assert!(rounded[0].abs() <= 1.0 + 1e-6 || size == 0.0 || size.abs() < 1e-9 * v.abs());
            }
        }
    }

    #[test]
    fn numbers_are_rounded_down_to_the_next_f32() {
        let largest = f64::from(f32::MAX);
        let ends =
            [0.0, 1e-46, 1e-45, 1e-38, f64::MIN_POSITIVE, largest, largest.next_up(), 1e39, f64::INFINITY];
        let mut random = Random(3);
        let any = (0..1000).map(|_| libm::exp2(600.0 * random.unit() - 300.0) * (random.unit() - 0.5));
        for value in any.chain(ends).flat_map(|value| [value, -value, f64::from(value as f32)]) {
            let near = value as f32;
            let expected = if f64::from(near) > value { near.next_down() } else { near };
            assert_eq!(round_down(value).to_bits(), expected.to_bits(), "{value:e}");
        }
        assert!(round_down(f64::NAN).is_nan());
    }

    #[test]
    fn powers_of_two() {
        for (value, power) in [(1.0, 1.0), (1.9, 1.0), (2.0, 2.0), (0.3, 0.25), (1e-300, libm::exp2(-997.0))]
        {
            assert_eq!(power_of_two(value), power);
            assert_eq!(reciprocal(power), 1.0 / power);
        }
    }
}
