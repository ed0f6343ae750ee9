//! Orthonormal frames around directions.

use crate::base::lanes::{Real, Select, Vec3};
use crate::base::math::DVec3;

/// A right-handed orthonormal frame whose z axis is a given direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalFrame<F> {
    pub x: Vec3<F>,
    pub y: Vec3<F>,
    pub z: Vec3<F>,
}

/// The cosine above which a direction is too close to an axis: its component perpendicular to the axis loses digits.
const NEAR: f64 = 0.99;

/// What frames are turned from: a unit vector z, and an x axis of any length that is nearly perpendicular to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameAxes<F> {
    pub x: Vec3<F>,
    pub z: Vec3<F>,
}

impl<F: Real> FrameAxes<F> {
    /// Two of the coordinate axes.
    #[inline(always)]
    pub fn identity() -> Self {
        Self { x: Vec3::splat(DVec3::X), z: Vec3::splat(DVec3::Z) }
    }

    /// The axes around the unit vector `z` whose x axis is as close as possible to `first`, one of two orthogonal
    /// unit vectors. They turn smoothly with `z`. If `z` is close to `first`, `second` replaces `first`.
    #[inline(always)]
    pub fn from_z_near_x(z: Vec3<F>, [first, second]: [DVec3; 2]) -> Self {
        let (first, second) = (Vec3::splat(first), Vec3::splat(second));
        let near = F::splat(NEAR).lt(first.dot(z).abs());
        let axis = Vec3::select(near, second, first);
        Self { x: axis - z * axis.dot(z), z }
    }

    /// The frame after the smallest rotation that moves the z axis to the unit vector `z`. It turns smoothly with `z`,
    /// unless `z` is opposite to the old z axis. So samples around neighbouring normals stay stratified.
    #[inline(always)]
    pub fn rotated_to(&self, z: Vec3<F>) -> LocalFrame<F> {
        let one = F::splat(1.0);
        let apart = one + self.z.dot(z);
        let share = self.x.dot(z) / apart;
        let opposite = apart.lt(F::splat(f64::EPSILON));
        let turned = self.x - (self.z + z) * share;
        LocalFrame::of_axes(Vec3::select(opposite, self.x, turned), z)
    }
}

impl<F: Real> LocalFrame<F> {
    /// The frame of the coordinate axes.
    #[inline(always)]
    pub fn identity() -> Self {
        Self { x: Vec3::splat(DVec3::X), y: Vec3::splat(DVec3::Y), z: Vec3::splat(DVec3::Z) }
    }

    /// The frame around the unit vector `z` that results from the smallest rotation of the coordinate axes.
    #[inline(always)]
    pub fn from_z(z: Vec3<F>) -> Self {
        FrameAxes::identity().rotated_to(z)
    }

    /// The frame of the unit vector `z` and a vector `x` that is nearly perpendicular to it.
    #[inline(always)]
    fn of_axes(x: Vec3<F>, z: Vec3<F>) -> Self {
        let x = of_unit_length((x - z * x.dot(z)).normalize());
        Self { x, y: of_unit_length(z.cross(x)), z }
    }

    /// Converts a vector from frame coordinates.
    #[inline(always)]
    pub fn to_world(&self, v: Vec3<F>) -> Vec3<F> {
        self.x * v.x + self.y * v.y + self.z * v.z
    }

    /// Converts a vector to frame coordinates.
    #[inline(always)]
    pub fn to_local(&self, v: Vec3<F>) -> Vec3<F> {
        Vec3::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }
}

/// A vector whose length is nearly 1, at length 1: one Newton step for the reciprocal length.
#[inline(always)]
fn of_unit_length<F: Real>(v: Vec3<F>) -> Vec3<F> {
    v * (F::splat(1.5) - F::splat(0.5) * v.dot(v))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::UNIT_ROUNDOFF;
    use crate::testing::Random;

    fn assert_orthonormal(frame: &LocalFrame<f64>) {
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

    fn axes_of(frame: &LocalFrame<f64>) -> FrameAxes<f64> {
        FrameAxes { x: frame.x, z: frame.z }
    }

    /// Checks every constructor of a frame around a direction.
    fn assert_all(z: DVec3, other: DVec3) {
        assert_orthonormal(&LocalFrame::from_z(z.into()));
        let axes = FrameAxes::from_z_near_x(z.into(), AXES);
        let along = axes.rotated_to(z.into());
        assert_orthonormal(&along);
        assert_orthonormal(&axes.rotated_to(other.into()));
        assert_orthonormal(&axes_of(&along).rotated_to(other.into()));
    }

    /// Directions at 10^-17 to 0.1 radians from another one.
    fn next_to(direction: DVec3) -> impl Iterator<Item = DVec3> {
        let (u, v) = direction.any_orthonormal_pair();
        (0..=1600).flat_map(move |k| {
            let off = libm::pow(10.0, -17.0 + 0.01 * f64::from(k));
            [0.0, 1.0, 2.5, 4.0].map(|phi| {
                (direction + (u * libm::cos(phi) + v * libm::sin(phi)) * libm::tan(off)).normalize()
            })
        })
    }

    /// The basis of Frisvad (2012) suffers from cancellation next to -z: its error in f32 is 0.6.
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

    /// Rotation from any frame to any direction, also to the opposite one, and many rotations in a row, lose no
    /// accuracy.
    #[test]
    fn sa_06_turned_frames_stay_orthonormal() {
        let mut random = Random(4);
        for _ in 0..100 {
            let frame = LocalFrame::from_z(random.direction().normalize().into());
            let z = DVec3::from(frame.z);
            for other in next_to(-z).chain([-z, z]) {
                assert_orthonormal(&axes_of(&frame).rotated_to(other.into()));
            }
        }
        let mut frame = LocalFrame::from_z(DVec3::Z.into());
        for _ in 0..100_000 {
            frame = axes_of(&frame).rotated_to(random.direction().normalize().into());
            assert_orthonormal(&frame);
        }
    }

    /// Frames around close directions are close, except near the opposite of the start.
    #[test]
    fn frames_turn_no_more_than_their_directions() {
        let mut random = Random(5);
        let step = 1e-6;
        for _ in 0..100_000 {
            let from = axes_of(&LocalFrame::from_z(random.direction().normalize().into()));
            let z = random.direction().normalize();
            let near = (z + random.point(step)).normalize();
            let [a, b] = [z, near].map(|z| DVec3::from(from.rotated_to(z.into()).x));
            // At an angle θ from the start, frames turn by tan(θ/2) times the distance around it.
            let start = DVec3::from(from.z);
            let turn = 1.0 + (start - z).length() / (start + z).length();
            assert!((a - b).length() <= 2.0 * turn * (z - near).length(), "{from:?} {z}");
        }
    }

    /// If the normal of a visible surface turns by a quarter of a degree, its frame turns by about as much.
    #[test]
    fn frames_turn_with_visible_normals() {
        let mut random = Random(4);
        for _ in 0..100_000 {
            let to_eye = (random.point(0.6) + DVec3::Z * 2.0).normalize();
            let axes = FrameAxes::from_z_near_x(to_eye.into(), AXES);
            let normal = random.direction();
            let normal = if normal.dot(to_eye) < 0.0 { -normal } else { normal };
            let beside = (normal + random.direction() * 0.004).normalize();
            let [a, b] = [normal, beside].map(|normal| DVec3::from(axes.rotated_to(normal.into()).x));
            assert!((a - b).length() < 0.02, "{normal}: {a} and {b}");
        }
    }
}
