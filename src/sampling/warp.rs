//! Warping of uniform numbers to directions and points, with the densities.

use crate::base::lanes::{Real, Vec3};
use crate::base::math::{cos_sin_of_quarters, cos_sin_of_turns};
use std::f64::consts::PI;

/// The direction at `height` above the xy plane and `across` from the z axis, at an azimuth of `u` turns.
#[inline(always)]
fn around<F: Real>(height: F, across: F, u: F) -> Vec3<F> {
    let (cosine, sine) = cos_sin_of_turns(u);
    Vec3::new(cosine * across, sine * across, height)
}

/// The direction at `height` above the xy plane, in -1..=1, at an azimuth of `u` turns. Heights are uniform over a
/// sphere (Archimedes).
#[inline(always)]
pub fn direction_at_height<F: Real>(height: F, u: F) -> Vec3<F> {
    let one = F::splat(1.0);
    around(height, ((one - height) * (one + height)).max(F::splat(0.0)).sqrt(), u)
}

/// A direction for u and v in 0..1, uniform over the sphere: density 1 / 4π.
#[inline(always)]
pub fn uniform_sphere<F: Real>(u: F, v: F) -> Vec3<F> {
    direction_at_height(F::splat(1.0) - F::splat(2.0) * u, v)
}

/// A direction around +z with density cos θ / π, above a uniform point of the unit disk (Malley).
#[inline(always)]
pub fn cosine_hemisphere<F: Real>(u: F, v: F) -> Vec3<F> {
    around((F::splat(1.0) - u).max(F::splat(0.0)).sqrt(), u.sqrt(), v)
}

/// The density of [`cosine_hemisphere`] per steradian, for the cosine of the angle to +z.
#[inline(always)]
pub fn cosine_hemisphere_pdf<F: Real>(cosine: F) -> F {
    cosine.max(F::splat(0.0)) / F::splat(PI)
}

/// A direction in the cone around +z with half angle θ, uniform over its solid angle. The argument is 1 - cos θ,
/// which stays accurate for narrow cones.
#[inline(always)]
pub fn cone<F: Real>(one_minus_cosine: F, u: F, v: F) -> Vec3<F> {
    let depth = one_minus_cosine * u;
    let across = (depth * (F::splat(2.0) - depth)).max(F::splat(0.0)).sqrt();
    around(F::splat(1.0) - depth, across, v)
}

/// The density of [`cone`], per steradian.
#[inline(always)]
pub fn cone_pdf<F: Real>(one_minus_cosine: F) -> F {
    F::splat(1.0) / (F::splat(2.0 * PI) * one_minus_cosine)
}

/// A point of the unit disk, uniform over its area: density 1 / π. The concentric map of Shirley and Chiu keeps
/// neighbours together, so it preserves the stratification of u and v.
#[inline(always)]
pub fn disk<F: Real>(u: F, v: F) -> (F, F) {
    let (zero, one, two) = (F::splat(0.0), F::splat(1.0), F::splat(2.0));
    let (x, y) = (u * two - one, v * two - one);
    let flat = y.abs().lt(x.abs());
    let (long, short) = (F::select(flat, x, y), F::select(flat, y, x));
    // The centre of the square has no angle.
    let angle = F::select(long.eq(zero), zero, F::splat(0.5) * (short / long));
    let (cosine, sine) = cos_sin_of_quarters(angle);
    let (along, across) = (cosine * long, sine * long);
    (F::select(flat, along, across), F::select(flat, across, along))
}

