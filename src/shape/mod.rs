//! Shapes: where rays meet them, and the surface there with its error bound.
//!
//! One closed list, a file each. A shape lives in the space that its transform leads to the world from. Most
//! shapes stay in their class under most transforms (a moved sphere is a sphere); those are moved once per
//! change of geometry, see [`Shape::transformed`], and the rest have their rays moved instead.

mod cuboid;
mod disk;
mod flat;
mod plane;
mod probe;
mod rectangle;
mod sphere;
mod triangle;

pub use cuboid::Cuboid;
pub use disk::Disk;
pub use plane::Plane;
pub use probe::Probe;
pub use rectangle::Rectangle;
pub use sphere::Sphere;
pub use triangle::Triangle;

use crate::camera::Ray;
use crate::math::{Aabb, DAffine3, DVec3};
use bevy_ecs::component::Component;

/// Every shape there is.
#[derive(Clone, Copy, Component, Debug, PartialEq)]
pub enum Shape {
    Sphere(Sphere),
    Plane(Plane),
    Rectangle(Rectangle),
    Disk(Disk),
    Triangle(Triangle),
    Cuboid(Cuboid),
    /// Nothing to see: a frame of reference for the objects that name it as their parent.
    Group,
}

/// A point on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// The point, put back onto the surface after the rounding of the way there.
    pub point: DVec3,
    /// How far each coordinate may be from the true surface, including the rounding of the shape's own test
    /// of a ray that starts at the point.
    pub error: DVec3,
    /// Unit geometric normal, on the side of the shape's own choice.
    pub normal: DVec3,
}

/// The one dispatch over the list: the same call for every shape that there is something to see of.
macro_rules! each_shape {
    ($shape:expr, $inner:ident => $call:expr, Group => $group:expr) => {
        match $shape {
            Shape::Sphere($inner) => $call,
            Shape::Plane($inner) => $call,
            Shape::Rectangle($inner) => $call,
            Shape::Disk($inner) => $call,
            Shape::Triangle($inner) => $call,
            Shape::Cuboid($inner) => $call,
            Shape::Group => $group,
        }
    };
}

impl Shape {
    /// The smallest t in 0 < t < `t_max` at which the ray meets the surface, from either side.
    #[inline]
    pub fn hit(&self, probe: &Probe, t_max: f64) -> Option<f64> {
        each_shape!(self, shape => shape.hit(probe, t_max), Group => None)
    }

    /// The surface at the t that [`Shape::hit`] gave for the ray.
    pub fn surface(&self, ray: &Ray, t: f64) -> Surface {
        each_shape!(self, shape => shape.surface(ray, t), Group => Surface {
            point: ray.at(t),
            error: DVec3::ZERO,
            normal: DVec3::Y,
        })
    }

    /// A box around the shape; none if it is infinite or there is nothing to see.
    pub fn bounds(&self) -> Option<Aabb> {
        each_shape!(self, shape => shape.bounds(), Group => None)
    }

    /// The shape that an affine map makes of this one; none if that is not in its class.
    pub fn transformed(&self, affine: &DAffine3) -> Option<Self> {
        if *affine == DAffine3::IDENTITY {
            return Some(*self);
        }
        match self {
            Self::Sphere(shape) => shape.transformed(affine).map(Self::Sphere),
            Self::Plane(shape) => shape.transformed(affine).map(Self::Plane),
            Self::Rectangle(shape) => shape.transformed(affine).map(Self::Rectangle),
            Self::Disk(shape) => shape.transformed(affine).map(Self::Disk),
            Self::Triangle(shape) => shape.transformed(affine).map(Self::Triangle),
            Self::Cuboid(shape) => shape.transformed(affine).map(Self::Cuboid),
            Self::Group => Some(Self::Group),
        }
    }
}
