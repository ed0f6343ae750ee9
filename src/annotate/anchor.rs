//! The points of the world and of the picture to which annotations are tied.

use super::view::FrameView;
use crate::base::math::{Aabb, DVec2, DVec3};
use crate::base::time::Time;
use crate::track::Animated;

/// A point over time.
#[derive(Clone, Debug, PartialEq)]
pub enum Anchor {
    World(Animated<DVec3>),
    /// A point of an object, by the object's index.
    Object(usize, ObjectPoint),
    /// A point of the picture: shares of its width from the left and of its height from the bottom.
    Screen(Animated<DVec3>),
}

/// A point of an object, which moves with it.
#[derive(Clone, Debug, PartialEq)]
pub enum ObjectPoint {
    /// A point in its own coordinates.
    Point(DVec3),
    /// A point of the box around its shape: -1 to 1 along each axis, from side to side. Groups and shapes without end
    /// have their origin.
    Box(DVec3),
}

impl ObjectPoint {
    /// The point in the object's coordinates.
    fn local(&self, bounds: Option<Aabb>) -> DVec3 {
        match self {
            Self::Point(point) => *point,
            Self::Box(side) => {
                bounds.map_or(DVec3::ZERO, |bounds| bounds.center() + *side * (bounds.max - bounds.min) * 0.5)
            }
        }
    }
}

impl Anchor {
    /// Its point in the world. None for points of the picture, and while its object is hidden.
    pub fn world(&self, view: &FrameView<'_>, time: Time) -> Option<DVec3> {
        match self {
            Self::World(point) => Some(point.at(time)),
            Self::Object(index, place) => {
                let object = (view.object)(*index, time);
                object.visible.then(|| object.to_world.transform_point3(place.local(object.bounds)))
            }
            Self::Screen(_) => None,
        }
    }

    /// Its place in pixels. None behind the camera, and while its object is hidden.
    pub fn pixel(&self, view: &FrameView<'_>) -> Option<DVec2> {
        match self {
            Self::Screen(place) => {
                let DVec3 { x, y, .. } = place.at(view.time);
                Some(DVec2::new(x * view.width(), (1.0 - y) * view.height()))
            }
            _ => view.project(self.world(view, view.time)?),
        }
    }

    /// The index of its object.
    pub fn object(&self) -> Option<usize> {
        if let Self::Object(index, _) = self { Some(*index) } else { None }
    }
}
