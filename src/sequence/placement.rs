//! Where objects are at a time.

use super::{Named, Object, Sequence};
use crate::base::math::{Aabb, DAffine3};
use crate::base::time::Time;
use crate::geometry::shape::Shape;

/// The indices of an object and of those above it. Of parents in a cycle, which are reported elsewhere, the first ones.
pub fn chain(objects: &[Named<Object>], object: usize) -> impl Iterator<Item = usize> {
    std::iter::successors(Some(object), |&at| objects.get(at)?.value.parent).take(objects.len())
}

/// For each object, those whose parent it is.
pub fn children(objects: &[Named<Object>]) -> Vec<Vec<usize>> {
    let mut children = vec![Vec::new(); objects.len()];
    for (index, object) in objects.iter().enumerate() {
        if let Some(parent) = object.value.parent {
            children[parent].push(index);
        }
    }
    children
}

/// The object that shows the mesh of a node: the skinned mesh of the node, or the node itself.
pub fn shown_by(objects: &[Named<Object>], node: usize) -> usize {
    // Nodes that show their mesh themselves have a shape.
    let skin = || objects.iter().position(|object| object.value.skin_of == Some(node));
    let is_group = objects.get(node).is_some_and(|object| object.value.shape == Shape::Group);
    if is_group { skin().unwrap_or(node) } else { node }
}

/// Whether a test holds for an object and all those with which alone it is visible: those above it, and of skinned
/// meshes among them the nodes, with those above these.
pub fn all_above(objects: &[Named<Object>], object: usize, test: &dyn Fn(usize) -> bool) -> bool {
    let node = |at: usize| objects.get(at).and_then(|object| object.value.skin_of);
    chain(objects, object).all(|at| test(at) && node(at).is_none_or(|node| all_above(objects, node, test)))
}

#[warn(missing_docs)]
impl Sequence {
    fn object(&self, index: usize) -> &Object {
        &self.objects[index].value
    }

    /// An object and those above it, by their indices.
    pub fn ancestry(&self, object: usize) -> impl Iterator<Item = usize> {
        chain(&self.objects, object)
    }

    /// The map from an object's coordinates to the world.
    pub fn to_world(&self, object: usize, time: Time) -> DAffine3 {
        let own = self
            .ancestry(object)
            .fold(DAffine3::IDENTITY, |world, at| self.object(at).transform.at(time) * world);
        DAffine3::from_mat3(self.up.matrix()) * own
    }

    /// Whether an object, all those above it, and the nodes of skinned meshes among them are visible.
    pub fn is_visible(&self, object: usize, time: Time) -> bool {
        all_above(&self.objects, object, &|at| self.object(at).visible.at(time))
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
