//! Shapes: where rays meet them, and the surface there with its error bound.
//!
//! One closed list, a file each: see [`Geometric`] for what a shape is asked. A shape lives in the space that
//! its transform leads to the world from. Most shapes stay in their class under most transforms (a moved
//! sphere is a sphere); those are moved once per change of geometry, see [`Geometric::transformed`], and the
//! rest have their rays moved instead.

mod bundle;
mod chord;
mod cone;
mod cuboid;
mod cylinder;
mod disk;
mod flat;
mod frame;
mod frustum;
mod geometric;
mod mesh;
mod parameters;
mod plane;
mod rectangle;
#[cfg(test)]
mod round_tests;
mod sphere;
mod surface;
mod taper;
mod torus;
mod triangle;

pub use bundle::{Crossings, Rays, Surfaces, lanes, on_spheres};
pub use cone::Cone;
pub use cuboid::Cuboid;
pub use cylinder::Cylinder;
pub use disk::Disk;
pub use flat::spans_a_plane;
pub use geometric::Geometric;
pub use mesh::Mesh;
pub use parameters::Parameters;
pub use plane::Plane;
pub use rectangle::Rectangle;
pub use sphere::Sphere;
pub use surface::{Crossing, Surface};
pub use torus::Torus;
pub use triangle::Triangle;

use crate::camera::Ray;
use crate::color::Rgb;
use crate::digest::content;
use crate::math::{Aabb, DAffine3, DVec2, DVec3};
use crate::sampling::Frame;
use crate::tree::Probe;
use bevy_ecs::component::Component;

/// Declares [`Shape`] with its one dispatch: the same call for every shape that there is something to see of.
macro_rules! shapes {
    ($($shape:ident),* $(,)?) => {
        /// Every shape there is.
        #[derive(Clone, Component, Debug, PartialEq)]
        pub enum Shape {
            $($shape($shape),)*
            /// Nothing to see: a frame of reference for the objects that name it as their parent.
            Group,
        }

        macro_rules! each_shape {
            ($on:expr, $inner:ident => $call:expr, Group => $group:expr) => {
                match $on {
                    $(Shape::$shape($inner) => $call,)*
                    Shape::Group => $group,
                }
            };
        }

        content!(enum Shape { $($shape(shape),)* Group });

        impl Shape {
            /// The words that files call shapes by.
            pub const NAMES: &[&str] = &[$($shape::NAME,)* "Group"];

            /// Makes the shape called `name` of its parameters; none if there is no such shape, or if the
            /// parameters, which have then been refused, make none.
            pub fn read(name: &str, parameters: &mut impl Parameters) -> Option<Self> {
                $(if name == $shape::NAME {
                    return $shape::read(parameters).map(Self::$shape);
                })*
                (name == "Group").then_some(Self::Group)
            }

            /// The shape that an affine map makes of this one; none if that is not in its class.
            pub fn transformed(&self, affine: &DAffine3) -> Option<Self> {
                if *affine == DAffine3::IDENTITY {
                    return Some(self.clone());
                }
                match self {
                    $(Self::$shape(shape) => shape.transformed(affine).map(Self::$shape),)*
                    Self::Group => Some(Self::Group),
                }
            }
        }
    };
}

// The list. A shape that is added here can be written in files, seen, placed and lit.
shapes!(Sphere, Plane, Rectangle, Disk, Triangle, Cuboid, Cylinder, Cone, Torus, Mesh);

impl Shape {
    /// See [`Geometric::hit`].
    #[inline]
    pub fn hit(&self, probe: &Probe, t_max: f64) -> Option<Crossing> {
        self.hit_after(probe, 0.0, t_max)
    }

    /// See [`Geometric::hit_after`].
    #[inline]
    pub fn hit_after(&self, probe: &Probe, after: f64, t_max: f64) -> Option<Crossing> {
        each_shape!(self, shape => shape.hit_after(probe, after, t_max), Group => None)
    }

    /// See [`Geometric::crossings`].
    pub fn crossings(&self, probe: &Probe, after: f64, t_max: f64, found: &mut Vec<Crossing>) {
        each_shape!(self, shape => shape.crossings(probe, after, t_max, found), Group => ());
    }

    /// See [`Geometric::blocks`].
    #[inline]
    pub fn blocks(&self, probe: &Probe, t_max: f64) -> bool {
        each_shape!(self, shape => shape.blocks(probe, t_max), Group => false)
    }

    /// See [`Geometric::surface`].
    pub fn surface(&self, ray: &Ray, at: Crossing) -> Surface {
        each_shape!(self, shape => shape.surface(ray, at), Group => {
            Surface::new(ray.at(at.t), DVec3::ZERO, DVec3::Y)
        })
    }

    /// See [`Geometric::surface_apart`].
    pub fn surface_apart(&self, ray: &Ray, at: Crossing, apart: f64) -> Surface {
        each_shape!(self, shape => shape.surface_apart(ray, at, apart), Group => self.surface(ray, at))
    }

    /// See [`Geometric::bounds`]; none also if there is nothing to see.
    pub fn bounds(&self) -> Option<Aabb> {
        each_shape!(self, shape => shape.bounds(), Group => None)
    }

    /// See [`Geometric::uv`].
    pub fn uv(&self, point: DVec3, part: u32) -> DVec2 {
        each_shape!(self, shape => shape.uv(point, part), Group => DVec2::ZERO)
    }

    /// See [`Geometric::uv_ends`].
    pub fn uv_ends(&self, part: u32) -> [bool; 2] {
        each_shape!(self, shape => shape.uv_ends(part), Group => [true; 2])
    }

    /// Colour of the vertices at a point of the surface, white where there is none; the arguments are those of
    /// [`Geometric::uv`].
    pub fn color(&self, point: DVec3, part: u32) -> Rgb {
        each_shape!(self, shape => shape.color(point, part), Group => Rgb::ONE)
    }

    /// See [`Geometric::area`].
    pub fn area(&self) -> Option<f64> {
        each_shape!(self, shape => shape.area(), Group => None)
    }

    /// See [`Geometric::sample_area`].
    pub fn sample_area(&self, u: DVec2) -> Option<(Surface, u32)> {
        each_shape!(self, shape => shape.sample_area(u), Group => None)
    }

    /// See [`Geometric::sample_from`].
    pub fn sample_from(&self, from: DVec3, frame: &Frame, u: DVec2) -> Option<(Surface, u32, f64)> {
        each_shape!(self, shape => shape.sample_from(from, frame, u), Group => None)
    }

    /// See [`Geometric::density_from`].
    pub fn density_from(&self, from: DVec3, at: &Surface) -> Option<f64> {
        each_shape!(self, shape => shape.density_from(from, at), Group => None)
    }
}
