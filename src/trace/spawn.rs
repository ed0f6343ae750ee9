//! The one place where rays start on a surface.

use crate::camera::Ray;
use crate::math::{DVec3, next_away};
use crate::optics::reflect;
use crate::shape::Surface;

/// A ray from a surface that cannot meet it again where it starts: its origin is moved along the normal, to
/// the side that the direction leads to, past everything that rounding may have done to the point, and each
/// coordinate is rounded away from it (Pharr, Jakob, Humphreys, *Physically Based Rendering*, section 6.8.6).
#[inline]
pub fn spawn(surface: &Surface, direction: DVec3) -> Ray {
    let side = if direction.dot(surface.normal) < 0.0 { -surface.normal } else { surface.normal };
    Ray { origin: origin(surface, surface.point, side), direction }
}

/// A ray along which light is gathered: one that leaves the smooth surface which a mesh stands for starts from there
/// (Hanika, *Hacking the Shadow Terminator*, in *Ray Tracing Gems II*, 2021), on the side that is seen, so that
/// triangles do not shadow what is shaded as if they were curved.
#[inline]
pub fn spawn_gathering(surface: &Surface, direction: DVec3) -> Ray {
    if !surface.smoothly_faces(direction) {
        return spawn(surface, direction);
    }
    Ray { origin: origin(surface, surface.point + surface.lift, surface.normal), direction }
}

/// The ray by which a mirror sends light on in a direction that its smooth normal gives. Where that leads below the flat
/// surface but away from the smooth one which this stands for, it starts from there. Else, as where the smooth surface is
/// hollow, it comes up again from the flat one, by which it is reflected once more: light that was dropped would leave
/// black specks.
#[inline]
pub fn spawn_mirrored(surface: &Surface, direction: DVec3) -> Ray {
    if direction.dot(surface.normal) > 0.0 {
        return spawn(surface, direction);
    }
    if surface.smoothly_faces(direction) {
        return spawn_gathering(surface, direction);
    }
    spawn(surface, reflect(direction, surface.normal))
}

/// The start of a ray at a point of a surface, or above it, on a side of it.
#[inline]
fn origin(surface: &Surface, point: DVec3, side: DVec3) -> DVec3 {
    let reach = surface.normal.abs().dot(surface.error);
    let moved = point + side * reach;
    DVec3::new(next_away(moved.x, side.x), next_away(moved.y, side.y), next_away(moved.z, side.z))
}

/// The ray from a surface to a point from which light may come: it reaches the point at t = 1.
#[inline]
pub fn spawn_to(surface: &Surface, target: DVec3) -> Ray {
    let origin = spawn_gathering(surface, target - surface.point).origin;
    Ray { origin, direction: target - origin }
}

/// The ray from a surface to another one, which it has not met yet at t = 1.
#[inline]
pub fn spawn_between(surface: &Surface, target: &Surface) -> Ray {
    spawn_to(surface, spawn(target, surface.point - target.point).origin)
}
