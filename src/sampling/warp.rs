//! Uniform numbers bent into directions and points, with their densities.

use crate::math::{DVec2, DVec3, cos_sin_of_quarters, cos_sin_of_turns};
use std::f64::consts::PI;

/// (cosine, sine) of `u` turns.
fn turn(u: f64) -> DVec2 {
    cos_sin_of_turns(u).into()
}

/// The direction at `height` above the xy plane, in -1..=1, after `u` turns. Archimedes: heights are uniform
/// over a sphere.
pub fn at_height(height: f64, u: f64) -> DVec3 {
    let across = turn(u) * ((1.0 - height) * (1.0 + height)).max(0.0).sqrt();
    DVec3::new(across.x, across.y, height)
}

/// A direction, uniform over the sphere: density 1 / 4π.
pub fn uniform_sphere(u: DVec2) -> DVec3 {
    at_height(1.0 - 2.0 * u.x, u.y)
}

/// A direction around +z with density cos θ / π.
pub fn cosine_hemisphere(u: DVec2) -> DVec3 {
    // Malley: a uniform point of the disk below.
    let across = turn(u.y) * u.x.sqrt();
    DVec3::new(across.x, across.y, (1.0 - u.x).max(0.0).sqrt())
}

/// The density of [`cosine_hemisphere`] at an angle to +z of this cosine.
pub fn cosine_hemisphere_density(cosine: f64) -> f64 {
    cosine.max(0.0) / PI
}

/// A direction within the cone around +z of half angle θ, uniform over its solid angle. Given as 1 - cos θ,
/// which keeps its digits for narrow cones.
pub fn cone(one_minus_cosine: f64, u: DVec2) -> DVec3 {
    let depth = one_minus_cosine * u.x;
    let across = turn(u.y) * (depth * (2.0 - depth)).max(0.0).sqrt();
    DVec3::new(across.x, across.y, 1.0 - depth)
}

/// The density of [`cone`].
pub fn cone_density(one_minus_cosine: f64) -> f64 {
    1.0 / (2.0 * PI * one_minus_cosine)
}

/// A point of the unit disk, uniform over its area: density 1 / π. Shirley and Chiu's concentric map keeps
/// neighbours together, and with them the stratification of `u`.
pub fn disk(u: DVec2) -> DVec2 {
    let square = u * 2.0 - DVec2::ONE;
    if square == DVec2::ZERO {
        return DVec2::ZERO;
    }
    if square.x.abs() > square.y.abs() {
        DVec2::from(cos_sin_of_quarters(0.5 * (square.y / square.x))) * square.x
    } else {
        let (sine, cosine) = cos_sin_of_quarters(0.5 * (square.x / square.y));
        DVec2::new(cosine, sine) * square.y
    }
}

/// A point of the unit ball, uniform over its volume.
pub fn in_ball(u: DVec3) -> DVec3 {
    uniform_sphere(DVec2::new(u.x, u.y)) * libm::cbrt(u.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Angle;
    use crate::sampling::Frame;
    use crate::testing::{Random, chi_square};

    const COUNT: u32 = 400_000;
    /// Of the cases SA-01 and SA-02.
    const MANY: u32 = 4_000_000;

    fn square(random: &mut Random) -> DVec2 {
        DVec2::new(random.unit(), random.unit())
    }

    /// A normalised point of a cube holds 2.2 times too many at its corners; a point in the ball added to the normal gives
    /// a mean cosine of 0.8.
    #[test]
    fn sa_01_direction_samplers() {
        let mut random = Random(5);
        for axis in [DVec3::Z, DVec3::ONE.normalize()] {
            let frame = Frame::around(axis);
            let p = chi_square(COUNT, || Some(uniform_sphere(square(&mut random))), |_| 0.25 / PI);
            assert!(p >= 1e-4, "sphere: {p}");
            let drawn = || Some(frame.to_world(cosine_hemisphere(square(&mut random)).to_array()));
            let p = chi_square(COUNT, drawn, |d| cosine_hemisphere_density(d.dot(axis)));
            assert!(p >= 1e-4, "cosine around {axis}: {p}");
            let (mut first, mut second) = (0.0, 0.0);
            for _ in 0..MANY {
                let cosine = frame.to_world(cosine_hemisphere(square(&mut random)).to_array()).dot(axis);
                first += cosine / f64::from(MANY);
                second += cosine * cosine / f64::from(MANY);
            }
            // 4 standard errors of 4 million: the variances are 1/18 and 1/12.
            assert!((first - 2.0 / 3.0).abs() <= 5e-4 && (second - 0.5).abs() <= 6e-4, "{first} {second}");
        }
        // Caps of 5 degrees about the corner of a cube and the middle of its face.
        for axis in [DVec3::Z, DVec3::ONE.normalize()] {
            let limit = Angle(5.0).cos_sin().x;
            let inside = (0..MANY).filter(|_| uniform_sphere(square(&mut random)).dot(axis) > limit).count();
            assert!((inside as f64 / 4e6 / 0.001_902_650_954_1 - 1.0).abs() <= 0.04, "{inside}");
        }
    }

    #[test]
    fn cones_are_even() {
        let mut random = Random(6);
        for narrow in [1.0, 0.3] {
            let density = |d: DVec3| if d.z >= 1.0 - narrow { cone_density(narrow) } else { 0.0 };
            let p = chi_square(COUNT, || Some(cone(narrow, square(&mut random))), density);
            assert!(p >= 1e-4, "{narrow}: {p}");
        }
        assert_eq!(cone(1e-20, DVec2::new(0.5, 0.25)).z, 1.0);
        assert!(cone(1e-20, DVec2::new(0.5, 0.25)).length() <= 1.0 + f64::EPSILON);
    }

    /// Normalised points of a disk all lie on its rim: E[r²] = 1.
    #[test]
    fn sa_02_lens_samples() {
        let mut random = Random(7);
        let (mut square_sum, mut x_sum, mut bins) = (0.0, 0.0, [0.0; 36]);
        for _ in 0..MANY {
            let p = disk(square(&mut random));
            assert!(p.length() <= 1.0 + f64::EPSILON);
            square_sum += p.length_squared() / f64::from(MANY);
            x_sum += p.x.abs() / f64::from(MANY);
            let turn = libm::atan2(p.y, p.x) / std::f64::consts::TAU;
            bins[((turn - turn.floor()) * 36.0) as usize % 36] += 1.0;
        }
        assert!((square_sum - 0.5).abs() <= 1e-3 && (x_sum - 4.0 / (3.0 * PI)).abs() <= 1e-3);
        let expected = f64::from(MANY) / 36.0;
        let statistic: f64 = bins.iter().map(|hits| (hits - expected) * (hits - expected) / expected).sum();
        // 35 degrees of freedom: beyond 76.4 lie one in ten thousand.
        assert!(statistic < 76.4, "{statistic}");
    }
}
