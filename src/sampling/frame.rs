//! Orthonormal frames around a direction.

use crate::base::lanes::{Real, Select, Vec3};
use crate::base::math::DVec3;

/// A right-handed orthonormal frame whose z axis is a given direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame<F> {
    pub x: Vec3<F>,
    pub y: Vec3<F>,
    pub z: Vec3<F>,
}

/// The cosine beyond which a direction is so near to an axis that its part across the axis loses digits.
const NEAR: f64 = 0.99;

impl<F: Real> Frame<F> {
    /// The frame around the unit vector `z` that the smallest rotation makes of the coordinate axes.
    #[inline(always)]
    pub fn around(z: Vec3<F>) -> Self {
        Self::identity().turned_to(z)
    }

    /// The frame of the coordinate axes.
    #[inline(always)]
    pub fn identity() -> Self {
        Self { x: Vec3::splat(DVec3::X), y: Vec3::splat(DVec3::Y), z: Vec3::splat(DVec3::Z) }
    }

    /// The frame around the unit vector `z`, of which the x axis is as near as can be to the first of two orthogonal unit
    /// vectors: it turns smoothly with `z`. Only near the first does the second take its place.
    #[inline(always)]
    pub fn along(z: Vec3<F>, [first, second]: [DVec3; 2]) -> Self {
        let (first, second) = (Vec3::splat(first), Vec3::splat(second));
        let near = F::splat(NEAR).lt(first.dot(z).abs());
        let axis = Vec3::select(near, second, first);
        Self::of_axes(axis - z * axis.dot(z), z)
    }

    /// This frame turned along the shortest way until its z axis is another one (a unit vector): it turns smoothly with
    /// that, unless it is opposite to this z axis. So samples that are stratified around neighbouring normals stay so.
    #[inline(always)]
    pub fn turned_to(&self, z: Vec3<F>) -> Self {
        let one = F::splat(1.0);
        let apart = one + self.z.dot(z);
        let share = self.x.dot(z) / apart;
        let opposite = apart.lt(F::splat(f64::EPSILON));
        let turned = self.x - (self.z + z) * share;
        Self::of_axes(Vec3::select(opposite, self.x, turned), z)
    }

    /// The frame of a vector that is nearly across the unit vector `z`, and that.
    #[inline(always)]
    fn of_axes(x: Vec3<F>, z: Vec3<F>) -> Self {
        let x = of_unit_length((x - z * x.dot(z)).normalize());
        Self { x, y: of_unit_length(z.cross(x)), z }
    }

    /// A vector given along the frame's axes.
    #[inline(always)]
    pub fn to_world(&self, v: Vec3<F>) -> Vec3<F> {
        self.x * v.x + self.y * v.y + self.z * v.z
    }

    /// A vector's parts along the frame's axes.
    #[inline(always)]
    pub fn to_local(&self, v: Vec3<F>) -> Vec3<F> {
        Vec3::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }
}

/// A vector whose length is 1 but for rounding, at that length.
#[inline(always)]
fn of_unit_length<F: Real>(v: Vec3<F>) -> Vec3<F> {
    v * (F::splat(1.5) - F::splat(0.5) * v.dot(v))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::UNIT_ROUNDOFF;
    use crate::testing::Random;

    fn assert_orthonormal(frame: &Frame<f64>) {
        let [x, y, z] = [frame.x, frame.y, frame.z].map(DVec3::from);
        for v in [x, y, z] {
            assert!((v.length() - 1.0).abs() <= 4.0 * UNIT_ROUNDOFF, "{z}: length {}", v.length());
        }
        for (v, w) in [(x, y), (y, z), (z, x)] {
            assert!(v.dot(w).abs() <= 4.0 * UNIT_ROUNDOFF, "{z}: {}", v.dot(w));
        }
        assert!((x.cross(y) - z).length() <= 8.0 * UNIT_ROUNDOFF, "right-handed around {z}");
    }

    const AXES: [DVec3; 2] = [DVec3::X, DVec3::Y];

    /// All ways to a frame around a direction.
    fn assert_all(z: DVec3, other: DVec3) {
        assert_orthonormal(&Frame::around(z.into()));
        let along = Frame::along(z.into(), AXES);
        assert_orthonormal(&along);
        assert_orthonormal(&along.turned_to(other.into()));
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
        let axes = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
        for (z, other) in axes.into_iter().flat_map(|z| axes.map(|other| (z, other))) {
            assert_all(z, other);
        }
        for z in axes.into_iter().flat_map(next_to) {
            for other in [DVec3::Z, -z, DVec3::new(-z.x, -z.y, -z.z + 1e-7), z] {
                assert_all(z, other.normalize());
            }
        }
        let mut random = Random(3);
        for _ in 0..1_000_000 {
            assert_all(random.point(1.0).normalize(), random.point(1.0).normalize());
        }
    }

    /// From any frame to any direction, its opposite as well, and on along long ways, nothing is lost.
    #[test]
    fn sa_06_turned_frames_stay_orthonormal() {
        let mut random = Random(4);
        for _ in 0..100 {
            let frame = Frame::around(random.direction().normalize().into());
            let z = DVec3::from(frame.z);
            for other in next_to(-z).chain([-z, z]) {
                assert_orthonormal(&frame.turned_to(other.into()));
            }
        }
        let mut frame = Frame::along(DVec3::Z.into(), AXES);
        for _ in 0..100_000 {
            frame = frame.turned_to(random.direction().normalize().into());
            assert_orthonormal(&frame);
        }
    }

    /// Frames around neighbours are neighbours, but for the opposite of where they are turned from.
    #[test]
    fn frames_turn_no_more_than_their_directions() {
        let mut random = Random(5);
        let step = 1e-6;
        for _ in 0..100_000 {
            let from = Frame::around(random.direction().normalize().into());
            let z = random.direction().normalize();
            let near = (z + random.point(step)).normalize();
            let [a, b] = [z, near].map(|z| DVec3::from(from.turned_to(z.into()).x));
            // At an angle θ from the start, frames turn by tan(θ/2) of the way around it.
            let start = DVec3::from(from.z);
            let turn = 1.0 + (start - z).length() / (start + z).length();
            assert!((a - b).length() <= 2.0 * turn * (z - near).length(), "{from:?} {z}");
        }
    }

    /// A quarter of a degree turns a frame by about as much, wherever a surface that is seen may face.
    #[test]
    fn frames_turn_with_the_normals_that_are_seen() {
        let mut random = Random(4);
        for _ in 0..100_000 {
            let to_eye = (random.point(0.6) + DVec3::Z * 2.0).normalize();
            let frame = Frame::along(to_eye.into(), AXES);
            let normal = random.direction();
            let normal = if normal.dot(to_eye) < 0.0 { -normal } else { normal };
            let beside = (normal + random.direction() * 0.004).normalize();
            let [a, b] = [normal, beside].map(|normal| DVec3::from(frame.turned_to(normal.into()).x));
            assert!((a - b).length() < 0.02, "{normal}: {a} and {b}");
        }
    }
}
