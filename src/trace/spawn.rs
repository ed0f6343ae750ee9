//! Spawning of rays: the only place where rays start on surfaces.

use crate::appearance::optics::reflect;
use crate::base::lanes::{Mask, Real, Select, Vec3, out_of_line};
use crate::base::math::{DVec3, Ray};
use crate::geometry::shape::{LaneSurface, Surface};

/// Rays that start on surfaces.
#[derive(Clone, Copy)]
pub struct Spawn<F: Real> {
    pub origin: Vec3<F>,
    pub direction: Vec3<F>,
    /// Lanes with a valid ray. Light that a surface would reflect below itself is lost.
    pub is_valid: F::Mask,
}

impl<F: Real> Select<F::Mask> for Spawn<F> {
    #[inline(always)]
    fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        Self {
            origin: Vec3::select(mask, yes.origin, no.origin),
            direction: Vec3::select(mask, yes.direction, no.direction),
            is_valid: (mask & yes.is_valid) | (!mask & no.is_valid),
        }
    }
}

out_of_line! {
    /// Spawns a ray that leaves a surface in a direction and cannot hit it again at its origin. The point moves along
    /// the normal, to the side of the direction, past the error bound of the point. Then each coordinate is rounded
    /// away from the point (Pharr, Jakob, Humphreys, *Physically Based Rendering*, section 6.8.6).
    pub fn spawn<'k, F>(surface: &'k LaneSurface<F>, direction: Vec3<F>) -> Spawn<F> {
        spawn_flat(surface, direction)
    }
}

/// [`spawn`] within another function.
#[inline(always)]
fn spawn_flat<F: Real>(surface: &LaneSurface<F>, direction: Vec3<F>) -> Spawn<F> {
    let below = direction.dot(surface.normal).lt(F::splat(0.0));
    let origin = offset_ray_origin(surface, surface.point, surface.normal.negate_where(below));
    Spawn { origin, direction, is_valid: F::Mask::splat(true) }
}

/// [`spawn`] of one ray.
pub fn spawn_ray(surface: &Surface, direction: DVec3) -> Ray {
    let Spawn { origin, direction, .. } = spawn::<f64>(&surface.into(), direction.into());
    Ray { origin: origin.into(), direction: direction.into() }
}

out_of_line! {
    /// Spawns a ray towards light. If it leaves the smooth surface that a mesh approximates, it starts from that
    /// surface, on the visible side (Hanika, *Hacking the Shadow Terminator*, in *Ray Tracing Gems II*, 2021). So
    /// triangles do not cast shadows on neighbours that are shaded as curved.
    pub fn spawn_lifted<'k, F>(surface: &'k LaneSurface<F>, direction: Vec3<F>) -> Spawn<F> {
        let start = spawn_flat(surface, direction);
        let smooth = surface.smoothly_faces(direction);
        if !smooth.any() {
            return start;
        }
        let lifted = offset_ray_origin(surface, surface.point + surface.lift, surface.normal);
        Spawn { origin: Vec3::select(smooth, lifted, start.origin), ..start }
    }
}

/// [`spawn_lifted`] in a direction that was sampled around a smooth normal. Directions below the surface are invalid.
#[inline(always)]
pub fn spawn_scattered<F: Real>(surface: &LaneSurface<F>, direction: Vec3<F>) -> Spawn<F> {
    let above = F::splat(0.0).lt(surface.normal.dot(direction)) | surface.smoothly_faces(direction);
    Spawn { is_valid: above, ..spawn_lifted(surface, direction) }
}

out_of_line! {
    /// Spawns the reflection of a mirror, in a direction that follows from a smooth normal. The direction may point
    /// below the flat surface. If it points away from the smooth surface, the ray starts from that. Otherwise, as where
    /// the smooth surface is hollow, the flat surface reflects it once more. Dropping such rays would leave black
    /// specks.
    pub fn spawn_reflected<'k, F>(surface: &'k LaneSurface<F>, direction: Vec3<F>) -> Spawn<F> {
        let below = surface.normal.dot(direction).le(F::splat(0.0));
        if !below.any() {
            return spawn_flat(surface, direction);
        }
        let smooth = below & surface.smoothly_faces(direction);
        let up = reflect(direction, surface.normal);
        let start = spawn(surface, Vec3::select(below & !smooth, up, direction));
        let lifted = offset_ray_origin(surface, surface.point + surface.lift, surface.normal);
        Spawn { origin: Vec3::select(smooth, lifted, start.origin), ..start }
    }
}

/// A point on or above a surface, moved to one side past its error bound.
#[inline(always)]
fn offset_ray_origin<F: Real>(surface: &LaneSurface<F>, point: Vec3<F>, side: Vec3<F>) -> Vec3<F> {
    let reach = surface.normal.abs().dot(surface.error);
    let moved = point + side * reach;
    Vec3::new(moved.x.next_away(side.x), moved.y.next_away(side.y), moved.z.next_away(side.z))
}
