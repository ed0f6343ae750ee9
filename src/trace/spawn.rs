//! The one place where rays start on a surface.

use crate::appearance::optics::reflect;
use crate::base::lanes::{Mask, Real, Select, Vec3, out_of_line};
use crate::base::math::{DVec3, Ray};
use crate::geometry::shape::{LaneSurface, Surface};

/// Rays that start on surfaces.
#[derive(Clone, Copy)]
pub struct Spawn<F: Real> {
    pub origin: Vec3<F>,
    pub direction: Vec3<F>,
    /// Lanes in which there is one: light that would be reflected below its surface is lost.
    pub is_sound: F::Mask,
}

impl<F: Real> Select<F::Mask> for Spawn<F> {
    #[inline(always)]
    fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        Self {
            origin: Vec3::select(mask, yes.origin, no.origin),
            direction: Vec3::select(mask, yes.direction, no.direction),
            is_sound: (mask & yes.is_sound) | (!mask & no.is_sound),
        }
    }
}

out_of_line! {
    /// Where a ray starts that leaves a surface in a direction and cannot meet it again there: the point is moved along the
    /// normal, to the side that the direction leads to, past everything that rounding may have done to it, and each
    /// coordinate is rounded away from it (Pharr, Jakob, Humphreys, *Physically Based Rendering*, section 6.8.6).
    pub fn spawn<'k, F>(surface: &'k LaneSurface<F>, direction: Vec3<F>) -> Spawn<F> {
        let below = direction.dot(surface.normal).lt(F::splat(0.0));
        let origin = beyond(surface, surface.point, surface.normal.negate_where(below));
        Spawn { origin, direction, is_sound: F::Mask::splat(true) }
    }
}

/// [`spawn`] of one ray.
pub fn spawn_ray(surface: &Surface, direction: DVec3) -> Ray {
    let Spawn { origin, direction, .. } = spawn::<f64>(&surface.into(), direction.into());
    Ray { origin: origin.into(), direction: direction.into() }
}

out_of_line! {
    /// A ray along which light is gathered: one that leaves the smooth surface which a mesh stands for starts from there
    /// (Hanika, *Hacking the Shadow Terminator*, in *Ray Tracing Gems II*, 2021), on the side that is seen, so that triangles
    /// do not shadow what is shaded as if they were curved.
    pub fn spawn_gathering<'k, F>(surface: &'k LaneSurface<F>, direction: Vec3<F>) -> Spawn<F> {
        let start = spawn(surface, direction);
        let smooth = surface.smoothly_faces(direction);
        if !smooth.any() {
            return start;
        }
        let lifted = beyond(surface, surface.point + surface.lift, surface.normal);
        Spawn { origin: Vec3::select(smooth, lifted, start.origin), ..start }
    }
}

/// [`spawn_gathering`] in a direction that was drawn around a smooth normal: none below the surface.
#[inline(always)]
pub fn spawn_scattered<F: Real>(surface: &LaneSurface<F>, direction: Vec3<F>) -> Spawn<F> {
    let above = F::splat(0.0).lt(surface.normal.dot(direction)) | surface.smoothly_faces(direction);
    Spawn { is_sound: above, ..spawn_gathering(surface, direction) }
}

out_of_line! {
    /// The ray by which a mirror sends light on in a direction that its smooth normal gives. Where that leads below the flat
    /// surface but away from the smooth one which this stands for, it starts from there. Else, as where the smooth surface is
    /// hollow, it comes up again from the flat one, by which it is reflected once more: light that was dropped would leave
    /// black specks.
    pub fn spawn_mirrored<'k, F>(surface: &'k LaneSurface<F>, direction: Vec3<F>) -> Spawn<F> {
        let below = surface.normal.dot(direction).le(F::splat(0.0));
        if !below.any() {
            return spawn(surface, direction);
        }
        let smooth = below & surface.smoothly_faces(direction);
        let up = reflect(direction, surface.normal);
        let start = spawn(surface, Vec3::select(below & !smooth, up, direction));
        let lifted = beyond(surface, surface.point + surface.lift, surface.normal);
        Spawn { origin: Vec3::select(smooth, lifted, start.origin), ..start }
    }
}

/// A point of a surface, or above it, moved to a side of it.
#[inline(always)]
fn beyond<F: Real>(surface: &LaneSurface<F>, point: Vec3<F>, side: Vec3<F>) -> Vec3<F> {
    let reach = surface.normal.abs().dot(surface.error);
    let moved = point + side * reach;
    Vec3::new(moved.x.next_away(side.x), moved.y.next_away(side.y), moved.z.next_away(side.z))
}
