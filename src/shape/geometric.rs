//! What every shape can be asked.

use super::{Crossing, Parameters, Surface};
use crate::camera::Ray;
use crate::color::Rgb;
use crate::digest::Content;
use crate::math::{Aabb, DAffine3, DVec2, DVec3};
use crate::sampling::Frame;
use crate::tree::Probe;

/// A shape in its own space.
pub trait Geometric: Clone + PartialEq + Content {
    /// The word that files call the shape by.
    const NAME: &'static str;

    /// Makes the shape of what a file says; none if a parameter is missing or wrong, which has been reported.
    fn read(parameters: &mut impl Parameters) -> Option<Self>;

    /// The smallest t in `after` < t < `t_max` at which the ray meets the surface, from either side; `after` is not below 0.
    /// The ray's direction has any length but zero. A ray that passes a surface straight on is asked for its next crossing,
    /// not moved: so each is found once, however near they are to each other. A solid that is entered is left at a larger t.
    fn hit_after(&self, probe: &Probe, after: f64, t_max: f64) -> Option<Crossing>;

    /// [`Geometric::hit_after`] from the ray's origin on.
    #[inline]
    fn hit(&self, probe: &Probe, t_max: f64) -> Option<Crossing> {
        self.hit_after(probe, 0.0, t_max)
    }

    /// Adds all crossings in `after` < t < `t_max`.
    fn crossings(&self, probe: &Probe, mut after: f64, t_max: f64, found: &mut Vec<Crossing>) {
        while let Some(at) = self.hit_after(probe, after, t_max) {
            found.push(at);
            after = at.t;
        }
    }

    /// Whether the ray meets the surface in 0 < t < `t_max`: whether [`Geometric::hit`] finds anything.
    fn blocks(&self, probe: &Probe, t_max: f64) -> bool {
        self.hit(probe, t_max).is_some()
    }

    /// The surface where [`Geometric::hit`] found the ray to cross it.
    fn surface(&self, ray: &Ray, at: Crossing) -> Surface;

    /// [`Geometric::surface`] for a shape whose rays are moved to it: points of shapes with edges stay clear of
    /// these by `apart` more than they would, as that is how far off the moves may bring the next ray's origin.
    fn surface_apart(&self, ray: &Ray, at: Crossing, apart: f64) -> Surface {
        let _ = apart;
        self.surface(ray, at)
    }

    /// A box around the shape; none if it is infinite.
    fn bounds(&self) -> Option<Aabb>;

    /// The shape that an affine map makes of this one; none if that is not in its class. A mirrored shape
    /// keeps its normals outwards.
    fn transformed(&self, affine: &DAffine3) -> Option<Self>;

    /// Texture coordinates of a point of the surface, in the shape's own space and to within rounding.
    fn uv(&self, point: DVec3, part: u32) -> DVec2;

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

    /// A point of the surface with its part, uniform over the area for `u` uniform in the unit square.
    fn sample_area(&self, u: DVec2) -> Option<(Surface, u32)> {
        let _ = u;
        None
    }

    /// A point of the surface that `from` may see, with its part and its density per solid angle there. Shapes that choose
    /// among directions do so in a frame that is carried from that of the surface at `from`.
    fn sample_from(&self, from: DVec3, frame: &Frame, u: DVec2) -> Option<(Surface, u32, f64)> {
        let _ = frame;
        let (surface, part) = self.sample_area(u)?;
        let density = self.density_from(from, &surface)?;
        Some((surface, part, density))
    }

    /// The density per solid angle with which [`Geometric::sample_from`] gives the point `at`.
    fn density_from(&self, from: DVec3, at: &Surface) -> Option<f64> {
        at.density_from(from, 1.0 / self.area()?)
    }
}
