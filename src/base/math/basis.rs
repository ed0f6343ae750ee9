//! Right-handed orthonormal frames for cameras.

use super::{DVec2, DVec3, UNIT_ROUNDOFF, error::cross};
use crate::base::digest::Content;

/// A right-handed orthonormal frame with `right` × `up` = -`forward`: a camera looks along its own -z.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
#[warn(missing_docs)]
pub struct Basis {
    /// To the right of the picture.
    pub right: DVec3,
    /// To the top of the picture.
    pub up: DVec3,
    /// Along the line of sight.
    pub forward: DVec3,
}

#[warn(missing_docs)]
impl Basis {
    /// Along the axes: the frame of a camera that looks along -z.
    pub const AXES: Self = Self { right: DVec3::X, up: DVec3::Y, forward: DVec3::NEG_Z };

    /// The frame turned about its line of sight by an angle, given as (cosine, sine). A positive angle leans
    /// the camera to its left, so the picture turns clockwise.
    pub fn rolled(self, cos_sin: DVec2) -> Self {
        let (c, s) = (cos_sin.x, cos_sin.y);
        let (right, up) = (self.right * c + self.up * s, self.up * c - self.right * s);
        Self { right, up, ..self }
    }
}

/// The frame that looks from `eye` to `target` with `up` in its upper half; `None` if eye and target are equal
/// or not finite.
///
/// `up` counts even if it is nearly parallel to the line of sight. If it is exactly parallel, or zero, `right` is +x
/// made perpendicular, or +y when the line of sight is the x axis.
#[warn(missing_docs)]
pub fn look_at(eye: DVec3, target: DVec3, up: DVec3) -> Option<Basis> {
    let forward = unit(target - eye)?;
    let right = unit(up).and_then(|up| {
        let right = cross(forward, up);
        // A product below the rounding errors of two unit vectors has no reliable direction.
        (right.length() > 4.0 * UNIT_ROUNDOFF).then(|| perpendicular(right.normalize(), forward))
    });
    let right = right.unwrap_or_else(|| {
        let axis = if forward.x.abs() > 1.0 - 4.0 * UNIT_ROUNDOFF { DVec3::Y } else { DVec3::X };
        perpendicular(axis, forward)
    });
    Some(Basis { right, up: cross(right, forward).normalize(), forward })
}

/// `v` made perpendicular to the unit vector `axis`. The second pass removes the error that cancellation leaves in
/// the first one (Parlett, "twice is enough").
pub fn perpendicular(v: DVec3, axis: DVec3) -> DVec3 {
    let once = (v - axis * v.dot(axis)).normalize();
    (once - axis * once.dot(axis)).normalize()
}

/// A unit vector. `v` is scaled first, so that tiny vectors do not underflow and huge ones do not overflow.
fn unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    (largest > 0.0 && largest.is_finite()).then(|| (v / largest).normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_orthonormal(b: Basis) {
        let bound = 8.0 * UNIT_ROUNDOFF;
        for v in [b.right, b.up, b.forward] {
            assert!((v.length() - 1.0).abs() <= bound, "{b:?}");
        }
        for (v, w) in [(b.right, b.up), (b.up, b.forward), (b.forward, b.right)] {
            assert!(v.dot(w).abs() <= bound, "{b:?}");
        }
        assert!((b.right.cross(b.up) + b.forward).length() <= 2.0 * bound, "right-handed: {b:?}");
    }

    #[test]
    fn looks_along_minus_z() {
        let b = look_at(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, DVec3::Y).expect("a frame");
        assert_eq!(b, Basis { right: DVec3::X, up: DVec3::Y, forward: DVec3::NEG_Z });
    }

    #[test]
    fn ca_03_up_on_the_line_of_sight_still_gives_a_frame() {
        let above = DVec3::new(0.0, 10.0, 0.0);
        for (eye, up) in [
            (above, DVec3::Y),
            (DVec3::new(1e-7, 10.0, 0.0), DVec3::Y),
            (above, DVec3::ZERO),
            (DVec3::new(5.0, 0.0, 0.0), DVec3::X),
            (DVec3::new(1.0, 2.0, 3.0), DVec3::new(-3.0, -6.0, -9.0)),
            (DVec3::splat(1e-200), DVec3::Y),
            (DVec3::splat(1e200), DVec3::Y),
        ] {
            assert_orthonormal(look_at(eye, DVec3::ZERO, up).expect("a frame"));
        }
        assert_eq!(look_at(above, DVec3::ZERO, DVec3::Y).map(|b| b.right), Some(DVec3::X));
    }

    #[test]
    fn ca_03_a_usable_up_is_honoured() {
        for degrees in [8.0, 1.0, 0.01] {
            let forward = DVec3::NEG_Z;
            let tilt = super::super::Angle(degrees).cos_sin();
            let up = forward * tilt.x + DVec3::Y * tilt.y;
            let b = look_at(DVec3::ZERO, forward, up).expect("a frame");
            assert_orthonormal(b);
            assert!((b.right - DVec3::X).length() <= 1e-6);
        }
    }

    #[test]
    fn ca_03_eye_on_target_has_no_frame() {
        assert_eq!(look_at(DVec3::ONE, DVec3::ONE, DVec3::Y), None);
        assert_eq!(look_at(DVec3::splat(f64::INFINITY), DVec3::ONE, DVec3::Y), None);
    }
}
