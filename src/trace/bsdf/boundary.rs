//! Boundaries between two media.

use super::Bsdf;
use crate::appearance::optics::{Fresnel, Refraction, refract};
use crate::base::lanes::{Color, Real, Select, Vec3};
use crate::trace::materials::LobeSet;

/// The relative index of refraction at a surface.
#[derive(Clone, Copy)]
pub struct Boundary<F> {
    /// The index behind the surface over that in front of it.
    pub eta: F,
}

/// Light that arrives at a boundary.
#[derive(Clone, Copy)]
pub struct RefractedRay<F: Real> {
    /// The refracted direction.
    pub direction: Vec3<F>,
    /// The reflected share; 1 at total internal reflection.
    pub reflected: F,
    pub is_total: F::Mask,
}

impl<F: Real> Boundary<F> {
    /// Refracts light with a direction at the boundary. The normal faces the light. Both are unit vectors.
    #[inline(always)]
    pub fn refract(&self, fresnel: Fresnel, direction: Vec3<F>, normal: Vec3<F>) -> RefractedRay<F> {
        let Refraction { direction: refracted, cosine, is_total } = refract(direction, normal, self.eta);
        let reflected = fresnel.reflectance(-direction.dot(normal), cosine, self.eta);
        RefractedRay {
            direction: refracted,
            reflected: F::select(is_total, F::splat(1.0), reflected),
            is_total,
        }
    }

    /// The reflected share of light that continues straight on, as shadow rays do. A body that is very thin or very
    /// large hardly shifts light: outside the ray is straight, and inside it is refracted. So the angle is taken on the
    /// side of the lower index, from which there is no total reflection.
    #[inline(always)]
    pub fn straight_reflectance(&self, fresnel: Fresnel, direction: Vec3<F>, normal: Vec3<F>) -> F {
        let eta = self.eta.max(F::splat(1.0) / self.eta);
        let Refraction { cosine, is_total, .. } = refract(direction, normal, eta);
        let reflected = fresnel.reflectance(-direction.dot(normal), cosine, eta);
        F::select(is_total, F::splat(0.0), reflected)
    }
}

/// A sampled direction at a boundary.
#[derive(Clone, Copy)]
pub struct BoundarySample<F: Real> {
    pub direction: Vec3<F>,
    /// The factor of the path's throughput.
    pub share: Color<F::F32>,
    /// Lanes in which the path is refracted. In the others it is reflected.
    pub passes: F::Mask,
}

impl<F: Real> Bsdf<'_, F> {
    /// Refracts or reflects the path at random, in proportion to the reflected share. `choice` is a number in 0..1.
    #[inline(always)]
    pub fn boundary_sample(&self, boundary: &Boundary<F>, choice: F) -> BoundarySample<F> {
        let refracted = boundary.refract(self.lobes.fresnel(), -self.to_eye, self.normal);
        let passes = !refracted.is_total & refracted.reflected.le(choice);
        // A boundary reflects all colours equally, whatever colour it transmits. Only total internal reflection has
        // that colour.
        let alike = Color::grey(self.refraction.max_element());
        let mirrored = Color::select(refracted.is_total, self.refraction, alike);
        BoundarySample {
            direction: Vec3::select(passes, refracted.direction, self.mirrored()),
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
