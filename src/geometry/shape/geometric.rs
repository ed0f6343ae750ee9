//! The interface of shapes.

use super::{LaneHit, LaneSurface, Parameters, PreparedRay, RayInterval, ShapeHit, Surface};
use crate::base::color::Rgb;
use crate::base::digest::Content;
use crate::base::lanes::{Real, Row, Vec3};
use crate::base::math::{Aabb, DAffine3, DVec2, DVec3, LaneRay, Ray, max};
use crate::geometry::bvh::TraversalRay;
use crate::sampling::FrameAxes;

/// A shape in its own space. Its formulas are generic over the number of lanes: rays, points or random numbers in
/// lanes, and one shape.
pub trait Geometric: Clone + PartialEq + Content {
    /// The name of the shape in files.
    const NAME: &'static str;

    /// Reads the shape from its parameters. None if a parameter is missing or wrong, which has been reported.
    fn read(parameters: &mut impl Parameters) -> Option<Self>;

    /// The smallest t within bounds at which each ray hits the surface, from either side.
    fn intersect<F: Real>(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> LaneHit<F>;

    /// The rays that hit the surface within bounds: those for which [`Geometric::intersect`] finds a hit.
    #[inline(always)]
    fn occludes<F: Real>(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> F::Mask {
        self.intersect(ray, within).is_hit()
    }

    /// [`Geometric::intersect`] of one ray.
    #[inline(always)]
    fn intersect_one(&self, ray: &TraversalRay, within: RayInterval<f64>) -> Option<ShapeHit> {
        self.intersect(&PreparedRay::<f64>::splat(ray), within).one()
    }

    /// [`Geometric::occludes`] of one ray.
    #[inline(always)]
    fn occludes_one(&self, ray: &TraversalRay, within: RayInterval<f64>) -> bool {
        self.occludes(&PreparedRay::<f64>::splat(ray), within)
    }

    /// The surface at the hits of [`Geometric::intersect`]. If rays are moved into the shape's space, the move may
    /// shift the next ray's origin by up to `origin_error`. Points of shapes with edges keep that much more clear of
    /// the edges. Otherwise `origin_error` is 0.
    fn surface<F: Real>(&self, ray: &LaneRay<F>, at: LaneHit<F>, origin_error: f64) -> LaneSurface<F>;

    /// The bounds of the shape; none if it is infinite.
    fn bounds(&self) -> Option<Aabb>;

    /// The largest dot product of a point of the shape with a direction; none if the shape is infinite. Shapes that do
    /// not fill the corners of their bounds implement it.
    fn support(&self, direction: DVec3) -> Option<f64> {
        Some(largest_product(self.bounds()?.corners(), direction))
    }

    /// The shape transformed by an affine map. None if the result is not a shape of this class. A mirrored shape keeps
    /// its normals outwards.
    fn transformed(&self, affine: &DAffine3) -> Option<Self>;

    /// Texture coordinates u and v of points of the surface. The points are in the shape's own space, to within
    /// rounding.
    fn uv<F: Real>(&self, point: Vec3<F>, part: F::U32) -> [F; 2];

    /// Whether a part of the surface ends at u = 0 and 1, and at v = 0 and 1. If not, it closes there or is infinite.
    fn uv_ends(&self, part: u32) -> [bool; 2] {
        let _ = part;
        [true; 2]
    }

    /// The vertex colour at a point of the surface; white if there is none. Arguments as in [`Geometric::uv`].
    fn color(&self, point: DVec3, part: u32) -> Rgb {
        let _ = (point, part);
        Rgb::ONE
    }

    /// The area of the surface. None if it is infinite or has no closed form. Shapes with an area implement
    /// [`Geometric::sample_area`], so they can be sampled as lights.
    fn area(&self) -> Option<f64> {
        None
    }

    /// Samples points and their parts, uniformly over the area, from u and v uniform in the unit square.
    #[inline(always)]
    fn sample_area<F: Real>(&self, u: F, v: F) -> (LaneSurface<F>, F::U32) {
        let _ = (u, v);
        (LaneSurface::new(Vec3::zero(), Vec3::zero(), Vec3::splat(DVec3::Y)), F::U32::splat(0))
    }

    /// Samples points that `from` may see. Returns the points, their parts and their densities per steradian at
    /// `from`; 0 if no point is visible. Directions are sampled in a frame turned from the axes `eye`, which vary
    /// smoothly from point to point.
    #[inline(always)]
    fn sample_from<F: Real>(
        &self,
        from: Vec3<F>,
        eye: &FrameAxes<F>,
        u: F,
        v: F,
    ) -> (LaneSurface<F>, F::U32, F) {
        let _ = eye;
        let (surface, part) = self.sample_area(u, v);
        let pdf = self.pdf_from(from, &surface);
        (surface, part, pdf)
    }

    /// The density per steradian with which [`Geometric::sample_from`] samples the points `at`; 0 for points that it
    /// never samples.
    #[inline(always)]
    fn pdf_from<F: Real>(&self, from: Vec3<F>, at: &LaneSurface<F>) -> F {
        match self.area() {
            Some(area) => at.pdf_from(from, F::splat(1.0 / area)),
            None => F::splat(0.0),
        }
    }
}

/// The largest dot product of one of the points with a direction.
pub(super) fn largest_product(points: impl IntoIterator<Item = DVec3>, direction: DVec3) -> f64 {
    points.into_iter().map(|point| point.dot(direction)).fold(f64::NEG_INFINITY, max)
}

/// Queries of shapes with a single ray or point.
pub trait OneRay {
    /// The first hit of a ray before `t_max`.
    fn intersect_up_to(&self, ray: &TraversalRay, t_max: f64) -> Option<ShapeHit>;
    /// Whether a ray hits the surface before `t_max`.
    fn occludes_up_to(&self, ray: &TraversalRay, t_max: f64) -> bool;
    /// The surface at a hit of a ray.
    fn surface_at(&self, ray: &Ray, at: ShapeHit) -> Surface;
    /// [`Geometric::uv`].
    fn uv_at(&self, point: DVec3, part: u32) -> DVec2;
}

impl<T: Geometric> OneRay for T {
    fn intersect_up_to(&self, ray: &TraversalRay, t_max: f64) -> Option<ShapeHit> {
        self.intersect_one(ray, RayInterval::up_to(t_max))
    }

    fn occludes_up_to(&self, ray: &TraversalRay, t_max: f64) -> bool {
        self.occludes_one(ray, RayInterval::up_to(t_max))
    }

    fn surface_at(&self, ray: &Ray, at: ShapeHit) -> Surface {
        self.surface(&LaneRay::from(ray), at.into(), 0.0).into()
    }

    fn uv_at(&self, point: DVec3, part: u32) -> DVec2 {
        DVec2::from_array(self.uv::<f64>(point.into(), part))
    }
}
