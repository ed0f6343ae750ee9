//! All that can be seen, and where each of it came from.

use super::primitive::{Finish, Primitive, abs, inverse};
use crate::bvh::Hit;
use crate::math::DAffine3;
use crate::shape::{Shape, Surface};
use crate::texture::Spot;

/// All that can be seen, in the order of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Geometry {
    pub primitives: Vec<Primitive>,
    /// Of each primitive: the shape in its own space. Only paint asks for it.
    origins: Vec<Origin>,
}

/// A shape before it was moved.
#[derive(Clone, Debug, PartialEq)]
struct Origin {
    shape: Shape,
    to_object: DAffine3,
}

impl Geometry {
    /// Adds a shape placed by `to_world`, unless that flattens it.
    pub fn push(&mut self, shape: &Shape, to_world: DAffine3, finish: Finish) {
        let (Some(primitive), Some(to_object)) =
            (Primitive::new(shape, to_world, finish), inverse(&to_world))
        else {
            return;
        };
        self.primitives.push(primitive);
        self.origins.push(Origin { shape: shape.clone(), to_object });
    }

    /// What paint may ask of the point where a primitive was hit.
    pub fn spot(&self, hit: &Hit, surface: &Surface) -> Spot {
        let Origin { shape, to_object } = &self.origins[hit.primitive as usize];
        let point = to_object.transform_point3(surface.point);
        let error = abs(to_object).transform_vector3(surface.error);
        Spot { uv: shape.uv(point, hit.at.part), point, error, color: shape.color(point, hit.at.part) }
    }
}