/// A point of the unit ball, uniform over its volume.
#[inline(always)]
pub fn uniform_ball<F: Real>([u, v, w]: [F; 3]) -> Vec3<F> {
    uniform_sphere(u, v) * w.map(libm::cbrt)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::{Angle, DVec2, DVec3};
    use crate::sampling::LocalFrame;
    use crate::testing::{Random, chi_square};

    const COUNT: u32 = 400_000;
    /// The samples of the cases SA-01 and SA-02.
    const MANY: u32 = 4_000_000;

    fn square(random: &mut Random) -> DVec2 {
        DVec2::new(random.unit(), random.unit())
    }

    fn on_sphere(u: DVec2) -> DVec3 {
        uniform_sphere(u.x, u.y).into()
    }

    fn on_hemisphere(u: DVec2) -> DVec3 {
        cosine_hemisphere(u.x, u.y).into()
    }

    fn in_cone(one_minus_cosine: f64, u: DVec2) -> DVec3 {
        cone(one_minus_cosine, u.x, u.y).into()
    }

    /// Normalized points of a cube have 2.2 times the density at its corners. The normal plus a point in the ball has
    /// a mean cosine of 0.8.
    #[test]
    fn sa_01_direction_samplers() {
        let mut random = Random(5);
        for axis in [DVec3::Z, DVec3::ONE.normalize()] {
            let frame = LocalFrame::from_z(axis.into());
            let turned = |d: DVec3| DVec3::from(frame.to_world(d.into()));
            let p = chi_square(COUNT, || Some(on_sphere(square(&mut random))), |_| 0.25 / PI);
            assert!(p >= 1e-4, "sphere: {p}");
            let drawn = || Some(turned(on_hemisphere(square(&mut random))));
            let p = chi_square(COUNT, drawn, |d| cosine_hemisphere_pdf(d.dot(axis)));
            assert!(p >= 1e-4, "cosine around {axis}: {p}");
            let (mut first, mut second) = (0.0, 0.0);
            for _ in 0..MANY {
                let cosine = turned(on_hemisphere(square(&mut random))).dot(axis);
                first += cosine / f64::from(MANY);
                second += cosine * cosine / f64::from(MANY);
            }
            // 4 standard errors of 4 million: the variances are 1/18 and 1/12.
            assert!((first - 2.0 / 3.0).abs() <= 5e-4 && (second - 0.5).abs() <= 6e-4, "{first} {second}");
        }
        // Caps of 5 degrees around the corner of a cube and the centre of its face.
        for axis in [DVec3::Z, DVec3::ONE.normalize()] {
            let limit = Angle(5.0).cos_sin().x;
            let inside = (0..MANY).filter(|_| on_sphere(square(&mut random)).dot(axis) > limit).count();
            assert!((inside as f64 / 4e6 / 0.001_902_650_954_1 - 1.0).abs() <= 0.04, "{inside}");
        }
    }

    #[test]
    fn cones_are_even() {
        let mut random = Random(6);
        for narrow in [1.0, 0.3] {
            let density = |d: DVec3| if d.z >= 1.0 - narrow { cone_pdf(narrow) } else { 0.0 };
            let p = chi_square(COUNT, || Some(in_cone(narrow, square(&mut random))), density);
            assert!(p >= 1e-4, "{narrow}: {p}");
        }
        assert_eq!(in_cone(1e-20, DVec2::new(0.5, 0.25)).z, 1.0);
        assert!(in_cone(1e-20, DVec2::new(0.5, 0.25)).length() <= 1.0 + f64::EPSILON);
    }

    /// Normalized points of a disk are all on its rim: E[r²] = 1.
    #[test]
    fn sa_02_lens_samples() {
        let mut random = Random(7);
        let (mut square_sum, mut x_sum, mut bins) = (0.0, 0.0, [0.0; 36]);
        for _ in 0..MANY {
            let p = DVec2::from({
                let u = square(&mut random);
                disk(u.x, u.y)
            });
            assert!(p.length() <= 1.0 + f64::EPSILON);
            square_sum += p.length_squared() / f64::from(MANY);
            x_sum += p.x.abs() / f64::from(MANY);
            let turn = libm::atan2(p.y, p.x) / std::f64::consts::TAU;
            bins[((turn - turn.floor()) * 36.0) as usize % 36] += 1.0;
        }
        assert!((square_sum - 0.5).abs() <= 1e-3 && (x_sum - 4.0 / (3.0 * PI)).abs() <= 1e-3);
        let expected = f64::from(MANY) / 36.0;
        let statistic: f64 = bins.iter().map(|hits| (hits - expected) * (hits - expected) / expected).sum();
        // With 35 degrees of freedom, one in ten thousand exceeds 76.4.
        assert!(statistic < 76.4, "{statistic}");
    }
}
