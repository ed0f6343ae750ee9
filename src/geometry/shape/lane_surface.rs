//! Surfaces in lanes.

use super::Surface;
use crate::base::lanes::{Real, Select, Vec3};
use crate::base::math::DVec3;

/// A point on a surface in each lane; see [`Surface`].
#[derive(Clone, Copy, Debug)]
pub struct LaneSurface<F> {
    pub point: Vec3<F>,
    pub error: Vec3<F>,
    pub normal: Vec3<F>,
    pub shading: Vec3<F>,
    pub lift: Vec3<F>,
}

impl<F: Real> LaneSurface<F> {
    #[inline(always)]
    pub fn new(point: Vec3<F>, error: Vec3<F>, normal: Vec3<F>) -> Self {
        Self { point, error, normal, shading: normal, lift: Vec3::zero() }
    }

    /// A placeholder for lanes without a surface.
    #[inline(always)]
    pub fn nowhere() -> Self {
        Self::new(Vec3::zero(), Vec3::zero(), Vec3::splat(DVec3::Y))
    }

    /// The surfaces of eight lanes. Lanes that do not exist repeat the last one.
    #[inline(always)]
    pub fn store(&self) -> [Surface; 8] {
        let (points, errors, normals) = (self.point.store(), self.error.store(), self.normal.store());
        let (shading, lifts) = (self.shading.store(), self.lift.store());
        std::array::from_fn(|lane| Surface {
            point: points[lane],
            error: errors[lane],
            normal: normals[lane],
            shading: shading[lane],
            lift: lifts[lane],
        })
    }

    /// Flips both normals in the lanes of a mask.
    #[inline(always)]
    pub fn flip(&mut self, mask: F::Mask) {
        self.normal = self.normal.negate_where(mask);
        self.shading = self.shading.negate_where(mask);
    }

    /// Lanes in which light from `direction` reaches the smooth surface that a mesh approximates. The direction may be
    /// below the horizon of the flat triangle.
    #[inline(always)]
    pub fn smoothly_faces(&self, direction: Vec3<F>) -> F::Mask {
        self.lift.is_not_zero() & F::splat(0.0).lt(direction.dot(self.shading))
    }

    /// Converts a density per area at the point to one per steradian, as seen `from` elsewhere. 0 if the surface is
    /// seen edge-on.
    #[inline(always)]
    pub fn pdf_from(&self, from: Vec3<F>, per_area: F) -> F {
        let zero = F::splat(0.0);
        let way = self.point - from;
        let distance_squared = way.length_squared();
        let facing = way.dot(self.normal).abs();
        let pdf = per_area * distance_squared * distance_squared.sqrt() / facing;
        F::select(zero.lt(facing) & zero.lt(pdf) & pdf.lt(F::splat(f64::INFINITY)), pdf, zero)
    }
}

impl<F: Real> Select<F::Mask> for LaneSurface<F> {
    #[inline(always)]
    fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        Self {
            point: Vec3::select(mask, yes.point, no.point),
            error: Vec3::select(mask, yes.error, no.error),
            normal: Vec3::select(mask, yes.normal, no.normal),
            shading: Vec3::select(mask, yes.shading, no.shading),
            lift: Vec3::select(mask, yes.lift, no.lift),
        }
    }
}

impl From<LaneSurface<f64>> for Surface {
    fn from(surface: LaneSurface<f64>) -> Self {
        Self {
            point: surface.point.into(),
            error: surface.error.into(),
            normal: surface.normal.into(),
            shading: surface.shading.into(),
            lift: surface.lift.into(),
        }
    }
}

impl From<&Surface> for LaneSurface<f64> {
    fn from(surface: &Surface) -> Self {
        Self {
            point: surface.point.into(),
            error: surface.error.into(),
            normal: surface.normal.into(),
            shading: surface.shading.into(),
            lift: surface.lift.into(),
        }
    }
}
