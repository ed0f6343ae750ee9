//! Single rays, and rays in lanes.

use crate::base::lanes::{Real, Vec3};
use crate::base::math::DVec3;

/// A ray: `origin` + t·`direction`. Directions of camera rays have unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    pub origin: DVec3,
    pub direction: DVec3,
}

impl Ray {
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// One ray per lane: `origin` + t·`direction`. The direction has any length except zero.
#[derive(Clone, Copy, Debug)]
pub struct LaneRay<F> {
    pub origin: Vec3<F>,
    pub direction: Vec3<F>,
}

impl<F: Real> LaneRay<F> {
    #[inline(always)]
    pub fn splat(ray: &Ray) -> Self {
        Self { origin: Vec3::splat(ray.origin), direction: Vec3::splat(ray.direction) }
    }

    /// The ray of one lane.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> Ray {
        Ray { origin: self.origin.lane(lane), direction: self.direction.lane(lane) }
    }

    #[inline(always)]
    pub fn at(&self, t: F) -> Vec3<F> {
        self.origin + self.direction * t
    }
}

impl From<&Ray> for LaneRay<f64> {
    #[inline(always)]
    fn from(ray: &Ray) -> Self {
        Self { origin: ray.origin.into(), direction: ray.direction.into() }
    }
}
