//! Boundaries between two media.

use super::Bsdf;
use crate::appearance::optics::{Fresnel, Refraction, refract};
use crate::base::lanes::{Color, Real, Select, Vec3};
use crate::trace::materials::LobeSet;

/// The indices of refraction on the two sides of a surface that light meets.
#[derive(Clone, Copy)]
pub struct Boundary<F> {
    /// That behind the surface over that before it.
    pub eta: F,
}

/// Light that meets a boundary.
#[derive(Clone, Copy)]
pub struct Bent<F: Real> {
    /// Where it goes on behind the boundary.
    pub direction: Vec3<F>,
    /// The share that the boundary reflects instead: all of it where none passes.
    pub reflected: F,
    pub is_total: F::Mask,
}

impl<F: Real> Boundary<F> {
    /// What becomes of light that meets the boundary in a direction, across a normal that faces it (both unit vectors).
    #[inline(always)]
    pub fn meet(&self, fresnel: Fresnel, direction: Vec3<F>, normal: Vec3<F>) -> Bent<F> {
        let Refraction { direction: bent, cosine, is_total } = refract(direction, normal, self.eta);
        let reflected = fresnel.reflectance(-direction.dot(normal), cosine, self.eta);
        Bent { direction: bent, reflected: F::select(is_total, F::splat(1.0), reflected), is_total }
    }

    /// The share of light that is reflected where it goes straight on, as shadow rays do. Between two boundaries of a
    /// thing that is so thin or so large that it hardly shifts light, the way outside is the straight one, and inside it
    /// is bent: the angle is that on the side of the lower index, from where no light is reflected totally.
    #[inline(always)]
    pub fn straight(&self, fresnel: Fresnel, direction: Vec3<F>, normal: Vec3<F>) -> F {
        let eta = self.eta.max(F::splat(1.0) / self.eta);
        let Refraction { cosine, is_total, .. } = refract(direction, normal, eta);
        let reflected = fresnel.reflectance(-direction.dot(normal), cosine, eta);
        F::select(is_total, F::splat(0.0), reflected)
    }
}

/// Where light goes on at a boundary.
#[derive(Clone, Copy)]
pub struct BoundarySample<F: Real> {
    pub direction: Vec3<F>,
    /// What its throughput is multiplied with.
    pub share: Color<F::F32>,
    /// Lanes in which it passes; in others it is reflected.
    pub passes: F::Mask,
}

impl<F: Real> Bsdf<'_, F> {
    /// Through the boundary, or back from it, by the share that it reflects and a number in 0..1.
    #[inline(always)]
    pub fn boundary_sample(&self, boundary: &Boundary<F>, choice: F) -> BoundarySample<F> {
        let bent = boundary.meet(self.lobes.fresnel(), -self.to_eye, self.normal);
        let passes = !bent.is_total & bent.reflected.le(choice);
        // A boundary reflects all colours alike, whatever colour it lets pass; but totally it reflects as it passes.
        let alike = Color::grey(self.refraction.max_element());
        let mirrored = Color::select(bent.is_total, self.refraction, alike);
        BoundarySample {
            direction: Vec3::select(passes, bent.direction, self.mirrored()),
            share: Color::select(passes, self.refraction, mirrored),
            passes,
        }
    }

    /// Whether any lane may have a boundary.
    #[inline(always)]
    pub fn refracts(&self) -> bool {
        self.lobes.has(LobeSet::REFRACTION)
    }
}
