//! What every shape can be asked.

use super::{Crossing, LaneHit, LaneSurface, Parameters, PreparedRay, Span, Surface};
use crate::base::color::Rgb;
use crate::base::digest::Content;
use crate::base::lanes::{Real, Row, Vec3};
use crate::base::math::{Aabb, DAffine3, DVec2, DVec3, LaneRay, Ray};
use crate::geometry::bvh::Probe;
use crate::sampling::Frame;

/// A shape in its own space. Its formulas are generic over the number of lanes: a row of rays, points or random numbers
/// and one shape.
pub trait Geometric: Clone + PartialEq + Content {
    /// The word that files call the shape by.
    const NAME: &'static str;

    /// Makes the shape of what a file says; none if a parameter is missing or wrong, which has been reported.
    fn read(parameters: &mut impl Parameters) -> Option<Self>;

    /// The smallest t within bounds at which each ray meets the surface, from either side.
    fn intersect<F: Real>(&self, ray: &PreparedRay<F>, within: Span<F>) -> LaneHit<F>;

    /// Rays that meet the surface within bounds: those for which [`Geometric::intersect`] finds anything.
    #[inline(always)]
    fn occludes<F: Real>(&self, ray: &PreparedRay<F>, within: Span<F>) -> F::Mask {
        self.intersect(ray, within).is_hit()
    }

    /// [`Geometric::intersect`] of one ray.
    #[inline(always)]
    fn intersect_one(&self, probe: &Probe, within: Span<f64>) -> Option<Crossing> {
        self.intersect(&PreparedRay::<f64>::splat(probe), within).one()
    }

    /// [`Geometric::occludes`] of one ray.
    #[inline(always)]
    fn occludes_one(&self, probe: &Probe, within: Span<f64>) -> bool {
        self.occludes(&PreparedRay::<f64>::splat(probe), within)
    }

    /// The surface where [`Geometric::intersect`] found rays to cross it. If rays are moved to the shape, points of shapes
    /// with edges stay clear of these by `apart` more than they would, as that is how far off the moves may bring the
    /// next ray's origin; otherwise `apart` is 0.
    fn surface<F: Real>(&self, ray: &LaneRay<F>, at: LaneHit<F>, apart: f64) -> LaneSurface<F>;

    /// A box around the shape; none if it is infinite.
    fn bounds(&self) -> Option<Aabb>;

    /// The shape that an affine map makes of this one; none if that is not in its class. A mirrored shape
    /// keeps its normals outwards.
    fn transformed(&self, affine: &DAffine3) -> Option<Self>;

    /// Texture coordinates u and v of points of the surface, in the shape's own space and to within rounding.
    fn uv<F: Real>(&self, point: Vec3<F>, part: F::U32) -> [F; 2];

    /// Whether a part of the surface ends where u is 0 and 1, and where v is: else it closes there, or goes on for ever.
    fn uv_ends(&self, part: u32) -> [bool; 2] {
        let _ = part;
        [true; 2]
    }

    /// Colour of the vertices at a point of the surface; white where they have none. The arguments are those
    /// of [`Geometric::uv`].
    fn color(&self, point: DVec3, part: u32) -> Rgb {
        let _ = (point, part);
        Rgb::ONE
    }

    /// The area of the surface; none if it is infinite or not known in closed form. Shapes that know theirs
    /// also answer [`Geometric::sample_area`], and so can be found as lights.
    fn area(&self) -> Option<f64> {
        None
    }

    /// Points of the surface with their parts, uniform over the area for u and v uniform in the unit square.
    #[inline(always)]
    fn sample_area<F: Real>(&self, u: F, v: F) -> (LaneSurface<F>, F::U32) {
        let _ = (u, v);
        (LaneSurface::new(Vec3::zero(), Vec3::zero(), Vec3::splat(DVec3::Y)), F::U32::splat(0))
    }

    /// Points of the surface that `from` may see, with their parts and their densities per steradian there; 0 where
    /// nothing is seen. What is drawn around a direction is turned as `eye` is, a frame that turns smoothly from one point
    /// to the next.
    #[inline(always)]
    fn sample_from<F: Real>(&self, from: Vec3<F>, eye: &Frame<F>, u: F, v: F) -> (LaneSurface<F>, F::U32, F) {
        let _ = eye;
        let (surface, part) = self.sample_area(u, v);
        let pdf = self.pdf_from(from, &surface);
        (surface, part, pdf)
    }

    /// The density per steradian with which [`Geometric::sample_from`] gives the points `at`; 0 for those that it never
    /// gives.
    #[inline(always)]
    fn pdf_from<F: Real>(&self, from: Vec3<F>, at: &LaneSurface<F>) -> F {
        match self.area() {
            Some(area) => at.pdf_from(from, F::splat(1.0 / area)),
            None => F::splat(0.0),
        }
    }
}

/// Shapes asked by one ray or point: the case of one lane.
pub trait OneRay {
    /// Where a ray first meets the surface before `t_max`.
    fn hit(&self, probe: &Probe, t_max: f64) -> Option<Crossing>;
    /// Whether a ray meets the surface before `t_max`.
    fn blocks(&self, probe: &Probe, t_max: f64) -> bool;
    /// The surface where a ray meets it.
    fn surface_at(&self, ray: &Ray, at: Crossing) -> Surface;
    /// [`Geometric::uv`].
    fn uv_at(&self, point: DVec3, part: u32) -> DVec2;
}

impl<T: Geometric> OneRay for T {
    fn hit(&self, probe: &Probe, t_max: f64) -> Option<Crossing> {
        self.intersect_one(probe, Span::up_to(t_max))
    }

    fn blocks(&self, probe: &Probe, t_max: f64) -> bool {
        self.occludes_one(probe, Span::up_to(t_max))
    }

    fn surface_at(&self, ray: &Ray, at: Crossing) -> Surface {
        self.surface(&LaneRay::from(ray), at.into(), 0.0).into()
    }

    fn uv_at(&self, point: DVec3, part: u32) -> DVec2 {
        DVec2::from_array(self.uv::<f64>(point.into(), part))
    }
}
