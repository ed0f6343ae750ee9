//! Components that only entities need; [`Shape`](crate::geometry::shape::Shape), [`Material`](crate::appearance::material::Material),
//! [`Light`](crate::appearance::light::Light) and [`CameraPath`](crate::camera::path::CameraPath) are components themselves.

use crate::base::color::Rgb;
use crate::base::math::DAffine3;
use crate::base::time::Time;
use crate::film::LayerId;
use crate::geometry::clip::ClipPlane;
use crate::geometry::deformation::DeformedMesh;
use crate::geometry::ray_kinds::{RayKinds, RayVisibility};
use crate::geometry::shape::{ParticleTracks, Plane};
use crate::import::series::MeshSeries;
use crate::track::Animated;
use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use std::sync::Arc;

/// World-from-object transform. Singular while a scale of 0 hides the object.
#[derive(Clone, Copy, Component, Debug, PartialEq)]
pub struct Transform(pub DAffine3);

/// The rays that see an object and all its parents; none while it is hidden.
#[derive(Clone, Copy, Component, Debug, PartialEq, Eq)]
pub struct Visible(pub RayKinds);

impl Visible {
    pub fn is_hidden(self) -> bool {
        self.0.is_empty()
    }
}

/// [`VisibleTracks`] of an object that may move. What has no keys is computed once.
#[derive(Clone, Component, Debug)]
pub enum PreparedVisibility {
    Constant(RayKinds),
    Keyed(Box<VisibleTracks>),
}

impl PreparedVisibility {
    pub fn at(&self, time: Time) -> RayKinds {
        match self {
            Self::Constant(rays) => *rays,
            Self::Keyed(tracks) => tracks.at(time),
        }
    }
}

impl From<VisibleTracks> for PreparedVisibility {
    fn from(tracks: VisibleTracks) -> Self {
        if tracks.is_keyed() {
            Self::Keyed(Box::new(tracks))
        } else {
            Self::Constant(tracks.at(Time::from_integer(0)))
        }
    }
}

/// An object's own visibility over time.
#[derive(Clone, Debug)]
pub struct VisibleTracks {
    pub visible: Animated<bool>,
    pub rays: RayVisibility,
}

impl VisibleTracks {
    pub fn is_keyed(&self) -> bool {
        self.visible.is_keyed() || self.rays.is_keyed()
    }

    pub fn at(&self, time: Time) -> RayKinds {
        if self.visible.at(time) { self.rays.at(time) } else { RayKinds::NONE }
    }
}

/// The object with which alone another one is visible: the node of a skinned mesh.
#[derive(Clone, Copy, Component, Debug)]
pub struct ShownWith(pub Entity);

/// The meshes of an object that shows one after the other.
#[derive(Clone, Component, Debug)]
pub struct ShapeSeries(pub Arc<MeshSeries>);

/// The mesh of an object that morph targets and joints deform.
#[derive(Clone, Component, Debug)]
pub struct ShapeDeformed {
    pub mesh: Arc<DeformedMesh>,
    /// The name of the object, for messages.
    pub object: Arc<str>,
}

/// The particles of an object over time.
#[derive(Clone, Component, Debug)]
pub struct ShapeParticles(pub Arc<ParticleTracks>);

/// The planes that cut an object open, in the spaces of the object and of those above it.
#[derive(Clone, Component, Debug)]
pub struct ClippedBy(pub Vec<(Entity, Arc<[ClipPlane]>)>);

/// The planes that cut an object open at this moment, in its own space.
#[derive(Clone, Component, Debug, Default, PartialEq)]
pub struct ClipPlanes(pub Vec<Plane>);

/// Index among the lights or materials of the file: where extraction packs them, because queries have no order.
#[derive(Clone, Copy, Component, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FileOrder(pub u32);

/// Index of the primitive of an object or of a light with a visible shape. Groups have none.
#[derive(Clone, Copy, Component, Debug, PartialEq, Eq)]
pub struct Slot(pub u32);

/// Marks lights with a visible shape, which are part of the geometry.
#[derive(Clone, Copy, Component, Debug)]
pub struct AreaLight;

/// The weight of an entity's film layer. Switching a light changes this value; components are never added or removed.
#[derive(Clone, Copy, Component, Debug, PartialEq)]
pub struct Weight {
    pub layer: LayerId,
    pub value: Rgb,
}
