//! Uniform numbers bent into directions and points, with their densities.

use crate::math::{Angle, DVec2, DVec3};
use std::f64::consts::PI;

/// (cosine, sine) of `u` turns.
fn turn(u: f64) -> DVec2 {
    Angle(360.0 * u).cos_sin()
}

/// The direction at `height` above the xy plane, in -1..=1, after `u` turns. Archimedes: heights are uniform
/// over a sphere.
fn at_height(height: f64, u: f64) -> DVec3 {
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
        Angle(45.0 * (square.y / square.x)).cos_sin() * square.x
    } else {
        let (sine, cosine) = Angle(45.0 * (square.x / square.y)).cos_sin().into();
        DVec2::new(cosine, sine) * square.y
    }
}

/// A point of the unit ball, uniform over its volume.
pub fn in_ball(u: DVec3) -> DVec3 {
    uniform_sphere(DVec2::new(u.x, u.y)) * libm::cbrt(u.z)
}
