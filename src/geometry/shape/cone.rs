//! Cones and frustums.

use super::{Geometric, LaneHit, LaneSurface, Parameters, PreparedRay, Span, frustum::Frustum};
use crate::base::digest::content;
use crate::base::lanes::{Real, Vec3};
use crate::base::math::{Aabb, DAffine3, DVec3, LaneRay};

/// What a [`Geometric`] that wraps a [`Frustum`] leaves to it: all but how it is read.
macro_rules! as_its_frustum {
    () => {
        #[inline(always)]
        fn intersect<F: Real>(&self, ray: &PreparedRay<F>, within: Span<F>) -> LaneHit<F> {
            self.0.intersect(&ray.ray, within)
        }

        #[inline(always)]
        fn surface<F: Real>(&self, ray: &LaneRay<F>, at: LaneHit<F>, apart: f64) -> LaneSurface<F> {
            self.0.surface(ray, at, apart)
        }

        fn bounds(&self) -> Option<Aabb> {
            Some(self.0.bounds())
        }

        fn transformed(&self, affine: &DAffine3) -> Option<Self> {
            self.0.transformed(affine).map(Self)
        }

        /// On the side, u is the share of a turn, eastwards from the frame's -x and 0.5 at its +x, and v the
        /// share of the height above the first end. On a flat end, the square around it, whose middle is
        /// (0.5, 0.5) and which for an upright shape lies as on a disk that faces up or down.
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

pub(super) use as_its_frustum;

/// The cone over a circle, up to its tip or to another circle; closed where it is flat, or open.
#[derive(Clone, Debug, PartialEq)]
pub struct Cone(Frustum);

content!(struct Cone(frustum));

impl Cone {
    /// `radius` around `base` is above 0, `top_radius` around `apex` not below; none if `base` is `apex`.
    pub fn new(base: DVec3, apex: DVec3, radius: f64, top_radius: f64, capped: bool) -> Option<Self> {
        Frustum::new((base, radius), (apex, top_radius), capped).map(Self)
    }

    /// The middles of both ends with their radii, and whether they are closed.
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

    as_its_frustum!();
}
