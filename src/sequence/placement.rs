//! Where objects are at a time.

use super::{Object, Sequence};
use crate::base::math::{Aabb, DAffine3};
use crate::base::time::Time;

impl Sequence {
    fn object(&self, index: usize) -> &Object {
        &self.objects[index].value
    }

    /// An object and those above it, by their indices.
    pub fn ancestry(&self, object: usize) -> impl Iterator<Item = usize> {
        std::iter::successors(Some(object), |&at| self.object(at).parent)
    }

    /// The map from an object's coordinates to the world.
    pub fn to_world(&self, object: usize, time: Time) -> DAffine3 {
        let own = self
            .ancestry(object)
            .fold(DAffine3::IDENTITY, |world, at| self.object(at).transform.at(time) * world);
        DAffine3::from_mat3(self.up.matrix()) * own
    }

    /// Whether an object and all those above it are visible.
    pub fn is_visible(&self, object: usize, time: Time) -> bool {
        self.ancestry(object).all(|at| self.object(at).visible.at(time))
    }

    /// The bounds of an object's shape in its own coordinates, without loading files.
    pub fn bounds_at(&self, object: usize, time: Time) -> Option<Aabb> {
        let object = self.object(object);
        match &object.tracks {
            Some(tracks) => tracks.bounds_at(time),
            None => object.shape.bounds(),
        }
    }
}
