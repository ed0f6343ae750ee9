//! Components that only entities need; [`Shape`](crate::geometry::shape::Shape), [`Material`](crate::appearance::material::Material),
//! [`Light`](crate::appearance::light::Light) and [`CameraPath`](crate::camera::path::CameraPath) are components themselves.

use crate::base::color::Rgb;
use crate::base::math::DAffine3;
use crate::film::LayerId;
use crate::track::Animated;
use bevy_ecs::component::Component;

/// Where an object is: world from object. Singular while a scale of 0 hides it.
#[derive(Clone, Copy, Component, Debug, PartialEq)]
pub struct Transform(pub DAffine3);

/// Whether an object, and every parent of it, is shown.
#[derive(Clone, Copy, Component, Debug, PartialEq, Eq)]
pub struct Visible(pub bool);

/// An object's own visibility over time.
#[derive(Clone, Component, Debug)]
pub struct VisibleTrack(pub Animated<bool>);

/// Position among the file's entries of the same kind. Queries come in no order; extraction sorts by this.
#[derive(Clone, Copy, Component, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FileOrder(pub u32);

/// Marks lights that can be seen themselves: they are part of the geometry.
#[derive(Clone, Copy, Component, Debug)]
pub struct AreaLight;

/// What an entity's layer of the film is weighted with. Lights are switched by this value: no component
/// comes or goes.
#[derive(Clone, Copy, Component, Debug, PartialEq)]
pub struct Weight {
    pub layer: LayerId,
    pub value: Rgb,
}
