//! Cones and frustums.

use super::{Geometric, LaneHit, LaneSurface, Parameters, PreparedRay, RayInterval, frustum::Frustum};
use crate::base::digest::Content;
use crate::base::lanes::{Real, Vec3};
use crate::base::math::{Aabb, DAffine3, DVec3, LaneRay};

/// Implements [`Geometric`], except `NAME` and `read`, for a wrapper of [`Frustum`].
macro_rules! forward_to_frustum {
    () => {
        #[inline(always)]
        fn intersect<F: Real>(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> LaneHit<F> {
            self.0.intersect(&ray.ray, within)
        }

        #[inline(always)]
        fn surface<F: Real>(&self, ray: &LaneRay<F>, at: LaneHit<F>, origin_error: f64) -> LaneSurface<F> {
            self.0.surface(ray, at, origin_error)
        }

        fn bounds(&self) -> Option<Aabb> {
            Some(self.0.bounds())
        }

        fn support(&self, direction: DVec3) -> Option<f64> {
            Some(self.0.support(direction))
        }

        fn transformed(&self, affine: &DAffine3) -> Option<Self> {
            self.0.transformed(affine).map(Self)
        }

        /// On the side, u is the fraction of a turn, eastwards from the frame's -x, with 0.5 at its +x. v is the
        /// fraction of the height above the first end. A flat end is mapped by its bounding square, with (0.5, 0.5) at
        /// the centre. On an upright shape it is oriented like a disk that faces up or down.
        #[inline(always)]
        fn uv<F: Real>(&self, point: Vec3<F>, part: F::U32) -> [F; 2] {
            self.0.uv(point, part)
        }

        fn uv_ends(&self, part: u32) -> [bool; 2] {
            self.0.uv_ends(part)
        }

        fn area(&self) -> Option<f64> {
            Some(self.0.area())
        }

        #[inline(always)]
        fn sample_area<F: Real>(&self, u: F, v: F) -> (LaneSurface<F>, F::U32) {
            self.0.sample_area(u, v)
        }
    };
}

pub(super) use forward_to_frustum;

/// A cone up to its tip, or a frustum up to a second circle. Its flat ends are closed or open.
#[derive(Clone, Debug, PartialEq, Content)]
pub struct Cone(Frustum);

impl Cone {
    /// `radius` around `base` must be above 0, and `top_radius` around `apex` at least 0. None if `base` equals
    /// `apex`.
    pub fn new(base: DVec3, apex: DVec3, radius: f64, top_radius: f64, capped: bool) -> Option<Self> {
        Frustum::new((base, radius), (apex, top_radius), capped).map(Self)
    }

    /// The solid, which cones and cylinders share.
    pub fn frustum(&self) -> &Frustum {
        &self.0
    }

    /// The centres and radii of both ends, and whether they are closed.
    pub fn ends(&self) -> ([(DVec3, f64); 2], bool) {
        self.0.ends()
    }
}

impl Geometric for Cone {
    const NAME: &'static str = "Cone";

    fn read(parameters: &mut impl Parameters) -> Option<Self> {
        let base = parameters.vector("base", Some(DVec3::ZERO));
        let apex = parameters.vector("apex", Some(DVec3::Y));
        let radius = parameters.positive("radius", Some(1.0));
        let top_radius = parameters.not_negative("top_radius", Some(0.0));
        let capped = parameters.switch("capped", Some(true));
        let cone = Self::new(base?, apex?, radius?, top_radius?, capped?);
        if cone.is_none() {
            let label = "`base` and `apex` are the same point".to_owned();
            parameters.refuse("apex", "this cone has no height".to_owned(), label);
        }
        cone
    }

    forward_to_frustum!();
}
