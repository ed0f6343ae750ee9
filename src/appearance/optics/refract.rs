//! Directions of reflected and refracted rays.

use crate::base::lanes::{Real, Select, Vec3};

/// Reflects `direction` at a mirror with the normal `normal`.
#[inline(always)]
pub fn reflect<F: Real>(direction: Vec3<F>, normal: Vec3<F>) -> Vec3<F> {
    direction - normal * (F::splat(2.0) * normal.dot(direction))
}

/// A refracted direction.
#[derive(Clone, Copy, Debug)]
pub struct Refraction<F: Real> {
    /// Unit vector behind the boundary.
    pub direction: Vec3<F>,
    /// The cosine of the refracted angle.
    pub cosine: F,
    /// Lanes with total internal reflection.
    pub is_total: F::Mask,
}

/// Refracts `direction` (a unit vector) at a boundary by Snell's law. The unit normal faces the incoming light. `eta`
/// is the index of refraction behind the boundary over that in front of it.
#[inline(always)]
pub fn refract<F: Real>(direction: Vec3<F>, normal: Vec3<F>, eta: F) -> Refraction<F> {
    let (zero, one) = (F::splat(0.0), F::splat(1.0));
    let cosine = -direction.dot(normal);
    // The tangential part of the refracted direction. Its length is the sine, without the cancellation of 1 - cos².
    let along = (direction + normal * cosine) / eta;
    let sine = along.length();
    let refracted = ((one - sine) * (one + sine)).max(zero).sqrt();
    let bent = (along - normal * refracted).normalize();
    // If the indices are equal, the direction keeps every bit.
    let same = eta.eq(one);
    Refraction {
        direction: Vec3::select(same, direction, bent),
        cosine: F::select(same, cosine, refracted),
        is_total: one.lt(sine) & !same,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::{Angle, DVec3};

    fn refracted(direction: DVec3, normal: DVec3, eta: f64) -> Option<(DVec3, f64)> {
        let Refraction { direction, cosine, is_total } = refract(direction.into(), normal.into(), eta);
        (!is_total).then(|| (direction.into(), cosine))
    }

    #[test]
    fn snells_law_both_ways() {
        for degrees in [0.0, 1e-6, 20.0, 45.0, 70.0, 89.999] {
            let turn = Angle(degrees).cos_sin();
            let into = DVec3::new(turn.y, -turn.x, 0.0);
            let (inside, cosine) = refracted(into, DVec3::Y, 1.5).expect("light enters");
            assert!((inside.x * 1.5 - into.x).abs() < 1e-15 && (inside.y + cosine).abs() < 1e-15);
            let (out, _) = refracted(inside, DVec3::Y, 1.0 / 1.5).expect("light leaves");
            // The cosine of a grazing ray is the root of a difference, which loses half of the digits.
            assert!((out - into).length() < if degrees > 80.0 { 1e-11 } else { 1e-15 }, "{degrees}");
        }
        let steep = DVec3::new(0.8, 0.6, 0.0);
        assert_eq!(refracted(steep, DVec3::NEG_Y, 1.0 / 1.5), None);
        assert_eq!(refracted(steep, DVec3::NEG_Y, 1.0), Some((steep, 0.6)));
        assert_eq!(reflect(steep.into(), DVec3::NEG_Y.into()), DVec3::new(0.8, -0.6, 0.0).into());
    }
}
